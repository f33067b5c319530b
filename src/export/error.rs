//! Why nothing was exported.

use crate::blame::Blame;
use crate::io::FileError;
use std::path::PathBuf;

/// An export that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A name that no format has.
    #[error("{} is no kind of file that a groom can be written to", path.display())]
    Suffix {
        /// The file.
        path: PathBuf,
    },
    /// A .usdz whose Z is up.
    #[error("{}: viewers of .usdz take Y for up", path.display())]
    UsdzUp {
        /// The file.
        path: PathBuf,
    },
    /// A point, a width or a coordinate that is no number: one of them makes readers drop all curves.
    #[error("strand {id} (number {index}) has {what} that is not finite")]
    NotFinite {
        /// Stable id of the strand.
        id: u32,
        /// Its place in the groom.
        index: usize,
        /// What is not.
        what: &'static str,
    },
    /// A groom without strands.
    #[error("the groom has no strands to write")]
    Empty,
    /// The file.
    #[error(transparent)]
    File(#[from] FileError),
    /// Stopped by the caller; nothing was written.
    #[error("the export was stopped; nothing was written")]
    Cancelled,
}

impl ExportError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Suffix { .. } | Self::UsdzUp { .. } | Self::Empty => Blame::Input,
            Self::NotFinite { .. } => Blame::Internal,
            Self::File(error) => error.blame(),
            Self::Cancelled => Blame::Interrupted,
        }
    }

    /// What the user can do about it.
    pub fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Suffix { .. } => Some(
                "end the name in .usdc, .usd, .usda, .usdz, .vdb, .hair, .npz, .ply, .glb, .pbrt or .txt",
            ),
            Self::UsdzUp { .. } => Some("write it without --up z"),
            Self::Empty => Some("ask for more --strands"),
            _ => None,
        }
    }
}
