//! Surfaces of one kind that overlap or hold each other, by counting: each crossing inward is one more
//! layer, each outward one less, and what has a layer or more is inside. A surface wound inward within
//! another takes a layer away: an island.

use super::shear::Shear;
use super::solid::Bound;
use super::tile::Triangle;
use super::{BEHIND, Found, Triangles};
use crate::accel::Ray;
use crate::fiber::{Part, Region};
use glam::DVec3;

/// Crossings of one surface in one direction that are nearer to each other than this, in radii, are
/// one: a ray through an edge meets the triangles on both sides of it.
const SAME: f64 = 1e-12;

/// A crossing of a surface that is counted.
#[derive(Clone, Copy)]
struct Crossing {
    t: f64,
    index: usize,
    enters: bool,
}

impl Triangles {
    /// Where a ray in some layers of voids, or of a medium, has left all of them, or meets what lies
    /// within them.
    ///
    /// * `from`: the surface that it starts on.
    pub(super) fn last_of_layers(
        &self,
        origin: DVec3,
        dir: DVec3,
        region: Region,
        from: Option<(u32, Part)>,
    ) -> Option<Found> {
        let bound = match region {
            Region::Medulla => Bound::Medulla,
            _ => Bound::Void,
        };
        // The boundary of a union has one layer on its inner side; elsewhere they are counted.
        let on_it = from.is_some_and(|(_, part)| match bound {
            Bound::Medulla => part == Part::Medulla,
            _ => part == Part::Void,
        });
        let from = from.map(|(source, _)| source);
        let mut layers = if on_it {
            1
        } else {
            self.layers(origin, dir, bound)
        };
        self.each_tile(origin, dir, from, |stretch, from| {
            let counts =
                |t: &Triangle, enters: bool| t.bound == bound || (enters && t.sides[0] == region);
            for c in self.crossings(stretch.origin, stretch.dir, stretch.length, from, &counts) {
                let found = Found {
                    t: stretch.before + c.t,
                    index: c.index,
                    enters: c.enters,
                    image: stretch.image,
                };
                if self.tile[c.index].bound != bound {
                    return Some(found);
                }
                layers += if c.enters { 1 } else { -1 };
                if layers <= 0 {
                    return Some(found);
                }
            }
            None
        })
    }

    /// How many layers of a kind a point has, by all that a ray from it crosses.
    fn layers(&self, origin: DVec3, dir: DVec3, bound: Bound) -> i32 {
        let mut layers = 0;
        self.each_tile(origin, dir, None, |stretch, _| {
            let of = |t: &Triangle, _: bool| t.bound == bound;
            for c in self.crossings(stretch.origin, stretch.dir, stretch.length, None, &of) {
                layers += if c.enters { -1 } else { 1 };
            }
            None::<()>
        });
        layers
    }

    /// The innermost of some kinds of surfaces that hold a point: the region there.
    pub(super) fn region_by(&self, point: DVec3, which: &dyn Fn(Bound) -> bool) -> Region {
        let (sin, cos) = 1.234_567_f64.sin_cos();
        let dir = DVec3::new(cos, sin, 0.0);
        let mut layers = [0; Bound::ALL.len()];
        let mut inside = [Region::Outside; Bound::ALL.len()];
        self.each_tile(point, dir, None, |stretch, _| {
            let of = |t: &Triangle, _: bool| which(t.bound);
            for c in self.crossings(stretch.origin, stretch.dir, stretch.length, None, &of) {
                let triangle = &self.tile[c.index];
                let bound = triangle.bound as usize;
                layers[bound] += if c.enters { -1 } else { 1 };
                inside[bound] = triangle.sides[1];
            }
            None::<()>
        });
        let innermost = (0..layers.len()).rev().find(|&bound| layers[bound] > 0);
        innermost.map_or(Region::Outside, |bound| inside[bound])
    }

    /// How many layers of void other shells than its own put over a point.
    pub(super) fn layers_of_others(&self, point: DVec3, bound: Bound, shell: u32) -> i32 {
        let (sin, cos) = 1.234_567_f64.sin_cos();
        let dir = DVec3::new(cos, sin, 0.0);
        let mut layers = 0;
        self.each_tile(point, dir, None, |stretch, _| {
            let of = |t: &Triangle, _: bool| t.bound == bound && t.shell != shell;
            for c in self.crossings(stretch.origin, stretch.dir, stretch.length, None, &of) {
                layers += if c.enters { -1 } else { 1 };
            }
            None::<()>
        });
        layers
    }

    /// All crossings in a tile that are to be counted, in order.
    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        length: f64,
        from: Option<u32>,
        counts: &dyn Fn(&Triangle, bool) -> bool,
    ) -> Vec<Crossing> {
        let shear = Shear::new(origin, dir);
        let ray = Ray {
            origin: (origin - BEHIND * dir).as_vec3(),
            dir: dir.as_vec3(),
        };
        let mut all: Vec<Crossing> = Vec::new();
        let reach = (length + 1.5 * BEHIND) as f32;
        let _ = self.accel.closest(&ray, reach, |index, _| {
            let triangle = &self.tile[index];
            let meeting = shear.meet(&triangle.corners)?;
            let within = meeting.t >= 0.0 && meeting.t < length;
            if within && from != Some(triangle.source) && counts(triangle, meeting.enters) {
                all.push(Crossing {
                    t: meeting.t,
                    index,
                    enters: meeting.enters,
                });
            }
            None
        });
        all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.index.cmp(&b.index)));
        let key = |c: &Crossing| (self.tile[c.index].shell, c.enters);
        all.dedup_by(|b, a| b.t - a.t < SAME && key(a) == key(b));
        all
    }
}
