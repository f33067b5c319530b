//! Strands of fur on a skin, in flat arrays.

use glam::{Vec2, Vec3};

/// All strands. Strand `i` has control points `points[offsets[i]..offsets[i + 1]]`, at least two,
/// root first; the curve is a Catmull-Rom spline pinned at both ends, through every point.
#[derive(Clone, Debug, Default)]
pub struct Groom {
    /// Control points, meters.
    pub points: Vec<Vec3>,
    /// Full diameter at each control point, meters (after width compensation for thinned grooms).
    pub widths: Vec<f32>,
    /// Start of each strand in `points`; one more entry than strands.
    pub offsets: Vec<u32>,
    /// Hair class of each strand: index into `classes`.
    pub class: Vec<u8>,
    /// Stable id of each strand: survives a change of density.
    pub id: Vec<u32>,
    /// Texture coordinates of each root.
    pub root_uv: Vec<Vec2>,
    /// Arc length of each strand, meters.
    pub length: Vec<f32>,
    /// Names of the hair classes.
    pub classes: Vec<String>,
}

impl Groom {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.class.len()
    }
}
