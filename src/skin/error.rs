//! Why a skin was refused.

use crate::blame::Blame;
use crate::mesh_file::MeshFileError;

/// A skin that cannot be used: which, what is wrong and where.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// Neither a built-in name nor something that looks like a mesh file.
    #[error("no skin named `{name}`: expected one of {} or a path to an .obj, .ply, .glb, .gltf, .usd, .usda, .usdc or .usdz file", super::BUILT_IN.join(", "))]
    UnknownName {
        /// What was asked for.
        name: String,
    },
    /// The file could not be read or is no mesh.
    #[error("skin: {0}")]
    Mesh(#[from] MeshFileError),
    /// A unit that is none.
    #[error("the unit of the skin is {unit_m} m, expected a finite number above 0")]
    Unit {
        /// Meters in a unit of the file.
        unit_m: f32,
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
            Self::Mesh(error) => error.blame(),
            _ => Blame::Input,
        }
    }
}
