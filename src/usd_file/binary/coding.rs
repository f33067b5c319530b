//! How a crate file packs bytes and integers; `export::usd` does the reverse.

use crate::cursor::Cursor;
use crate::usd_file::error::UsdFileError;

/// LZ4 makes at most so many bytes of one.
const RATIO: u64 = 255;

/// Bytes that are packed with Pixar's head: a zero and one block, or the number of blocks and each with its
/// length.
///
/// * `room`: bytes that come out, at most.
pub(super) fn decompress(packed: &[u8], room: u64) -> Result<Vec<u8>, UsdFileError> {
    let wrong = |_| UsdFileError::at("a packed table", "it is not what LZ4 makes");
    let Some((&blocks, rest)) = packed.split_first() else {
        return Ok(Vec::new());
    };
    let possible = |bytes: &[u8]| room.min(RATIO * bytes.len() as u64 + 64) as usize;
    if blocks == 0 {
        return lz4_flex::block::decompress(rest, possible(rest)).map_err(wrong);
    }
    let mut out = Vec::new();
    let mut cursor = Cursor::new(rest, 0);
    for _ in 0..blocks {
        let length = cursor.u32()?;
        let block = cursor.take(u64::from(length))?;
        out.extend(lz4_flex::block::decompress(block, possible(block)).map_err(wrong)?);
        if out.len() as u64 > room {
            return Err(UsdFileError::at(
                "a packed table",
                "it is longer than it says",
            ));
        }
    }
    Ok(out)
}

/// Integers of `WIDTH` bytes, 4 or 8, that are packed as differences: two bits each that say whether it is
/// the most frequent one or how many bytes it has.
pub(super) fn integers<const WIDTH: usize>(
    packed: &[u8],
    count: u64,
) -> Result<Vec<i64>, UsdFileError> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let width = WIDTH as u64;
    let codes = count.div_ceil(4);
    let plain = decompress(packed, width + codes + width * count)?;
    let mut cursor = Cursor::new(&plain, 0);
    let common = signed(&mut cursor, WIDTH)?;
    let codes = cursor.take(codes)?;
    // Known to be there: four codes a byte.
    let mut out = Vec::with_capacity(count as usize);
    let mut value = 0i64;
    for index in 0..count as usize {
        let step = match codes[index / 4] >> (2 * (index % 4)) & 3 {
            0 => common,
            code => signed(&mut cursor, (WIDTH / 4) << (code - 1))?,
        };
        value = value.wrapping_add(step);
        if WIDTH == 4 {
            value = i64::from(value as i32);
        }
        out.push(value);
    }
    Ok(out)
}

fn signed(cursor: &mut Cursor<'_>, bytes: usize) -> Result<i64, UsdFileError> {
    Ok(match bytes {
        1 => i64::from(cursor.u8()? as i8),
        2 => i64::from(cursor.u16()? as i16),
        4 => i64::from(cursor.u32()? as i32),
        _ => cursor.u64()? as i64,
    })
}
