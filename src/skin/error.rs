//! Why a skin was refused.

use crate::blame::Blame;
use crate::io::FileError;

/// A skin that cannot be used: which, what is wrong and where.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// Neither a built-in name nor something that looks like a mesh file.
    #[error("no skin named `{name}`: expected one of {} or a path to an .obj or .ply file", super::BUILT_IN.join(", "))]
    UnknownName {
        /// What was asked for.
        name: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file does not say what a mesh file should say.
    #[error("skin {file}, {place}: {reason}")]
    Invalid {
        /// The path as the user gave it.
        file: String,
        /// Line, vertex or face; counted from 1 for lines and OBJ, from 0 for PLY, as the formats do.
        place: String,
        /// What is wrong there.
        reason: String,
    },
    /// More than this program takes, or more than the file has room for.
    #[error("skin {file}: {count} {what} announced, at most {limit} are possible here")]
    TooLarge {
        /// The path as the user gave it.
        file: String,
        /// What there is too much of.
        what: &'static str,
        /// How many.
        count: u64,
        /// Largest number possible.
        limit: u64,
    },
    /// No usable triangle.
    #[error("skin {file}: no usable face among {faces}")]
    Empty {
        /// The path as the user gave it.
        file: String,
        /// Faces in the file, all degenerate.
        faces: usize,
    },
}

impl SkinError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}
