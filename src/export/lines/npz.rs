//! Arrays for numpy: a zip archive, without compression, of .npy files.

use super::{Lines, WriteError, put_floats};
use flate2::Crc;
use std::io::Write;

/// An archive beyond this would need the 64-bit form of zip.
const LARGEST: u64 = u32::MAX as u64;

/// One array: its name, header and bytes.
struct Entry {
    name: &'static str,
    bytes: Vec<u8>,
}

fn entry(name: &'static str, kind: &str, shape: &str, data: impl FnOnce(&mut Vec<u8>)) -> Entry {
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // The data begin at a multiple of 64 bytes.
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    data(&mut bytes);
    Entry { name, bytes }
}

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    let count = lines.points.len() as u64;
    if count * 28 + lines.offsets.len() as u64 * 4 + 4096 > LARGEST {
        return Err(WriteError::Format(
            "the arrays are larger than 4 GB: write fewer strands",
        ));
    }
    let floats = |values: &mut dyn Iterator<Item = f32>, bytes: &mut Vec<u8>| {
        // A vector takes all that is written to it.
        let _ = put_floats(bytes, values);
    };
    let rows = format!("({count}, 3)");
    let mut archive = Archive::default();
    let points = &mut lines.points.iter().flat_map(|p| p.to_array());
    archive.add(
        out,
        entry("points.npy", "<f4", &rows, |b| floats(points, b)),
    )?;
    let widths = &mut lines.widths.iter().copied();
    archive.add(
        out,
        entry("widths.npy", "<f4", &format!("({count},)"), |b| {
            floats(widths, b)
        }),
    )?;
    let shape = format!("({},)", lines.offsets.len());
    let offsets = lines.offsets.iter().flat_map(|o| o.to_le_bytes());
    archive.add(
        out,
        entry("offsets.npy", "<u4", &shape, |b| b.extend(offsets)),
    )?;
    if !lines.colors.is_empty() {
        let colors = &mut lines.colors.iter().flat_map(|c| c.to_array());
        archive.add(
            out,
            entry("colors.npy", "<f4", &rows, |b| floats(colors, b)),
        )?;
    }
    archive.finish(out)?;
    Ok(())
}

/// The directory that follows the files.
#[derive(Default)]
struct Archive {
    directory: Vec<u8>,
    files: u16,
    position: u32,
}

impl Archive {
    fn add(&mut self, out: &mut impl Write, entry: Entry) -> std::io::Result<()> {
        let mut crc = Crc::new();
        crc.update(&entry.bytes);
        let size = entry.bytes.len() as u32;
        // Version, flags, method; 1 January 1980, so that equal strands are equal files.
        let mut common = Vec::new();
        for short in [20u16, 0, 0, 0, 0x21] {
            common.extend(short.to_le_bytes());
        }
        for word in [crc.sum(), size, size] {
            common.extend(word.to_le_bytes());
        }
        common.extend((entry.name.len() as u16).to_le_bytes());
        common.extend(0u16.to_le_bytes());
        let name = entry.name.as_bytes();
        let local = [b"PK\x03\x04", &common[..], name].concat();
        out.write_all(&local)?;
        out.write_all(&entry.bytes)?;

        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(20u16.to_le_bytes());
        self.directory.extend(&common);
        // Comment, disk, attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(self.position.to_le_bytes());
        self.directory.extend(name);
        self.files += 1;
        self.position += local.len() as u32 + size;
        Ok(())
    }

    fn finish(self, out: &mut impl Write) -> std::io::Result<()> {
        out.write_all(&self.directory)?;
        let mut end = b"PK\x05\x06".to_vec();
        for short in [0, 0, self.files, self.files] {
            end.extend(short.to_le_bytes());
        }
        end.extend((self.directory.len() as u32).to_le_bytes());
        end.extend(self.position.to_le_bytes());
        end.extend(0u16.to_le_bytes());
        out.write_all(&end)
    }
}
