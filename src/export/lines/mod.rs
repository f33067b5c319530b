//! Strands in plain formats: control points joined by lines.
//!
//! | format | what it has |
//! |---|---|
//! | `.hair` | Cem Yuksel's hair files, read and written: points, thickness, colors |
//! | `.npz` | arrays for numpy: `points`, `widths`, `offsets`, `colors` |
//! | `.ply` | a vertex a control point, with the number of its strand |
//! | `.glb` | glTF lines with colors, without widths: glTF has no curves |
//! | `.pbrt` | cubic curves of pbrt, each span one |
//! | `.txt` | B-splines of Mitsuba |

mod error;
mod glb;
pub(crate) mod hair;
mod mitsuba;
mod npz;
mod pbrt;
mod ply;
#[cfg(test)]
mod tests;

pub use error::LinesError;
pub use hair::read as read_hair;

use crate::color::srgb_from_linear;
use crate::io::AtomicFile;
use glam::Vec3;
use std::io::{self, Write};
use std::path::Path;

/// Strands that own their arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineSet {
    /// Control points.
    pub points: Vec<Vec3>,
    /// Full diameter at each control point.
    pub widths: Vec<f32>,
    /// Start of each strand in `points`; one more entry than strands.
    pub offsets: Vec<u32>,
    /// Linear color at each control point; empty if there are none.
    pub colors: Vec<Vec3>,
}

/// Strands to write, in the unit and frame that the file shall have.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    /// Control points.
    pub points: &'a [Vec3],
    /// Full diameter at each control point.
    pub widths: &'a [f32],
    /// Start of each strand in `points`; one more entry than strands.
    pub offsets: &'a [u32],
    /// Linear color at each control point; empty if there are none.
    pub colors: &'a [Vec3],
    /// Where the strands come from, one line.
    pub origin: &'a str,
}

impl LineSet {
    /// The strands as they are written.
    pub fn lines<'a>(&'a self, origin: &'a str) -> Lines<'a> {
        Lines {
            points: &self.points,
            widths: &self.widths,
            offsets: &self.offsets,
            colors: &self.colors,
            origin,
        }
    }
}

impl Lines<'_> {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Indices of the points of a strand.
    fn range(&self, strand: usize) -> std::ops::Range<usize> {
        self.offsets[strand] as usize..self.offsets[strand + 1] as usize
    }
}

/// A plain format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFormat {
    /// `.hair`.
    Hair,
    /// `.npz`.
    Npz,
    /// `.ply`.
    Ply,
    /// `.glb`.
    Glb,
    /// `.pbrt`.
    Pbrt,
    /// `.txt`.
    Mitsuba,
}

impl LineFormat {
    /// The format of a suffix, in lower case.
    pub fn of_suffix(suffix: &str) -> Option<Self> {
        match suffix {
            "hair" => Some(Self::Hair),
            "npz" => Some(Self::Npz),
            "ply" => Some(Self::Ply),
            "glb" => Some(Self::Glb),
            "pbrt" => Some(Self::Pbrt),
            "txt" => Some(Self::Mitsuba),
            _ => None,
        }
    }
}

/// Writes strands into a file, whole or not at all.
///
/// # Errors
/// Strands that the format cannot hold; the file.
pub fn write(path: &Path, format: LineFormat, lines: &Lines<'_>) -> Result<(), LinesError> {
    let mut file = AtomicFile::create(path)?;
    write_to(&mut file, format, lines).map_err(|e| e.at(path))?;
    Ok(file.commit()?)
}

/// Why nothing could be written, before the path is known.
enum WriteError {
    Io(io::Error),
    Format(&'static str),
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl WriteError {
    fn at(self, path: &Path) -> LinesError {
        match self {
            Self::Io(error) => crate::io::FileError::new("write", path, error).into(),
            Self::Format(what) => LinesError::Format {
                path: path.to_owned(),
                what,
            },
        }
    }
}

fn write_to(out: &mut impl Write, format: LineFormat, lines: &Lines<'_>) -> Result<(), WriteError> {
    if lines.strands() == 0 {
        return Err(WriteError::Format("there are no strands"));
    }
    match format {
        LineFormat::Hair => hair::write(out, lines),
        LineFormat::Npz => npz::write(out, lines),
        LineFormat::Ply => ply::write(out, lines),
        LineFormat::Glb => glb::write(out, lines),
        LineFormat::Pbrt => pbrt::write(out, lines),
        LineFormat::Mitsuba => mitsuba::write(out, lines),
    }
}

/// The linear value as sRGB has it, 0 .. 255.
fn srgb(linear: Vec3) -> [u8; 3] {
    let of = |c| (255.0 * srgb_from_linear(c)).round() as u8;
    linear.to_array().map(of)
}

/// Writes numbers as little-endian bytes, a block at a time.
fn put_floats(out: &mut impl Write, floats: impl Iterator<Item = f32>) -> io::Result<()> {
    let mut block = Vec::with_capacity(1 << 16);
    for value in floats {
        block.extend(value.to_le_bytes());
        if block.len() >= 1 << 16 {
            out.write_all(&block)?;
            block.clear();
        }
    }
    out.write_all(&block)
}
