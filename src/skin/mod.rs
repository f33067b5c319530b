//! The skin that fur grows on: built-in shapes and meshes from files.

mod body;
mod builtin;
mod error;
mod raw;
mod sculpt;
mod surface_nets;
#[cfg(test)]
mod tests;

pub use error::SkinError;

use crate::mesh_file::{self, Format};
use glam::{Vec2, Vec3};
use std::path::Path;

/// Names that [`load`] knows without a file.
pub const BUILT_IN: [&str; 4] = ["body", "ball", "swatch", "tress"];

/// A triangle mesh in meters, Y up, with what a groom needs at each vertex. All arrays but
/// `triangles` and `warnings` have the same length; indices are in range, numbers finite.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Built-in name or file name without its folder.
    pub name: String,
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
    /// Factor on follicle density, 1 for the body, 0 for bare skin; above 1 for hair that is bound
    /// into a bundle.
    pub density: Vec<f32>,
    /// Factor on the species' skin color, linear Rec.709; near 0 for eyes and nose.
    pub color: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// How far strands leave their lay and hang down, 0 (fur keeps its lay) .. 1 (hair hangs).
    pub gravity: f32,
    /// Height of the ground that the subject rests on, meters; strands stay above it.
    pub floor: Option<f32>,
    /// Direction from the subject to a camera that shows it well, unit.
    pub view: Vec3,
    /// What the loader mended or finds odd, one sentence each; empty for built-in skins.
    pub warnings: Vec<String>,
}

/// The built-in skin of that name, or the mesh file at that path.
///
/// # Errors
/// [`SkinError`] names the file, what is wrong and where.
pub fn load(name_or_path: &str) -> Result<Skin, SkinError> {
    match name_or_path {
        "body" => Ok(body::body()),
        "ball" => Ok(builtin::ball()),
        "swatch" => Ok(builtin::swatch()),
        "tress" => Ok(builtin::tress()),
        _ => load_file(name_or_path),
    }
}

fn load_file(name: &str) -> Result<Skin, SkinError> {
    let path = Path::new(name);
    if Format::of(path).is_none() {
        return Err(SkinError::UnknownName {
            name: name.to_owned(),
        });
    }
    mesh_file::read(path)?.into_skin(name)
}

impl Skin {
    /// Scales the mesh about the origin, for files in other units than meters.
    pub fn scale(&mut self, factor: f32) {
        for p in &mut self.positions {
            *p *= factor;
        }
        self.floor = self.floor.map(|height| height * factor);
    }

    /// The corners of triangle `index`.
    pub fn corners(&self, index: usize) -> [Vec3; 3] {
        self.triangles[index].map(|v| self.positions[v as usize])
    }

    /// Area of triangle `index`, square meters.
    pub fn triangle_area(&self, index: usize) -> f64 {
        let [a, b, c] = self.corners(index).map(|p| p.as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    }

    /// Total area, square meters.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len())
            .map(|i| self.triangle_area(i))
            .sum()
    }

    /// Corners of the axis-aligned box around the mesh; zeros for an empty one.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let Some(&first) = self.positions.first() else {
            return (Vec3::ZERO, Vec3::ZERO);
        };
        self.positions
            .iter()
            .fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }
}
