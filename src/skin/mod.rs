//! The skin that fur grows on: built-in shapes and meshes from files.

mod body;
mod builtin;
mod error;
mod landmarks;
mod mirror;
mod raw;
mod sculpt;
mod surface_nets;
#[cfg(test)]
mod tests;

pub use error::SkinError;
pub use landmarks::Landmark;
pub use mirror::Mirror;

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
    /// Direction in which the head looks, unit and level.
    pub front: Vec3,
    /// How its file was read: what else is in that file's coordinates is placed alike.
    pub placing: Placing,
    /// Where named places of the body are; empty for skins that are no bodies.
    pub landmarks: Vec<(Landmark, Vec<Vec3>)>,
    /// Which places are mirror images of each other; `None` for skins without two sides.
    pub mirror: Option<Mirror>,
    /// Length of the body from nose to root of the tail, meters, of built-in bodies: coats are scaled to
    /// it. `None` where millimeters of a pattern are taken as they are.
    pub body: Option<f32>,
    /// What the loader mended or finds odd, one sentence each; empty for built-in skins.
    pub warnings: Vec<String>,
}

/// The built-in skin of that name, or the mesh file at that path.
///
/// # Errors
/// [`SkinError`] names the file, what is wrong and where.
pub fn load(name_or_path: &str) -> Result<Skin, SkinError> {
    load_placed(name_or_path, Placing::default())
}

/// How a mesh file is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// Meters in a unit of the file.
    pub unit_m: f32,
    /// Which axis of the file points up.
    pub up: Up,
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// As in this program.
    Y,
    /// (x, y, z) becomes (x, z, -y).
    Z,
}

impl Default for Placing {
    fn default() -> Self {
        Self {
            unit_m: 1.0,
            up: Up::Y,
        }
    }
}

impl Placing {
    /// A point of the file in meters, Y up.
    pub(crate) fn place(self, point: Vec3) -> Vec3 {
        self.turn(point) * self.unit_m
    }

    fn turn(self, v: Vec3) -> Vec3 {
        match self.up {
            Up::Y => v,
            Up::Z => Vec3::new(v.x, v.z, -v.y),
        }
    }
}

/// As [`load`], for files in other units or with another axis up. Built-in skins are what they are.
///
/// # Errors
/// As [`load`]; a unit that is not a positive number, or a mesh that such a unit makes endless.
pub fn load_placed(name_or_path: &str, placing: Placing) -> Result<Skin, SkinError> {
    match name_or_path {
        "body" => Ok(body::body()),
        "ball" => Ok(builtin::ball()),
        "swatch" => Ok(builtin::swatch()),
        "tress" => Ok(builtin::tress()),
        _ => load_file(name_or_path, placing),
    }
}

fn load_file(name: &str, placing: Placing) -> Result<Skin, SkinError> {
    let unit_m = placing.unit_m;
    if !(unit_m.is_finite() && unit_m > 0.0) {
        return Err(SkinError::Unit { unit_m });
    }
    let path = Path::new(name);
    let is_usd = mesh_file::is_usd(path);
    if Format::of(path).is_none() && !is_usd {
        return Err(SkinError::UnknownName {
            name: name.to_owned(),
        });
    }
    let mut mesh = if is_usd {
        mesh_file::read_usd(path)?
    } else {
        mesh_file::read(path)?
    };
    // What a file says of its axes counts, and is done.
    let said = mesh.said;
    let placing = match said.and_then(|said| said.is_z_up) {
        Some(_) => Placing {
            up: Up::Y,
            ..placing
        },
        None => placing,
    };
    for p in &mut mesh.positions {
        *p = placing.place(*p);
    }
    for n in &mut mesh.normals {
        *n = placing.turn(*n);
    }
    let mut skin = mesh.into_skin(name)?;
    // From the numbers of the file, those in which places on the skin are given.
    skin.placing = Placing {
        unit_m: placing.unit_m * said.map_or(1.0, |said| said.unit_m as f32),
        up: match said.and_then(|said| said.is_z_up) {
            Some(true) => Up::Z,
            _ => placing.up,
        },
    };
    Ok(skin)
}

impl Skin {
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
