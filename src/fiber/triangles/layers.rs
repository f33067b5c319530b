//! Surfaces of one kind that overlap or hold each other, by counting: each crossing inward is one more
//! layer, each outward one less, and what has a layer or more is inside. A surface wound inward within
//! another takes a layer away: an island.

use super::shear::Meeting;
use super::solid::Bound;
use super::tree::{Candidate, Kind};
use super::way::{Stretch, Way};
use super::{Found, Triangles};
use crate::fiber::trace::Ray;
use crate::fiber::{Part, Region};
use glam::DVec3;

/// Crossings of one surface in one direction that are nearer to each other than this, in radii, are
/// one: a ray through an edge meets the triangles on both sides of it.
const SAME: f64 = 1e-12;

/// Whose layers are counted in a region, if any are.
pub(super) fn counted_in(region: Region) -> Option<(Bound, Part)> {
    match region {
        Region::Medulla => Some((Bound::Medulla, Part::Medulla)),
        Region::Void => Some((Bound::Void, Part::Void)),
        _ => None,
    }
}

/// A crossing of a surface that is counted.
#[derive(Clone, Copy)]
struct Crossing<'a> {
    t: f64,
    triangle: Candidate<'a>,
    enters: bool,
}

impl Triangles {
    /// Where a ray in some layers of voids, or of a medium, has left all of them, or meets what lies
    /// within them.
    ///
    /// * `origin`: that of the ray, in radii.
    pub(super) fn last_of_layers(&self, origin: DVec3, ray: &Ray) -> Option<Found<'_>> {
        let (region, dir) = (ray.region, ray.dir);
        let (bound, part) = counted_in(region)?;
        let (from, on) = ray.triangle().unzip();
        // The boundary of a union has one layer on its inner side; elsewhere they are counted.
        let on_it = on == Some(part);
        let mut layers = if on_it {
            1
        } else {
            self.layers(origin, dir, bound)
        };
        let kind = Kind::layers(bound);
        let mut some: Vec<Crossing<'_>> = Vec::new();
        Way::new(self.screw, origin, dir)?.find_map(|stretch| {
            let from = from.filter(|_| stretch.is_first);
            let (shear, length) = (&stretch.ray, stretch.length());
            let mut last: Option<Crossing<'_>> = None;
            let mut after = 0.0;
            loop {
                // All crossings up to the next outward one: as a rule there is none before it.
                some.clear();
                let mut end = length;
                self.tree.visit(shear, end, kind, |triangle| {
                    let Meeting { t, enters } = shear.meet(&triangle.corners())?;
                    let label = triangle.label();
                    let counts = label.bound == bound || (enters && label.sides[0] == region);
                    if !(t >= after && t < end) || from == Some(label.source) || !counts {
                        return None;
                    }
                    some.push(Crossing {
                        t,
                        triangle,
                        enters,
                    });
                    if enters {
                        return None;
                    }
                    end = end.min(t + SAME);
                    Some(end)
                });
                some.retain(|c| c.t < end);
                self.tidy(&mut some);
                for &c in &some {
                    if last.is_some_and(|last| self.is_same(&last, &c)) {
                        continue;
                    }
                    last = Some(c);
                    let found = Found {
                        t: stretch.before + c.t,
                        triangle: c.triangle,
                        enters: c.enters,
                        image: stretch.image,
                    };
                    if c.triangle.label().bound != bound {
                        return Some(found);
                    }
                    layers += if c.enters { 1 } else { -1 };
                    if layers <= 0 {
                        return Some(found);
                    }
                }
                if end >= length {
                    return None;
                }
                after = end;
            }
        })
    }

    /// How many layers of a kind a point has, by all that a ray from it crosses.
    fn layers(&self, origin: DVec3, dir: DVec3, bound: Bound) -> i32 {
        let mut layers = 0;
        for stretch in self.stretches(origin, dir) {
            let of = |t: Candidate<'_>| t.label().bound == bound;
            for c in self.crossings(&stretch, &of) {
                layers += if c.enters { -1 } else { 1 };
            }
        }
        layers
    }

    /// The innermost of some kinds of surfaces that hold a point: the region there.
    pub(super) fn region_by(&self, point: DVec3, which: &dyn Fn(Bound) -> bool) -> Region {
        let (sin, cos) = 1.234_567_f64.sin_cos();
        let dir = DVec3::new(cos, sin, 0.0);
        let mut layers = [0; Bound::ALL.len()];
        let mut inside = [Region::Outside; Bound::ALL.len()];
        for stretch in self.stretches(point, dir) {
            let of = |t: Candidate<'_>| which(t.label().bound);
            for c in self.crossings(&stretch, &of) {
                let label = c.triangle.label();
                let bound = label.bound as usize;
                layers[bound] += if c.enters { -1 } else { 1 };
                inside[bound] = label.sides[1];
            }
        }
        let innermost = (0..layers.len()).rev().find(|&bound| layers[bound] > 0);
        innermost.map_or(Region::Outside, |bound| inside[bound])
    }

    /// How many layers of void other shells than its own put over a point.
    pub(super) fn layers_of_others(&self, point: DVec3, bound: Bound, shell: u32) -> i32 {
        let (sin, cos) = 1.234_567_f64.sin_cos();
        let dir = DVec3::new(cos, sin, 0.0);
        let mut layers = 0;
        for stretch in self.stretches(point, dir) {
            let of = |t: Candidate<'_>| t.label().bound == bound && self.shells[t.place()] != shell;
            for c in self.crossings(&stretch, &of) {
                layers += if c.enters { -1 } else { 1 };
            }
        }
        layers
    }

    fn stretches(&self, origin: DVec3, dir: DVec3) -> impl Iterator<Item = Stretch> {
        Way::new(self.screw, origin, dir).into_iter().flatten()
    }

    /// All crossings in a tile that are to be counted, in order.
    fn crossings(
        &self,
        stretch: &Stretch,
        counts: &dyn Fn(Candidate<'_>) -> bool,
    ) -> Vec<Crossing<'_>> {
        let (shear, length) = (&stretch.ray, stretch.length());
        let mut all: Vec<Crossing<'_>> = Vec::new();
        (self.tree).visit(shear, length, Kind::ALL, |triangle| {
            let Meeting { t, enters } = shear.meet(&triangle.corners())?;
            if t >= 0.0 && t < length && counts(triangle) {
                all.push(Crossing {
                    t,
                    triangle,
                    enters,
                });
            }
            None
        });
        self.tidy(&mut all);
        all
    }

    /// Puts crossings in order and takes out those that are there twice.
    fn tidy(&self, crossings: &mut Vec<Crossing<'_>>) {
        crossings.sort_by(|a, b| {
            let order = |c: &Crossing<'_>| c.triangle.label().source;
            a.t.total_cmp(&b.t).then(order(a).cmp(&order(b)))
        });
        crossings.dedup_by(|b, a| self.is_same(a, b));
    }

    /// Whether two crossings, one after the other, are one.
    fn is_same(&self, a: &Crossing<'_>, b: &Crossing<'_>) -> bool {
        let key = |c: &Crossing<'_>| (self.shells[c.triangle.place()], c.enters);
        b.t - a.t < SAME && key(a) == key(b)
    }
}
