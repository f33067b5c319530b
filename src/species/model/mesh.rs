//! A fiber that comes as a mesh.

use crate::mesh_file::LoadedMesh;
use serde::Serialize;

/// One period of a fiber as triangles from a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FiberMesh {
    /// The path as it is opened.
    pub file: String,
    /// Length of a period, micrometers; the mesh's extent along its axis if not given.
    pub period_um: Option<f64>,
    /// What becomes of its two ends.
    pub ends: MeshEnds,
    /// Micrometers in a unit of the file.
    pub unit_um: f64,
    /// Which axis of the file points to the tip.
    pub axis: MeshAxis,
    /// Role of each part of the file, in the file's order.
    pub roles: Vec<MeshRole>,
    /// What the file holds.
    pub content: LoadedMesh,
}

/// What becomes of the two ends of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum MeshEnds {
    /// Open, with rims that match one period apart.
    #[default]
    Open,
    /// Closed by flat caps, which are taken away.
    Capped,
}

/// An axis of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshAxis {
    /// +X: (x, y, z) becomes (y, z, x).
    X,
    /// +Y: (x, y, z) becomes (x, -z, y).
    Y,
    /// +Z.
    Z,
}

/// What a part of a mesh bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshRole {
    /// The outer surface.
    Cuticle,
    /// What of the outer surface is as rough as risers.
    Riser,
    /// The cortex under a cuticle of its own.
    Cortex,
    /// The outline of the medulla.
    Medulla,
    /// Voids.
    Void,
    /// Nothing.
    Ignored,
}
