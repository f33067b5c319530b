//! Cem Yuksel's hair files: a header of 128 bytes, then the arrays that it announces, little-endian.

use super::{LineSet, Lines, LinesError, WriteError, put_floats};
use crate::io::read_bounded;
use glam::{DVec3, Vec3};
use std::io::Write;
use std::path::Path;

const HEADER: usize = 128;
/// Bytes of the comment at the end of the header.
const INFO: usize = 88;
pub(crate) const SEGMENTS: u32 = 1;
pub(crate) const POINTS: u32 = 2;
pub(crate) const THICKNESS: u32 = 4;
pub(crate) const TRANSPARENCY: u32 = 8;
pub(crate) const COLORS: u32 = 16;
/// Longest file that is read, bytes.
const LONGEST: u64 = 1 << 34;

/// Reads a hair file.
///
/// * Thickness is taken as a diameter in the unit of the points; transparency is not kept.
/// * Memory is bounded by the length of the file, whatever its header says.
///
/// # Errors
/// A file that is cut short or contradicts itself, and numbers that are not finite.
pub fn read(path: &Path) -> Result<LineSet, LinesError> {
    let bytes = read_bounded(path, LONGEST)?;
    parse(&bytes).map_err(|what| LinesError::Broken {
        path: path.to_owned(),
        what,
    })
}

/// What a header says.
pub(crate) struct Header {
    pub(crate) strands: u64,
    pub(crate) points: u64,
    /// Arrays that follow.
    pub(crate) flags: u32,
    /// Segments of each strand and thickness, where there are no arrays.
    pub(crate) segments: u32,
    pub(crate) thickness: f32,
    color: Vec3,
}

impl Header {
    pub(crate) fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }
}

/// The bytes of the arrays; empty for those that are not there.
pub(crate) struct Arrays<'b> {
    pub(crate) segments: &'b [u8],
    pub(crate) points: &'b [u8],
    pub(crate) thickness: &'b [u8],
    pub(crate) transparency: &'b [u8],
    pub(crate) colors: &'b [u8],
    /// Bytes behind the last array.
    pub(crate) rest: &'b [u8],
}

/// Finds the arrays, all of them known to be there.
pub(crate) fn arrays<'b>(header: &Header, bytes: &'b [u8]) -> Result<Arrays<'b>, String> {
    let sizes = [
        (SEGMENTS, 2 * header.strands),
        (POINTS, 12 * header.points),
        (THICKNESS, 4 * header.points),
        (TRANSPARENCY, 4 * header.points),
        (COLORS, 12 * header.points),
    ];
    let mut at = HEADER as u64;
    let parts = sizes.map(|(flag, size)| {
        let start = at;
        at += if header.has(flag) { size } else { 0 };
        start..at
    });
    if at > bytes.len() as u64 {
        return Err(format!(
            "the header announces {} strands and {} points, {at} bytes in all, but the file has {}",
            header.strands,
            header.points,
            bytes.len()
        ));
    }
    let part = |i: usize| &bytes[parts[i].start as usize..parts[i].end as usize];
    Ok(Arrays {
        segments: part(0),
        points: part(1),
        thickness: part(2),
        transparency: part(3),
        colors: part(4),
        rest: &bytes[at as usize..],
    })
}

pub(super) fn parse(bytes: &[u8]) -> Result<LineSet, String> {
    let header = header(bytes)?;
    refuse(&header)?;
    let arrays = arrays(&header, bytes)?;
    let offsets = offsets(&header, arrays.segments)?;
    let points = vectors(arrays.points);
    let widths = match header.has(THICKNESS) {
        true => floats(arrays.thickness).collect(),
        false => vec![header.thickness; points.len()],
    };
    let colors = match header.has(COLORS) {
        true => vectors(arrays.colors),
        false => vec![header.color; points.len()],
    };
    let set = LineSet {
        points,
        widths,
        offsets,
        colors,
    };
    check(&set)?;
    Ok(set)
}

/// Reads the header of a hair file.
pub(crate) fn header(bytes: &[u8]) -> Result<Header, String> {
    if bytes.len() < HEADER {
        return Err(format!("{} bytes are too few for a hair file", bytes.len()));
    }
    if &bytes[..4] != b"HAIR" {
        return Err("it does not begin with HAIR: no hair file".to_owned());
    }
    let word = |i: usize| u32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[4 * i + k]));
    let number = |i: usize| f32::from_bits(word(i));
    Ok(Header {
        strands: u64::from(word(1)),
        points: u64::from(word(2)),
        flags: word(3),
        segments: word(4),
        thickness: number(5),
        color: Vec3::new(number(7), number(8), number(9)),
    })
}

