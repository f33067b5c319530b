//! Triangle meshes from files: Wavefront OBJ, Stanford PLY, glTF 2.0 and USD.
//!
//! In: a path or the bytes of a file. Out: triangles, indices in range and numbers finite, with
//! the names of its parts; what it means is up to the caller. Nothing is allocated for a count before
//! the file is known to be long enough for it, and every refusal names the place.

mod catmull_clark;
mod error;
mod gltf;
mod loaded;
mod obj;
mod ply;
mod polygon;
mod raw;
mod usd;

pub use error::MeshFileError;
pub use loaded::LoadedMesh;
pub(crate) use raw::{Places, RawMesh, Said};

use crate::io::read_bounded;
use std::path::Path;

/// Longest mesh file, bytes.
const MAX_FILE: u64 = 2 << 30;

/// Most vertices and faces of a mesh.
pub(crate) const MAX_COUNT: u64 = 50_000_000;

/// Most parts of a mesh.
const MAX_PARTS: u64 = 1000;

/// The kinds of file that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// glTF 2.0, text or binary.
    Gltf,
}

impl Format {
    /// By the ending of the name.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "glb" | "gltf" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// Reads a mesh file. Buffers of a glTF file may lie beside it, nothing farther away.
pub(crate) fn read(path: &Path) -> Result<RawMesh, MeshFileError> {
    let name = path.to_string_lossy();
    let Some(format) = Format::of(path) else {
        return Err(MeshFileError::UnknownKind {
            file: name.into_owned(),
        });
    };
    parse(format, &name, &read_bounded(path, MAX_FILE)?)
}

/// Whether a name is that of a USD file.
pub(crate) fn is_usd(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    matches!(ending.as_str(), "usd" | "usda" | "usdc" | "usdz")
}

/// Reads all meshes of a USD file, in meters with Y up.
pub(crate) fn read_usd(path: &Path) -> Result<RawMesh, MeshFileError> {
    let name = path.to_string_lossy();
    let mesh = usd::read(&name, &read_bounded(path, MAX_FILE)?)?;
    mesh.check(&name)?;
    Ok(mesh)
}

/// Reads the bytes of a mesh file. `file` is its path: for messages, and to find what lies beside it.
pub(crate) fn parse(format: Format, file: &str, bytes: &[u8]) -> Result<RawMesh, MeshFileError> {
    let mesh = match format {
        Format::Obj => obj::read(file, bytes),
        Format::Ply => ply::read(file, bytes),
        Format::Gltf => gltf::read(file, bytes),
    }?;
    mesh.check(file)?;
    Ok(mesh)
}
