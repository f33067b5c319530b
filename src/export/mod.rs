//! Files for other programs.
//!
//! [`usd`] and [`vdb`] are formats and know nothing of fur; [`asset`] makes a component asset of a groom,
//! [`volume`] grids, [`lines`] plain strands,
//! [`usdz`] a mesh in their place; [`mitsuba`] writes a whole scene.

pub mod asset;
mod error;
pub mod lines;
pub mod mitsuba;
pub mod usd;
pub mod usdz;
pub mod vdb;
pub mod volume;
mod zip;

pub use error::ExportError;

use std::path::Path;

/// What a groom can be written as, by the suffix of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Universal Scene Description: `.usda` as text, `.usdc` and `.usd` in binary form.
    Usd(usd::Form),
    /// `.usdz`: a mesh in place of the fur.
    Usdz,
    /// `.vdb`: grids of density, color and others.
    Vdb,
    /// Plain strands: `.hair`, `.npz`, `.ply`, `.glb`, `.pbrt`, `.txt`.
    Lines(lines::LineFormat),
}

impl Format {
    /// The format that the name of a file asks for.
    ///
    /// # Errors
    /// [`ExportError::Suffix`] lists what there is.
    pub fn of(path: &Path) -> Result<Self, ExportError> {
        let suffix = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        match suffix.to_ascii_lowercase().as_str() {
            "usda" => Ok(Self::Usd(usd::Form::Text)),
            "usdc" | "usd" => Ok(Self::Usd(usd::Form::Binary)),
            "usdz" => Ok(Self::Usdz),
            "vdb" => Ok(Self::Vdb),
            other => match lines::LineFormat::of_suffix(other) {
                Some(format) => Ok(Self::Lines(format)),
                None => Err(ExportError::Suffix {
                    path: path.to_owned(),
                }),
            },
        }
    }
}