/// Refuses a header of which no strands can be made.
fn refuse(header: &Header) -> Result<(), String> {
    if header.strands == 0 {
        return Err("the header announces no strands".to_owned());
    }
    if header.flags & POINTS == 0 {
        return Err("the header announces no points".to_owned());
    }
    if header.flags >> 5 != 0 {
        let unknown = header.flags >> 5 << 5;
        return Err(format!(
            "the header announces arrays of unknown kind ({unknown:#x})"
        ));
    }
    Ok(())
}

fn offsets(header: &Header, segments: &[u8]) -> Result<Vec<u32>, String> {
    let strands = header.strands as usize;
    let given = |i: usize| match segments {
        [] => u64::from(header.segments),
        all => u64::from(u16::from_le_bytes([all[2 * i], all[2 * i + 1]])),
    };
    // Without an array the strands take no bytes; their points do.
    if segments.is_empty() && header.strands * (given(0) + 1) != header.points {
        return Err(format!(
            "{} strands of {} segments need {} points, but the header announces {}",
            header.strands,
            given(0),
            header.strands * (given(0) + 1),
            header.points
        ));
    }
    let mut offsets = Vec::with_capacity(strands + 1);
    let mut end = 0u64;
    offsets.push(0);
    for strand in 0..strands {
        if given(strand) == 0 {
            return Err(format!("strand {strand} has no segments"));
        }
        end += given(strand) + 1;
        if end > header.points {
            return Err(format!(
                "strand {strand} needs {end} points, but the header announces {}",
                header.points
            ));
        }
        offsets.push(end as u32);
    }
    if end != header.points {
        return Err(format!(
            "the strands have {end} points, but the header announces {}",
            header.points
        ));
    }
    Ok(offsets)
}

fn check(set: &LineSet) -> Result<(), String> {
    for (i, point) in set.points.iter().enumerate() {
        let what = if !point.is_finite() {
            "a coordinate that is not finite"
        } else if !(set.widths[i].is_finite() && set.widths[i] >= 0.0) {
            "a thickness that is negative or not finite"
        } else if !set.colors[i].is_finite() {
            "a color that is not finite"
        } else {
            continue;
        };
        let strand = set.offsets.partition_point(|&o| o as usize <= i) - 1;
        let of = i - set.offsets[strand] as usize;
        return Err(format!("point {of} of strand {strand} has {what}"));
    }
    Ok(())
}

/// Numbers of an array.
pub(crate) fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> {
    let each = bytes.chunks_exact(4);
    each.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

/// Points or colors of an array.
pub(crate) fn vectors(bytes: &[u8]) -> Vec<Vec3> {
    let each = bytes.chunks_exact(12);
    each.map(|b| {
        let mut c = floats(b);
        Vec3::from_array(std::array::from_fn(|_| c.next().unwrap_or_default()))
    })
    .collect()
}

pub(super) fn write(out: &mut impl Write, lines: &Lines<'_>) -> Result<(), WriteError> {
    let strands = lines.strands();
    if (0..strands).any(|s| lines.range(s).len() > 1 << 16) {
        return Err(WriteError::Format(
            "a strand has more than 65535 segments, the most of a hair file",
        ));
    }
    let flags = SEGMENTS | POINTS | THICKNESS | if lines.colors.is_empty() { 0 } else { COLORS };
    let mut head = Vec::with_capacity(HEADER);
    head.extend(b"HAIR");
    for word in [strands as u32, lines.points.len() as u32, flags, 0] {
        head.extend(word.to_le_bytes());
    }
    // Thickness, transparency and color, for readers that do not take them from the arrays: the means.
    let count = lines.points.len().max(1) as f64;
    let thickness = lines.widths.iter().map(|w| f64::from(*w)).sum::<f64>() / count;
    let sum = |sum: DVec3, color: &Vec3| sum + color.as_dvec3();
    let color = match lines.colors {
        [] => DVec3::ONE,
        colors => colors.iter().fold(DVec3::ZERO, sum) / count,
    };
    for number in [thickness, 0.0, color.x, color.y, color.z].map(|n| n as f32) {
        head.extend(number.to_le_bytes());
    }
    let mut info = lines.origin.as_bytes()[..lines.origin.len().min(INFO - 1)].to_vec();
    info.resize(INFO, 0);
    head.extend(info);
    out.write_all(&head)?;
    let segments = (0..strands).flat_map(|s| ((lines.range(s).len() - 1) as u16).to_le_bytes());
    out.write_all(&segments.collect::<Vec<u8>>())?;
    put_floats(out, lines.points.iter().flat_map(|p| p.to_array()))?;
    put_floats(out, lines.widths.iter().copied())?;
    put_floats(out, lines.colors.iter().flat_map(|c| c.to_array()))?;
    Ok(())
}
