//! What can be wrong with a table or its file.

use crate::blame::Blame;
use crate::io::FileError;
use std::path::{Path, PathBuf};

/// A table that cannot be read, written, dyed or drawn.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file system said no.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not an OpenEXR file, or a broken one.
    #[error("{} is not a readable OpenEXR file: {reason}", path.display())]
    NotExr {
        /// The file.
        path: PathBuf,
        /// What the decoder found.
        reason: String,
    },
    /// The file is OpenEXR but its content contradicts the table format.
    #[error("{} is not a scattering table: {what}", path.display())]
    NotTable {
        /// The file.
        path: PathBuf,
        /// Which part, channel or attribute is wrong, and how.
        what: String,
    },
    /// A table in memory contradicts itself.
    #[error("the table is inconsistent: {0}")]
    Inconsistent(String),
    /// The encoder failed.
    #[error("cannot encode the table for {}: {reason}", path.display())]
    Encode {
        /// The output.
        path: PathBuf,
        /// What the encoder said.
        reason: String,
    },
    /// A request that the table cannot serve.
    #[error("{0}")]
    Request(String),
}

impl TableError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            Self::NotExr { .. } | Self::NotTable { .. } | Self::Request(_) => Blame::Input,
            Self::Inconsistent(_) | Self::Encode { .. } => Blame::Internal,
        }
    }

    /// The same complaint as one about the file that the table came from.
    pub(super) fn of_file(self, path: &Path) -> Self {
        match self {
            Self::Inconsistent(what) => Self::NotTable {
                path: path.to_owned(),
                what,
            },
            other => other,
        }
    }
}
