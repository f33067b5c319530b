//! Intersection of a ray with one strand segment: the only file that knows the shape of a strand.
//!
//! A segment is a ribbon that faces the ray, its half width going linearly from end to end, with
//! round ends. Scattering tables describe light that has crossed the whole fiber, seen from far
//! away, so nothing but the distance between ray and axis matters; a round tube would ask for a
//! quadratic and give the same picture.

use super::tree::Lanes;
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
    #[inline(always)]
    pub fn intersect(&self, origin: Vec3, dir: Vec3) -> Option<(f32, f32)> {
        let to_root = self.root.xyz() - origin;
        let axis = self.tip.xyz() - self.root.xyz();
        let (depth, slope) = (to_root.dot(dir), axis.dot(dir));
        // Both vectors projected onto the plane across the ray.
        let (flat_root, flat_axis) = (to_root - depth * dir, axis - slope * dir);
        let along = -flat_root.dot(flat_axis) / flat_axis.length_squared().max(f32::MIN_POSITIVE);
        let along = along.clamp(0.0, 1.0);
        let radius = self.root.w + along * (self.tip.w - self.root.w);
        let distance2 = (flat_root + along * flat_axis).length_squared();
        (distance2 <= radius * radius).then_some((depth + along * slope, along))
    }
}

/// Eight segments, lane by lane: x, y and z of both ends, and half widths.
pub(super) struct Eight<L: Lanes> {
    pub(super) root: ([L::F; 3], L::F),
    pub(super) tip: ([L::F; 3], L::F),
}

impl<L: Lanes> Eight<L> {
    /// Which of them a ray meets ahead of its start and up to `limit`, a bit each, and where: to the bit what
    /// [`Segment::intersect`] says.
    #[inline(always)]
    pub(super) fn intersect(&self, origin: Vec3, dir: Vec3, limit: f32) -> (u32, L::F) {
        let (root, tip) = (&self.root, &self.tip);
        let dir = [L::splat(dir.x), L::splat(dir.y), L::splat(dir.z)];
        let origin = [L::splat(origin.x), L::splat(origin.y), L::splat(origin.z)];
        let to_root = minus::<L>(&root.0, &origin);
        let axis = minus::<L>(&tip.0, &root.0);
        let (depth, slope) = (dot::<L>(&to_root, &dir), dot::<L>(&axis, &dir));
        let flat_root = minus::<L>(&to_root, &times::<L>(depth, &dir));
        let flat_axis = minus::<L>(&axis, &times::<L>(slope, &dir));
        let least = L::splat(f32::MIN_POSITIVE);
        let against = L::sub(L::splat(0.0), dot::<L>(&flat_root, &flat_axis));
        let along = L::div(against, L::max(dot::<L>(&flat_axis, &flat_axis), least));
        let along = L::min(L::max(along, L::splat(0.0)), L::splat(1.0));
        let radius = L::add(root.1, L::mul(along, L::sub(tip.1, root.1)));
        let off = plus::<L>(&flat_root, &times::<L>(along, &flat_axis));
        let t = L::add(depth, L::mul(along, slope));
        let near = L::le(dot::<L>(&off, &off), L::mul(radius, radius));
        (
            near & L::le(t, L::splat(limit)) & !L::le(t, L::splat(0.0)),
            t,
        )
    }
}

// Functions rather than closures, which would not be compiled for the processor that their caller is for.

#[inline(always)]
fn dot<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> L::F {
    let xy = L::add(L::mul(a[0], b[0]), L::mul(a[1], b[1]));
    L::add(xy, L::mul(a[2], b[2]))
}

#[inline(always)]
fn plus<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> [L::F; 3] {
    [L::add(a[0], b[0]), L::add(a[1], b[1]), L::add(a[2], b[2])]
}

#[inline(always)]
fn minus<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> [L::F; 3] {
    [L::sub(a[0], b[0]), L::sub(a[1], b[1]), L::sub(a[2], b[2])]
}

#[inline(always)]
fn times<L: Lanes>(t: L::F, b: &[L::F; 3]) -> [L::F; 3] {
    [L::mul(t, b[0]), L::mul(t, b[1]), L::mul(t, b[2])]
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
