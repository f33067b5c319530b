//! A mesh that is kept with what refers to it.

use super::{Format, MeshFileError, RawMesh, read};
use crate::hex::hex;
use serde::{Serialize, Serializer};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;

/// What a mesh file held when it was read. Cheap to clone; two are equal, and serialize alike, if
/// they hold the same triangles of the same parts, whatever the file looked like.
#[derive(Clone)]
pub struct LoadedMesh {
    mesh: Arc<RawMesh>,
    /// SHA-256 of the geometry, hexadecimal.
    digest: String,
    is_gltf: bool,
}

impl LoadedMesh {
    /// Reads a mesh file.
    pub(crate) fn read(path: &Path) -> Result<Self, MeshFileError> {
        let is_gltf = Format::of(path) == Some(Format::Gltf);
        Ok(Self::new(read(path)?, is_gltf))
    }

    /// A mesh that was read.
    pub(crate) fn new(mesh: RawMesh, is_gltf: bool) -> Self {
        Self {
            digest: digest(&mesh),
            mesh: Arc::new(mesh),
            is_gltf,
        }
    }

    /// Vertices, triangles and parts.
    pub(crate) fn mesh(&self) -> &RawMesh {
        &self.mesh
    }

    /// Names of the parts.
    pub(crate) fn names(&self) -> &[String] {
        &self.mesh.names
    }

    /// Whether it came from a glTF file.
    pub(crate) fn is_gltf(&self) -> bool {
        self.is_gltf
    }
}

fn digest(mesh: &RawMesh) -> String {
    let mut hash = Sha256::new();
    for p in &mesh.positions {
        for v in p.to_array() {
            hash.update(v.to_le_bytes());
        }
    }
    for (t, part) in mesh.triangles.iter().zip(&mesh.part) {
        for v in t.iter().chain([part]) {
            hash.update(v.to_le_bytes());
        }
    }
    hex(&hash.finalize())
}

impl std::fmt::Debug for LoadedMesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoadedMesh")
            .field("triangles", &self.mesh.triangles.len())
            .field("digest", &self.digest)
            .finish_non_exhaustive()
    }
}

impl PartialEq for LoadedMesh {
    fn eq(&self, other: &Self) -> bool {
        self.digest == other.digest
    }
}

impl Serialize for LoadedMesh {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.digest)
    }
}
