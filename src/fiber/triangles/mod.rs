//! A fiber as triangles of one period, from a designer's mesh.
//!
//! The period is cut into a tile: all triangles and images of triangles that touch `0 <= z <= period`,
//! in units of the radius. A ray goes from tile to tile. Which side of a surface it is on is state,
//! not measured: of all triangles on its way only those count that bound the region it is in, crossed
//! in the direction that leaves it. So no distance has to tell a surface from itself, and what grazes
//! an edge that two triangles share crosses one of them.
//!
//! Closed surfaces of voids may overlap: what is in any of them is in the void. And they may hold each
//! other: one that faces inward within another is solid. Then crossings are counted (see [`layers`]).
//!
//! Images of a period may be turned about the axis as well as moved along it: a twisted hair.

mod error;
mod layers;
mod nearest;
mod overlap;
mod seam;
mod shear;
mod solid;
#[cfg(test)]
mod tests;
mod tile;
mod topology;
mod tree;
mod turns;
mod twist;
mod way;

pub use error::{MeshError, Places};
pub(crate) use turns::{SEARCHES, Turns};
use twist::Screw;
pub(super) use twist::{turned, twisted};

use super::trace::Ray;
use super::{Element, Hit, HitState, MeshPart, Region};
use crate::species::FiberMesh;
use glam::DVec3;
use nearest::Quest;
use tree::{Candidate, Tree};

/// How far the search goes beyond a tile, in radii. Tiles hold twice as much.
const OVERLAP: f64 = 1e-3;
/// Periods that a ray may run along the axis; then it is lost.
const MOST_TILES: usize = 10_000;

/// Triangles ready for tracing.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    tree: Tree,
    /// The closed surface that each triangle belongs to, by its place in the tree.
    shells: Vec<u32>,
    /// In units of the radius.
    screw: Screw,
    /// Whether some surfaces overlap or hold others, so that crossings have to be counted.
    layered: bool,
    pub(super) radius_um: f64,
    /// Volume of the voids over that of the least cylinder about the axis that holds them.
    pub(super) air_fraction: f64,
    pub(super) void_count: usize,
    /// Half extents across, micrometers.
    pub(super) semi_axes_um: [f64; 2],
    /// The surfaces of one period, micrometers.
    pub(super) parts: Vec<MeshPart>,
    pub(super) warnings: Vec<String>,
}

/// Whose mesh it is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Maker {
    /// A designer's: all of it is checked.
    Designer,
    /// Our own: surfaces that go through each other are known.
    Own {
        /// Whether voids do.
        overlap: bool,
    },
}

/// A triangle that a ray meets.
#[derive(Clone, Copy, Debug)]
struct Found<'a> {
    /// Distance in radii.
    t: f64,
    triangle: Candidate<'a>,
    enters: bool,
    /// Periods between its tile and the mesh.
    image: f64,
}

impl Triangles {
    /// Checks a mesh and prepares it.
    ///
    /// # Errors
    ///
    /// * `is_medium`: whether parts named medulla are a medium rather than voids.
    /// * `twist`: radians per micrometer by which images are turned about the axis.
    pub(super) fn new(
        mesh: &FiberMesh,
        is_medium: bool,
        twist: f64,
        maker: Maker,
    ) -> Result<Self, MeshError> {
        tile::build(mesh, is_medium, twist, maker)
    }

    /// Length of one period, micrometers.
    pub(super) fn period_um(&self) -> f64 {
        self.screw.period * self.radius_um
    }

    /// The region that holds a point.
    pub(super) fn region_at(&self, point: DVec3) -> Region {
        self.region_by(point / self.radius_um, &|_| true)
    }

    /// The next boundary of a ray, as [`super::Fiber::next_hit`].
    pub(super) fn next_hit(&self, ray: &Ray) -> Option<Hit> {
        self.hit(ray, |quest| {
            self.first(ray.origin / self.radius_um, ray.dir, quest)
        })
    }

    /// The next boundary of a ray.
    ///
    /// * `first`: finds the first of what the ray is to meet.
    fn hit<'a>(
        &'a self,
        ray: &Ray,
        first: impl FnOnce(&Quest) -> Option<Found<'a>>,
    ) -> Option<Hit> {
        let counted = || self.last_of_layers(ray.origin / self.radius_um, ray);
        let found = match Quest::new(self.layered, ray) {
            Some(quest) => match first(&quest)? {
                found if quest.is_met_by(&found) => found,
                _ => counted()?,
            },
            None => counted()?,
        };
        let Found {
            t,
            triangle,
            enters,
            image,
        } = found;
        let [a, b, c] = triangle.corners();
        let normal = (b - a).cross(c - a).normalize();
        let normal = self
            .screw
            .turn(if enters { normal } else { -normal }, image);
        let label = triangle.label();
        let t = t * self.radius_um;
        Some(Hit {
            t,
            pigment_um: t,
            normal,
            to: label.sides[usize::from(enters)],
            part: label.part,
            state: HitState {
                element: Element::Triangle {
                    source: label.source,
                    part: label.part,
                },
            },
        })
    }
}
