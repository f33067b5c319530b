//! The file around the grids.

use super::VdbError;
use super::grid::Grid;
use super::metadata::{self, Meta, put_text};
use super::pack::{Compression, Masks, Packer};
use super::topology::{put_mask, put_topology};
use super::value::Value;
use rayon::prelude::*;
use std::io::{Seek, SeekFrom, Write};

const MAGIC: u64 = 0x5644_4220;
const FILE_VERSION: u32 = 224;
/// Version of the library whose files these are like.
const LIBRARY: [u32; 2] = [10, 0];
/// Where the id of the file begins: after magic, three versions and the flag of offsets.
const ID_AT: u64 = 8 + 12 + 1;
const ID_LENGTH: usize = 36;
/// Leaves packed together by one thread.
const BATCH: usize = 64;
/// Leaves packed before they are written: bounds the memory.
const ROUND: usize = 64 * BATCH;

/// Writes grids into a file, one after the other; only one needs to be in memory.
///
/// The bytes depend on the grids alone. So does the id of the file: it is a hash of them.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    compression: Compression,
    creator: String,
    names: Vec<String>,
    /// Where the number of grids stands.
    count_at: u64,
    position: u64,
    hash: [u64; 2],
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a file.
    ///
    /// * `creator`: the program that writes, as readers show it.
    ///
    /// # Errors
    /// The output's.
    pub fn new(mut out: W, compression: Compression, creator: &str) -> Result<Self, VdbError> {
        let mut head = Vec::new();
        head.extend(MAGIC.to_le_bytes());
        head.extend(FILE_VERSION.to_le_bytes());
        head.extend(LIBRARY.iter().flat_map(|v| v.to_le_bytes()));
        head.push(1); // grids have offsets
        head.extend([b'0'; ID_LENGTH]);
        metadata::put(
            vec![("creator".to_owned(), Meta::Text(creator.to_owned()))],
            &mut head,
        );
        let count_at = head.len() as u64;
        head.extend(0u32.to_le_bytes());
        out.write_all(&head)?;
        Ok(Self {
            out,
            compression,
            creator: creator.to_owned(),
            names: Vec::new(),
            count_at,
            position: head.len() as u64,
            hash: [0x9ae1_6a3b_2f90_404f, 0xc949_d7c7_509e_6557],
        })
    }

    /// Appends a grid.
    ///
    /// # Errors
    /// A grid that readers would refuse, before anything of it is written; the output's.
    pub fn grid<T: Value>(&mut self, grid: &Grid<T>) -> Result<(), VdbError> {
        grid.check()?;
        if self.names.contains(&grid.name) {
            return Err(VdbError::Name(grid.name.clone()));
        }
        self.names.push(grid.name.clone());

        let mut head = Vec::new();
        put_text(&grid.name, &mut head);
        put_text(&grid.type_name(), &mut head);
        put_text("", &mut head); // no instance of another grid
        let offsets_at = self.position + head.len() as u64;
        head.extend([0; 24]);
        let grid_at = self.position + head.len() as u64;
        head.extend(self.compression.flags().to_le_bytes());
        metadata::put(
            grid.all_metadata(self.compression, &self.creator),
            &mut head,
        );
        put_transform(grid.voxel, &mut head);
        let tree = &grid.tree;
        let (half, compression) = (grid.half, self.compression);
        let packer = || Packer::new(tree.background, half, compression);
        put_topology(tree, half, &mut packer(), &mut head);
        self.write(&head)?;

        let blocks_at = self.position;
        for round in tree.leaves.chunks(ROUND) {
            let packed: Vec<Vec<u8>> = round
                .par_chunks(BATCH)
                .map_init(packer, |packer, leaves| {
                    let mut out = Vec::with_capacity(leaves.len() * 512);
                    for leaf in leaves {
                        put_mask(&leaf.active, &mut out);
                        let masks = Masks {
                            active: &leaf.active,
                            child: &[],
                        };
                        packer.pack(&leaf.values[..], &masks, &mut out);
                    }
                    out
                })
                .collect();
            for bytes in &packed {
                self.write(bytes)?;
            }
        }
        let offsets = [grid_at, blocks_at, self.position];
        self.patch(offsets_at, &offsets.map(u64::to_le_bytes).concat())
    }

    /// Completes the file and returns the output.
    ///
    /// # Errors
    /// The output's.
    pub fn finish(mut self) -> Result<W, VdbError> {
        self.patch(self.count_at, &(self.names.len() as u32).to_le_bytes())?;
        self.patch(ID_AT, id(self.hash).as_bytes())?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), VdbError> {
        self.out.write_all(bytes)?;
        self.position += bytes.len() as u64;
        for word in bytes.chunks(8) {
            let mut padded = [0; 8];
            padded[..word.len()].copy_from_slice(word);
            let word = u64::from_le_bytes(padded);
            let [a, b] = &mut self.hash;
            *a = (*a ^ word)
                .wrapping_mul(0x9fb2_1c65_1e98_df25)
                .rotate_left(29);
            *b = (*b ^ word)
                .wrapping_mul(0xd6e8_feb8_6659_fd93)
                .rotate_left(37);
        }
        Ok(())
    }

    fn patch(&mut self, at: u64, bytes: &[u8]) -> Result<(), VdbError> {
        self.out.seek(SeekFrom::Start(at))?;
        self.out.write_all(bytes)?;
        self.out.seek(SeekFrom::Start(self.position))?;
        Ok(())
    }
}

/// An id in the usual form, of the kind that is made by a rule of one's own (version 8, RFC 9562).
fn id([a, b]: [u64; 2]) -> String {
    let a = a & !0xf000 | 0x8000;
    let b = b & !(0b11 << 62) | 0b10 << 62;
    format!(
        "{:08x}-{:04x}-{:04x}-{:04x}-{:012x}",
        a >> 32,
        a >> 16 & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    )
}

/// Appends a uniform scale: the factors and what the library derives from them.
fn put_transform(voxel: f64, out: &mut Vec<u8>) {
    put_text("UniformScaleMap", out);
    let inverse = 1.0 / voxel;
    // Scale, voxel size, 1/s, 1/s^2, 1/(2s), each for three axes.
    for number in [voxel, voxel, inverse, inverse * inverse, 0.5 * inverse] {
        for _ in 0..3 {
            out.extend(number.to_le_bytes());
        }
    }
}
