//! Intersection of a ray with one strand segment: the only file that knows the shape of a strand.
//!
//! A segment is a ribbon that faces the ray, its half width going linearly from end to end, with
//! round ends. Scattering tables describe light that has crossed the whole fiber, seen from far
//! away, so nothing but the distance between ray and axis matters; a round tube would ask for a
//! quadratic and give the same picture.

use crate::accel::lanes::Numbers;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Two ends of a segment, scene units (millimeters): xyz the axis, w half the width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// End toward the root.
    pub root: Vec4,
    /// End toward the tip.
    pub tip: Vec4,
}

impl Segment {
    /// Where a ray meets the ribbon.
    ///
    /// * `dir`: unit length.
    /// * Returns the distance along the ray, which may be negative, and the place along the segment,
    ///   0 root .. 1 tip.
    pub fn intersect(&self, origin: Vec3, dir: Vec3) -> Option<(f32, f32)> {
        let along = self.nearest(origin, dir);
        let at = self.root.lerp(self.tip, along);
        let to = at.xyz() - origin;
        let depth = to.dot(dir);
        let distance2 = (to - depth * dir).length_squared();
        (distance2 <= at.w * at.w).then_some((depth, along))
    }

    /// The place along the segment, 0 root .. 1 tip, that is nearest to a ray or to the line behind it.
    ///
    /// * `dir`: unit length.
    #[inline(always)]
    pub fn nearest(&self, origin: Vec3, dir: Vec3) -> f32 {
        // Both vectors projected onto the plane across the ray.
        let flat = |v: Vec3| v - v.dot(dir) * dir;
        let root = flat(self.root.xyz() - origin);
        let axis = flat(self.tip.xyz() - self.root.xyz());
        let along = -root.dot(axis) / axis.length_squared().max(f32::MIN_POSITIVE);
        along.clamp(0.0, 1.0)
    }
}

/// Axes seen along a ray: two across it and its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// Columns: from the scene to them.
    columns: [Vec4; 3],
}

impl Across {
    /// * `dir`: unit length.
    #[inline(always)]
    pub(super) fn new(dir: Vec3) -> Self {
        let (u, v) = dir.any_orthonormal_pair();
        let column = |axis: usize| Vec4::new(u[axis], v[axis], dir[axis], 0.0);
        Self {
            columns: [column(0), column(1), column(2)],
        }
    }

    /// Points along the axes, as seen from another.
    #[inline(always)]
    pub(super) fn see<N: Numbers>(&self, points: &[N; 3], from: Vec4) -> Seen<N> {
        let [x, y, z] = self.columns;
        let from = x * from.x + y * from.y + z * from.z;
        Seen {
            across: [self.axis(0, points, from), self.axis(1, points, from)],
            depth: self.axis(2, points, from),
        }
    }

    #[inline(always)]
    fn axis<N: Numbers>(&self, axis: usize, points: &[N; 3], from: Vec4) -> N {
        let [x, y, z] = &self.columns;
        let xy = (points[0].mul(N::splat(x[axis]))).add(points[1].mul(N::splat(y[axis])));
        let all = xy.add(points[2].mul(N::splat(z[axis])));
        all.sub(N::splat(from[axis]))
    }
}

/// Points as seen along a ray: across it, and how far along it they are.
#[derive(Clone, Copy)]
pub(super) struct Seen<N> {
    pub(super) across: [N; 2],
    pub(super) depth: N,
}

/// Segments side by side as seen along a ray.
pub(super) struct Segments<N> {
    pub(super) root: Seen<N>,
    pub(super) tip: Seen<N>,
    /// Half widths.
    pub(super) widths: [N; 2],
}

impl<N: Numbers> Segments<N> {
    /// Which of them the ray meets, ahead or behind, a bit each, and how far along it: as [`Segment::intersect`] but for
    /// rounding.
    ///
    /// * `unit`: of the half widths, in that of the other lengths.
    #[inline(always)]
    pub(super) fn meet(&self, unit: f32) -> (u32, N) {
        let (root, tip) = (&self.root, &self.tip);
        let [x, y] = root.across;
        let (dx, dy) = (tip.across[0].sub(x), tip.across[1].sub(y));
        let length2 = dx.mul(dx).add(dy.mul(dy));
        let (zero, one) = (N::splat(0.0), N::splat(1.0));
        let against = zero.sub(x.mul(dx).add(y.mul(dy)));
        let along = against.div(length2.max(N::splat(f32::MIN_POSITIVE)));
        let along = along.max(zero).min(one);
        let (x, y) = (x.add(along.mul(dx)), y.add(along.mul(dy)));
        let [from, to] = self.widths;
        let radius = from.add(along.mul(to.sub(from))).mul(N::splat(unit));
        let is_met = x.mul(x).add(y.mul(y)).le(radius.mul(radius));
        let slope = tip.depth.sub(root.depth);
        (is_met, root.depth.add(along.mul(slope)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn random_vec(rng: &mut Rng) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| rng.uniform_f32() - 0.5))
    }

    #[test]
    fn agrees_with_a_search_along_the_axis() {
        let mut rng = Rng::new(1, 0);
        let (mut hits, n) = (0, 4_000);
        for _ in 0..n {
            let (a, b) = (random_vec(&mut rng), random_vec(&mut rng));
            let (ra, rb) = (0.3 * rng.uniform_f32(), 0.3 * rng.uniform_f32());
            let segment = Segment {
                root: a.extend(ra),
                tip: b.extend(rb),
            };
            let origin = 3.0 * random_vec(&mut rng);
            let dir = (random_vec(&mut rng) - origin).normalize();
            // The axis point whose distance across the ray is least, found by a scan in f64.
            let (o, d) = (origin.as_dvec3(), dir.as_dvec3().normalize());
            let (mut best, mut at, mut depth) = (f64::INFINITY, 0.0, 0.0);
            for i in 0..=2_000 {
                let s = f64::from(i) / 2_000.0;
                let p = a.as_dvec3().lerp(b.as_dvec3(), s) - o;
                let across = p.cross(d).length();
                if across < best {
                    (best, at, depth) = (across, s, p.dot(d));
                }
            }
            let radius = f64::from(ra) * (1.0 - at) + f64::from(rb) * at;
            if (best - radius).abs() < 1e-3 {
                continue;
            }
            let found = segment.intersect(origin, dir);
            assert_eq!(found.is_some(), best < radius);
            if let Some((t, s)) = found {
                assert!((f64::from(s) - at).abs() < 2e-3 && (f64::from(t) - depth).abs() < 2e-3);
                hits += 1;
            }
        }
        assert!(hits > n / 20);
    }

    #[test]
    fn survives_a_ray_along_the_axis() {
        let segment = Segment {
            root: Vec4::new(0.0, 0.0, 1.0, 0.1),
            tip: Vec4::new(0.0, 0.0, 2.0, 0.1),
        };
        let (t, _) = segment.intersect(Vec3::ZERO, Vec3::Z).unwrap();
        assert!((1.0..=2.0).contains(&t));
        assert!(segment.intersect(Vec3::X, Vec3::Z).is_none());
    }
}
