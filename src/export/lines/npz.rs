//! Arrays for numpy: a zip archive, without compression, of .npy files.

use super::{Lines, WriteError, put_floats};
use crate::export::zip::Archive;
use std::io::Write;

/// An archive beyond this would need the 64-bit form of zip.
const LARGEST: u64 = u32::MAX as u64;

/// An array's header and numbers, as a file.
fn array(kind: &str, shape: &str, data: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
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
    bytes
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
    let mut archive = Archive::new(out, 1);
    let points = &mut lines.points.iter().flat_map(|p| p.to_array());
    archive.add("points.npy", &array("<f4", &rows, |b| floats(points, b)))?;
    let widths = &mut lines.widths.iter().copied();
    let shape = format!("({count},)");
    archive.add("widths.npy", &array("<f4", &shape, |b| floats(widths, b)))?;
    let shape = format!("({},)", lines.offsets.len());
    let offsets = lines.offsets.iter().flat_map(|o| o.to_le_bytes());
    archive.add("offsets.npy", &array("<u4", &shape, |b| b.extend(offsets)))?;
    if !lines.colors.is_empty() {
        let colors = &mut lines.colors.iter().flat_map(|c| c.to_array());
        archive.add("colors.npy", &array("<f4", &rows, |b| floats(colors, b)))?;
    }
    archive.finish()?;
    Ok(())
}
