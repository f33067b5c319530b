//! The skin that fur grows on.

use glam::{Vec2, Vec3};

/// A triangle mesh in meters, Y up, with what a groom needs at each vertex. All arrays but
/// `triangles` have the same length; indices are in range, numbers finite.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Vertex positions, meters.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals, outward.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the vertices.
    pub uvs: Vec<Vec2>,
    /// Unit tangent directions in which the fur lies (head to tail).
    pub combing: Vec<Vec3>,
    /// Factor on hair length, 1 for the body.
    pub length: Vec<f32>,
    /// Factor on follicle density, 1 for the body, 0 for bare skin.
    pub density: Vec<f32>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}
