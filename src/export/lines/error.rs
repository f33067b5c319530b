//! Why strands could not be read or written.

use crate::blame::Blame;
use crate::io::FileError;
use std::path::PathBuf;

/// A file of strands that is refused, or could not be written.
#[derive(Debug, thiserror::Error)]
pub enum LinesError {
    /// The file is none of its kind, or contradicts itself.
    #[error("{}: {what}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        what: String,
    },
    /// The format cannot hold these strands.
    #[error("cannot write {}: {what}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Why.
        what: &'static str,
    },
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
}

impl LinesError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Broken { .. } | Self::Format { .. } => Blame::Input,
            Self::File(error) => error.blame(),
        }
    }
}
