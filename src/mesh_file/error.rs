//! Why a mesh file was refused.

use crate::blame::Blame;
use crate::io::FileError;

/// A mesh file that cannot be used: which, what is wrong and where.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileError {
    /// Not the name of a mesh file.
    #[error("{file}: unknown kind of mesh, the name must end in .obj, .ply, .glb or .gltf")]
    UnknownKind {
        /// The path as the user gave it.
        file: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file does not say what a mesh file should say.
    #[error("{file}, {place}: {reason}")]
    Invalid {
        /// The path as the user gave it.
        file: String,
        /// Line, vertex, face or member; counted from 1 for lines and OBJ, from 0 for PLY and glTF,
        /// as the formats do.
        place: String,
        /// What is wrong there.
        reason: String,
    },
    /// More than this program takes, or more than the file has room for.
    #[error("{file}: {count} {what} announced, at most {limit} are possible here")]
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
}

impl MeshFileError {
    /// Refuses more than `limit` of something.
    pub(super) fn limit(
        file: &str,
        what: &'static str,
        count: usize,
        limit: u64,
    ) -> Result<(), Self> {
        if count as u64 <= limit {
            return Ok(());
        }
        Err(Self::TooLarge {
            file: file.to_owned(),
            what,
            count: count as u64,
            limit,
        })
    }

    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}
