//! A mesh as its file says it.

use super::{MeshFileError, polygon};
use glam::{Vec2, Vec3};

/// Largest coordinate, in the file's units. Areas and volumes of larger ones overflow.
const MAX_COORDINATE: f32 = 1e6;

/// A mesh as read: numbers finite, indices in range, nothing else checked.
#[derive(Debug, Default)]
pub(crate) struct RawMesh {
    /// Vertices.
    pub(crate) positions: Vec<Vec3>,
    /// As many as positions, or none.
    pub(crate) normals: Vec<Vec3>,
    /// As many as positions, or none.
    pub(crate) uvs: Vec<Vec2>,
    /// Vertex indices.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Number of the face that each triangle was cut from.
    pub(crate) face: Vec<u32>,
    /// Faces in the file.
    pub(crate) faces: usize,
    /// Part of each triangle, an index into `names`.
    pub(crate) part: Vec<u32>,
    /// Names of the parts; empty where the file gives none.
    pub(crate) names: Vec<String>,
    /// What of the file could not be read, a sentence each.
    pub(crate) remarks: Vec<String>,
    /// Of files that say it, how their numbers became these.
    pub(crate) said: Option<Said>,
    /// How places in the file are named.
    pub(crate) places: Places,
}

/// What a file says of its numbers, which are read as meters with Y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Said {
    /// Meters in a unit.
    pub(crate) unit_m: f64,
    /// Whether Z points up and not Y; `None` where it is not said.
    pub(crate) is_z_up: Option<bool>,
}

/// Names for the vertices and faces of a file, for messages.
#[derive(Debug, Default)]
pub(crate) enum Places {
    /// By number.
    #[default]
    Counted,
    /// By line of a text.
    Lines {
        /// Line of each vertex.
        vertex: Vec<usize>,
        /// Line of each face.
        face: Vec<usize>,
    },
}

impl Places {
    /// Where a vertex is.
    pub(crate) fn vertex(&self, index: usize) -> String {
        match self {
            Self::Lines { vertex, .. } if index < vertex.len() => format!("line {}", vertex[index]),
            _ => format!("vertex {index}"),
        }
    }

    /// Where a face is.
    pub(crate) fn face(&self, index: usize) -> String {
        match self {
            Self::Lines { face, .. } if index < face.len() => {
                format!("line {} (face {})", face[index], index + 1)
            }
            _ => format!("face {index}"),
        }
    }
}

impl RawMesh {
    /// Cuts a polygon of part `part` into triangles. Its vertices are there already.
    pub(crate) fn add_polygon(&mut self, corners: &[u32], part: u32) {
        // Corners that are nowhere are refused when the mesh is checked.
        let place = |&v: &u32| self.positions.get(v as usize).copied().unwrap_or(Vec3::NAN);
        let places: Vec<Vec3> = corners.iter().map(place).collect();
        for triangle in polygon::triangles(&places) {
            self.triangles.push(triangle.map(|i| corners[i]));
            self.face.push(self.faces as u32);
            self.part.push(part);
        }
        self.faces += 1;
    }

    /// The index of a part, new or known.
    pub(crate) fn part_named(&mut self, name: &str) -> u32 {
        let known = self.names.iter().position(|n| n == name);
        known.unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        }) as u32
    }

    /// Numbers finite and indices in range.
    pub(super) fn check(&self, file: &str) -> Result<(), MeshFileError> {
        let invalid = |place: String, reason: String| MeshFileError::Invalid {
            file: file.to_owned(),
            place,
            reason,
        };
        for (i, p) in self.positions.iter().enumerate() {
            if !(p.is_finite() && p.abs().max_element() <= MAX_COORDINATE) {
                let reason = format!(
                    "position ({}, {}, {}) is not finite or beyond {MAX_COORDINATE}",
                    p.x, p.y, p.z
                );
                return Err(invalid(self.places.vertex(i), reason));
            }
        }
        let count = self.positions.len();
        for (i, t) in self.triangles.iter().enumerate() {
            if let Some(v) = t.iter().find(|&&v| v as usize >= count) {
                let reason = format!("refers to vertex index {v} of a mesh of {count} vertices");
                return Err(invalid(self.places.face(self.face[i] as usize), reason));
            }
        }
        Ok(())
    }
}
