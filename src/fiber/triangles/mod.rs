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
mod overlap;
mod seam;
mod shear;
mod solid;
#[cfg(test)]
mod tests;
mod tile;
mod topology;
mod tree;
mod twist;

pub use error::{MeshError, Places};
use twist::Screw;
pub(super) use twist::{turned, twisted};

use super::{Element, Hit, HitState, MeshPart, Region};
use crate::species::FiberMesh;
use glam::{DVec2, DVec3};
use shear::{Meeting, Shear};
use tree::{Candidate, Kind, Tree};

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

/// What of a ray a region's surfaces are.
struct Search {
    shear: Shear,
    /// Where it runs.
    region: Region,
    /// The surface that the ray starts on.
    from: Option<u32>,
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

/// The part of a ray in one tile, in the place of the mesh.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    origin: DVec3,
    dir: DVec3,
    /// Way of the ray before it, to the end of the tile, and a little beyond, in radii.
    before: f64,
    length: f64,
    beyond: f64,
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
    pub(super) fn next_hit(
        &self,
        origin: DVec3,
        dir: DVec3,
        region: Region,
        from: Option<HitState>,
    ) -> Option<Hit> {
        let from = match from.map(|f| f.element) {
            Some(Element::Triangle { source, part }) => Some((source, part)),
            _ => None,
        };
        let origin = origin / self.radius_um;
        let found = if self.layered && matches!(region, Region::Void | Region::Medulla) {
            self.last_of_layers(origin, dir, region, from)?
        } else {
            self.first(origin, dir, from.map(|(source, _)| source), region)?
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

    /// The first triangle that bounds a region, met from within it.
    fn first(
        &self,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
        region: Region,
    ) -> Option<Found<'_>> {
        self.each_tile(origin, dir, from, |stretch, from| {
            let Stretch { origin, dir, .. } = *stretch;
            let search = Search {
                shear: Shear::new(origin, dir),
                region,
                from,
            };
            let (t, triangle, enters) = self.first_in_tile(stretch.beyond, &search)?;
            Some(Found {
                t: stretch.before + t,
                triangle,
                enters,
                image: stretch.image,
            })
        })
    }

    /// Goes along a ray from tile to tile until `visit` has found something or the ray has left the
    /// cylinder about the mesh.
    fn each_tile<T>(
        &self,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
        mut visit: impl FnMut(&Stretch, Option<u32>) -> Option<T>,
    ) -> Option<T> {
        let period = self.screw.period;
        // A ray that starts within the cylinder about the mesh meets nothing behind that: where it leaves it, is asked
        // for when the first tile has nothing.
        let (mut before, mut end) = match is_within_cylinder(origin) {
            true => (0.0, None),
            false => {
                let (begin, end) = within_cylinder(origin, dir)?;
                (begin.max(0.0), Some(end))
            }
        };
        if end.is_some_and(|end| before >= end) {
            return None;
        }
        // Where it starts decides the tile; beyond that only the direction does.
        let start = origin + before * dir;
        let mut image = (start.z / period).floor();
        for _ in 0..MOST_TILES {
            let mut local = origin + before * dir;
            local.z -= image * period;
            let way = |to: f64| match dir.z {
                dz if dz > 0.0 => (period + to - local.z) / dz,
                dz if dz < 0.0 => (-to - local.z) / dz,
                _ => f64::INFINITY,
            };
            let most = end.map_or(f64::INFINITY, |end| end - before);
            let stretch = Stretch {
                origin: self.screw.turn(local, -image),
                dir: self.screw.turn(dir, -image),
                before,
                length: way(0.0).max(0.0).min(most),
                beyond: way(OVERLAP).min(most),
                image,
            };
            let found = visit(&stretch, from.filter(|_| before <= 0.5 * period));
            if found.is_some() {
                return found;
            }
            before += way(0.0).max(0.0);
            let leaves = || within_cylinder(origin, dir).map_or(0.0, |(_, end)| end);
            if before >= *end.get_or_insert_with(leaves) {
                return None;
            }
            image += dir.z.signum();
        }
        None
    }

    fn first_in_tile(&self, limit: f64, search: &Search) -> Option<(f64, Candidate<'_>, bool)> {
        let mut best: Option<(f64, Candidate<'_>, bool)> = None;
        let kind = Kind::around(search.region);
        // The tree sees single precision; what is nearest is decided here.
        self.tree.visit(&search.shear, limit, kind, |triangle| {
            let Meeting { t, enters } = search.shear.meet(&triangle.corners())?;
            if !(t >= 0.0 && t <= limit && triangle.is_of(kind, enters)) {
                return None;
            }
            // Labels come last: they are read where something is met.
            let source = triangle.label().source;
            let is_nearer =
                best.is_none_or(|(b, other, _)| t < b || (t == b && source < other.label().source));
            if !is_nearer || search.from == Some(source) {
                return None;
            }
            best = Some((t, triangle, enters));
            Some(t)
        });
        best
    }
}

/// Square of the radius of a cylinder a little wider than the mesh.
const CYLINDER: f64 = 1.0 + 1e-5;

fn is_within_cylinder(point: DVec3) -> bool {
    point.truncate().length_squared() - CYLINDER < 0.0
}

/// Where a ray is within the cylinder about the mesh.
fn within_cylinder(origin: DVec3, dir: DVec3) -> Option<(f64, f64)> {
    let (o, d): (DVec2, DVec2) = (origin.truncate(), dir.truncate());
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - CYLINDER);
    if a < 1e-30 {
        return (c < 0.0).then_some((0.0, f64::INFINITY));
    }
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    Some(((-b - root) / a, (-b + root) / a))
}
