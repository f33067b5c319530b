//! Long arrays in pieces: many are made at once, all are written in order, few are in memory.

use super::value::Rows;
use rayon::prelude::*;
use std::io::{self, Write};

/// Rows a piece: some hundred kilobytes of points.
const ROWS: usize = 2048;

/// Pieces that are written one after another while as many are made.
const AT_ONCE: usize = 16;

/// Memory of a piece, used again for one after another.
struct Piece<T> {
    elements: Vec<T>,
    bytes: Vec<u8>,
}

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
    let make = |batch: &mut Vec<Piece<T>>, first: usize| {
        batch.resize_with(AT_ONCE.min(pieces - first), || Piece {
            elements: Vec::new(),
            bytes: Vec::new(),
        });
        batch.par_iter_mut().enumerate().for_each(|(i, piece)| {
            let start = (first + i) * ROWS;
            piece.elements.clear();
            piece.bytes.clear();
            rows.fill(start..(start + ROWS).min(rows.rows()), &mut piece.elements);
            encode(&piece.elements, start == 0, &mut piece.bytes);
        });
    };
    let (mut ready, mut coming) = (Vec::new(), Vec::new());
    make(&mut ready, 0);
    for first in (0..pieces).step_by(AT_ONCE) {
        rayon::in_place_scope(|scope| {
            let next = first + AT_ONCE;
            if next < pieces {
                let coming = &mut coming;
                scope.spawn(move |_| make(coming, next));
            }
            let mut count = 0;
            for piece in &ready {
                out.write_all(&piece.bytes)?;
                count += piece.bytes.len() as u64;
            }
            wrote(count)
        })?;
        std::mem::swap(&mut ready, &mut coming);
    }
    Ok(())
}
