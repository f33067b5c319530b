//! What a stage shows and is not read: a sentence a kind, not one a prim.

use super::stage::REMEDY;
use crate::usd_file::Prim;

/// Surfaces that are no meshes.
const SHAPES: [&str; 9] = [
    "Capsule",
    "Capsule_1",
    "Cone",
    "Cube",
    "Cylinder",
    "Cylinder_1",
    "NurbsPatch",
    "Plane",
    "Sphere",
];

/// Why a prim is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    /// It takes something from another in a way that is not followed.
    Inherits,
    /// Of this nothing is shown but the instances.
    Instancer,
    /// A surface of this type.
    Shape(&'static str),
}

impl Reason {
    /// All that hold for a prim.
    pub(super) fn of(prim: &Prim) -> impl Iterator<Item = Self> {
        let arcs = ["inherits", "inheritPaths", "specializes"];
        let inherits = arcs.iter().any(|arc| prim.field(arc).is_some());
        let is_instancer = prim.type_name == "PointInstancer";
        let shape = SHAPES.into_iter().find(|shape| *shape == prim.type_name);
        (inherits.then_some(Self::Inherits).into_iter())
            .chain(is_instancer.then_some(Self::Instancer))
            .chain(shape.map(Self::Shape))
    }
}

/// Of each reason the path of the first prim, and how many there are.
#[derive(Default)]
pub(super) struct Unread(Vec<(Reason, String, usize)>);

impl Unread {
    pub(super) fn add(&mut self, reason: Reason, path: &str) {
        match self.0.iter_mut().find(|(known, ..)| *known == reason) {
            Some((.., count)) => *count += 1,
            None => self.0.push((reason, path.to_owned(), 1)),
        }
    }

    /// A sentence each.
    pub(super) fn remarks(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|(reason, first, count)| {
            let all = match count {
                1 => first.clone(),
                _ => format!("{first} (and {} more)", count - 1),
            };
            match reason {
                Reason::Inherits => {
                    format!("what {all} inherits or specializes is not read: {REMEDY}")
                }
                Reason::Instancer => format!(
                    "{all} is a PointInstancer, of which nothing is read: turn its instances into meshes"
                ),
                Reason::Shape(kind) => {
                    format!("{all} is a {kind} and not read: turn it into a mesh")
                }
            }
        })
    }
}
