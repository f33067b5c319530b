//! The binary form of a layer: a crate file of version 0.8.0.
//!
//! Values go out as they are met; the tables that refer to them follow at the end and the head, written
//! last, says where those are.

mod coding;
mod paths;
mod specs;
mod tables;
mod values;

use super::layer::Layer;
use coding::{compress, compress_ints};
use paths::Paths;
use std::io::{self, Seek, SeekFrom, Write};
use tables::Tables;
use values::Values;

/// Length of the head.
const HEAD: u64 = 88;

/// Version of the files.
const VERSION: [u8; 3] = [0, 8, 0];

/// What a spec says: its path, its set of fields, its kind.
struct Spec {
    path: u32,
    fields: u32,
    kind: i32,
}

/// Everything that is known of a file while its values go out.
struct Packer<'o> {
    values: Values<'o>,
    tables: Tables,
    paths: Paths,
    specs: Vec<Spec>,
}

/// Writes a layer.
///
/// * `wrote`: hears how many bytes went out; an error of its own stops the writing.
pub(super) fn write(
    layer: &Layer<'_>,
    out: &mut (impl Write + Seek),
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
) -> io::Result<()> {
    out.write_all(&[0; HEAD as usize])?;
    let mut packer = Packer {
        values: Values::new(out, HEAD, wrote),
        tables: Tables::new(),
        paths: Paths::new(),
        specs: Vec::new(),
    };
    packer.layer(layer)?;
    let directory = packer.sections()?;
    out.seek(SeekFrom::Start(0))?;
    let mut head = b"PXR-USDC".to_vec();
    head.extend(VERSION);
    head.extend([0; 5]);
    head.extend(directory.to_le_bytes());
    head.resize(HEAD as usize, 0);
    out.write_all(&head)?;
    out.seek(SeekFrom::End(0))?;
    Ok(())
}

impl Packer<'_> {
    /// Writes the tables and their directory; returns where the directory stands.
    fn sections(&mut self) -> io::Result<u64> {
        let sections = [
            ("TOKENS", self.tokens()),
            ("STRINGS", self.strings()),
            ("FIELDS", self.fields()),
            ("FIELDSETS", self.field_sets()),
            ("PATHS", self.path_tree()),
            ("SPECS", self.spec_list()),
        ];
        let mut directory = (sections.len() as u64).to_le_bytes().to_vec();
        for (name, bytes) in &sections {
            let start = self.values.position();
            self.values.put(bytes)?;
            let mut padded = [0; 16];
            padded[..name.len()].copy_from_slice(name.as_bytes());
            directory.extend(padded);
            directory.extend(start.to_le_bytes());
            directory.extend((bytes.len() as u64).to_le_bytes());
        }
        let start = self.values.position();
        self.values.put(&directory)?;
        Ok(start)
    }

    fn tokens(&self) -> Vec<u8> {
        let mut text = Vec::new();
        for token in &self.tables.tokens {
            text.extend(token.as_bytes());
            text.push(0);
        }
        let mut out = (self.tables.tokens.len() as u64).to_le_bytes().to_vec();
        out.extend((text.len() as u64).to_le_bytes());
        sized(&mut out, &compress(&text));
        out
    }

    fn strings(&self) -> Vec<u8> {
        let mut out = (self.tables.strings.len() as u64).to_le_bytes().to_vec();
        out.extend(self.tables.strings.iter().flat_map(|t| t.to_le_bytes()));
        out
    }

    fn fields(&self) -> Vec<u8> {
        let fields = &self.tables.fields;
        let names: Vec<i32> = fields.iter().map(|f| f.0 as i32).collect();
        let values: Vec<u8> = fields.iter().flat_map(|f| f.1.to_le_bytes()).collect();
        let mut out = (fields.len() as u64).to_le_bytes().to_vec();
        sized(&mut out, &compress_ints(&names));
        sized(&mut out, &compress(&values));
        out
    }

    fn field_sets(&self) -> Vec<u8> {
        let sets: Vec<i32> = self.tables.field_sets.iter().map(|&f| f as i32).collect();
        let mut out = (sets.len() as u64).to_le_bytes().to_vec();
        sized(&mut out, &compress_ints(&sets));
        out
    }

    fn path_tree(&self) -> Vec<u8> {
        let encoded = self.paths.encode();
        let mut out = (self.paths.count() as u64).to_le_bytes().to_vec();
        out.extend((encoded.paths.len() as u64).to_le_bytes());
        for list in [&encoded.paths, &encoded.elements, &encoded.jumps] {
            sized(&mut out, &compress_ints(list));
        }
        out
    }

    fn spec_list(&self) -> Vec<u8> {
        let mut out = (self.specs.len() as u64).to_le_bytes().to_vec();
        let lists: [Vec<i32>; 3] = [
            self.specs.iter().map(|s| s.path as i32).collect(),
            self.specs.iter().map(|s| s.fields as i32).collect(),
            self.specs.iter().map(|s| s.kind).collect(),
        ];
        for list in &lists {
            sized(&mut out, &compress_ints(list));
        }
        out
    }
}

/// Appends bytes with their number before them.
fn sized(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend((bytes.len() as u64).to_le_bytes());
    out.extend(bytes);
}
