//! Long arrays in pieces: many are made at once, all are written in order, few are in memory.

use super::value::Rows;
use rayon::prelude::*;
use std::io::{self, Write};

/// Rows a piece: some hundred kilobytes of points.
const ROWS: usize = 4096;

/// Pieces that are in memory at once.
const AT_ONCE: usize = 16;

/// Writes an array: every piece is turned into bytes on any thread.
///
/// * `encode`: appends the bytes of a piece; it is told whether the piece is the first.
/// * `wrote`: hears the number of bytes of each batch of pieces.
pub(super) fn write<T: Send>(
    rows: &Rows<'_, T>,
    out: &mut dyn Write,
    encode: impl Fn(&[T], bool, &mut Vec<u8>) + Sync,
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
) -> io::Result<()> {
    let pieces = rows.rows().div_ceil(ROWS);
    for batch in (0..pieces).step_by(AT_ONCE) {
        let encoded: Vec<Vec<u8>> = (batch..(batch + AT_ONCE).min(pieces))
            .into_par_iter()
            .map(|piece| {
                let start = piece * ROWS;
                let mut elements = Vec::new();
                rows.fill(start..(start + ROWS).min(rows.rows()), &mut elements);
                let mut bytes = Vec::new();
                encode(&elements, piece == 0, &mut bytes);
                bytes
            })
            .collect();
        let mut count = 0;
        for bytes in &encoded {
            out.write_all(bytes)?;
            count += bytes.len() as u64;
        }
        wrote(count)?;
    }
    Ok(())
}
