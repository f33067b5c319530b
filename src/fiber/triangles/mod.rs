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
mod twist;

pub use error::{MeshError, Places};
use twist::Screw;
pub(super) use twist::{turned, twisted};

use super::{Element, Hit, HitState, MeshPart, Region};
use crate::accel::{Accel, Ray};
use crate::species::FiberMesh;
use glam::{DVec2, DVec3};
use shear::Shear;
use tile::Triangle;

/// How far the search goes beyond a tile, in radii. Tiles hold twice as much.
const OVERLAP: f64 = 1e-3;
/// The hierarchy is asked from this much before the origin on, in radii: it passes over what is nearer
/// than 1e-4, which in corners there are surfaces.
const BEHIND: f64 = 2e-3;
/// Periods that a ray may run along the axis; then it is lost.
const MOST_TILES: usize = 10_000;

/// Triangles ready for tracing.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    /// In the order of traversal.
    tile: Vec<Triangle>,
    accel: Accel,
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
struct Search<'a> {
    shear: Shear,
    /// Only crossings of surfaces that this takes: the triangle and whether it is entered.
    takes: &'a dyn Fn(&Triangle, bool) -> bool,
    /// The surface that the ray starts on.
    from: Option<u32>,
}

/// A triangle that a ray meets.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Distance in radii.
    t: f64,
    index: usize,
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
            let takes = |t: &Triangle, enters: bool| t.sides[usize::from(!enters)] == region;
            self.first(origin, dir, from.map(|(source, _)| source), &takes)?
        };
        let Found {
            t,
            index,
            enters,
            image,
        } = found;
        let triangle = &self.tile[index];
        let normal = self.screw.turn(triangle.normal, image);
        let normal = if enters { normal } else { -normal };
        let t = t * self.radius_um;
        Some(Hit {
            t,
            pigment_um: t,
            normal,
            to: triangle.sides[usize::from(enters)],
            part: triangle.part,
            state: HitState {
                element: Element::Triangle {
                    source: triangle.source,
                    part: triangle.part,
                },
            },
        })
    }

    /// The first triangle taken.
    fn first(
        &self,
        origin: DVec3,
        dir: DVec3,
        from: Option<u32>,
        takes: &dyn Fn(&Triangle, bool) -> bool,
    ) -> Option<Found> {
        self.each_tile(origin, dir, from, |stretch, from| {
            let Stretch { origin, dir, .. } = *stretch;
            let search = Search {
                shear: Shear::new(origin, dir),
                takes,
                from,
            };
            let (t, index, enters) = self.first_in_tile(origin, dir, stretch.beyond, &search)?;
            Some(Found {
                t: stretch.before + t,
                index,
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
        let (begin, end) = within_unit_cylinder(origin, dir)?;
        let mut before = begin.max(0.0);
        if before >= end {
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
            let stretch = Stretch {
                origin: self.screw.turn(local, -image),
                dir: self.screw.turn(dir, -image),
                before,
                length: way(0.0).max(0.0).min(end - before),
                beyond: way(OVERLAP).min(end - before),
                image,
            };
            let found = visit(&stretch, from.filter(|_| before <= 0.5 * period));
            if found.is_some() {
                return found;
            }
            before += way(0.0).max(0.0);
            if before >= end {
                return None;
            }
            image += dir.z.signum();
        }
        None
    }

    fn first_in_tile(
        &self,
        origin: DVec3,
        dir: DVec3,
        limit: f64,
        search: &Search<'_>,
    ) -> Option<(f64, usize, bool)> {
        let ray = Ray {
            origin: (origin - BEHIND * dir).as_vec3(),
            dir: dir.as_vec3(),
        };
        let reach = |t: f64| (t + 1.5 * BEHIND) as f32;
        let mut best: Option<(f64, usize, bool)> = None;
        // The hierarchy sees single precision; what is nearest is decided here.
        let _ = self.accel.closest(&ray, reach(limit), |index, _| {
            let triangle = &self.tile[index];
            let meeting = search.shear.meet(&triangle.corners)?;
            let t = meeting.t;
            if !(t >= 0.0 && t <= limit)
                || search.from == Some(triangle.source)
                || !(search.takes)(triangle, meeting.enters)
            {
                return None;
            }
            let is_nearer = best
                .is_none_or(|(b, i, _)| t < b || (t == b && triangle.source < self.tile[i].source));
            if !is_nearer {
                return None;
            }
            best = Some((t, index, meeting.enters));
            Some(reach(t))
        });
        best
    }
}

/// Where a ray is within a cylinder a little wider than the mesh.
fn within_unit_cylinder(origin: DVec3, dir: DVec3) -> Option<(f64, f64)> {
    const SQUARE: f64 = 1.0 + 1e-5;
    let (o, d): (DVec2, DVec2) = (origin.truncate(), dir.truncate());
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - SQUARE);
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
