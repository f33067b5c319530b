//! Four triangles.

use super::{KINDS, Kinds, Label, Ray};
use glam::{DVec3, Vec4};

/// Triangles of a leaf at most.
pub(super) const SIZE: usize = 4;

/// Corners in steps that are the same for the whole tree, so that they are exact: all that it takes to
/// decide what a ray meets is in three lines of a cache.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Leaf {
    corners: [[[i32; 4]; 3]; 3],
    /// What is known of each.
    pub(super) labels: [Label; 4],
    /// Longest side, in radii.
    longest: f32,
    /// For each kind the triangles that are of it if entered, a bit each, and if left, four bits up.
    pub(super) holds: [u8; KINDS],
}

impl Leaf {
    /// * `corners`: of one to four triangles, in radii, all of them whole steps. * `step`: in radii.
    pub(super) fn new(corners: &[[DVec3; 3]], step: f64) -> Self {
        let last = corners.len() - 1;
        let longest = corners.iter().fold(0.0f64, |most, [a, b, c]| {
            most.max((*b - *a).length()).max((*c - *a).length())
        });
        let used = ((1u32 << corners.len()) - 1) as u8;
        Self {
            corners: [0, 1, 2].map(|corner| {
                std::array::from_fn(|axis| {
                    std::array::from_fn(|k| (corners[k.min(last)][corner][axis] / step) as i32)
                })
            }),
            labels: [Label::NONE; 4],
            longest: (longest as f32).next_up(),
            holds: [used | used << 4; KINDS],
        }
    }

    /// How many triangles there are.
    pub(super) fn count(&self) -> usize {
        (self.holds[KINDS - 1] & 0xf).trailing_ones() as usize
    }

    /// Corners of a triangle, in radii, to the bit as they were given.
    #[inline(always)]
    pub(super) fn corners(&self, k: usize, step: f64) -> [DVec3; 3] {
        let k = k & 3;
        [0, 1, 2].map(|corner| {
            let c = &self.corners[corner];
            step * DVec3::new(f64::from(c[0][k]), f64::from(c[1][k]), f64::from(c[2][k]))
        })
    }

    /// Turns a triangle inside out.
    pub(super) fn turn(&mut self, k: usize) {
        for axis in 0..3 {
            let other = self.corners[1][axis][k];
            self.corners[1][axis][k] = std::mem::replace(&mut self.corners[2][axis][k], other);
        }
    }

    /// Which of the triangles a ray may meet: the test of Moeller and Trumbore (1997) without divisions,
    /// with room for rounding.
    #[inline(always)]
    pub(super) fn meets(&self, ray: &Ray, step: f32, room: f32, limit: f32, kinds: Kinds) -> u32 {
        let holds = u32::from(kinds.held(&self.holds));
        if holds == 0 {
            return 0;
        }
        let axes = [0, 1, 2];
        let [a, b, c] = &self.corners;
        let from = axes.map(|k| ray.origin[k] - step * wide(a[k]));
        // Differences of whole numbers, which are exact.
        let side = |p: &[[i32; 4]; 3]| {
            axes.map(|k| step * wide(std::array::from_fn(|i| p[k][i].wrapping_sub(a[k][i]))))
        };
        let (u, v) = (side(b), side(c));
        let p = cross(&ray.dir, &v);
        let q = cross(&from, &u);
        let det = dot(&u, &p);
        let across = room * self.longest;
        let along = 2.0 * across * self.longest;
        // Positive if the ray runs against the outward normal.
        let enters = det.cmpge(Vec4::splat(-along)).bitmask();
        let leaves = det.cmple(Vec4::splat(along)).bitmask();
        let sign = det.signum();
        let det = det.abs();
        let (x, y) = (sign * dot(&from, &p), sign * dot(&ray.dir, &q));
        let t = sign * dot(&v, &q);
        let within = x.min(y).min(det - x - y).cmpge(Vec4::splat(-2.0 * across));
        let ahead = t.cmpge(Vec4::splat(-along)) & t.cmple(limit * det + along);
        (within & ahead).bitmask() & (holds & enters | holds >> 4 & leaves)
    }
}

#[inline(always)]
fn wide(steps: [i32; 4]) -> Vec4 {
    Vec4::from_array(steps.map(|s| s as f32))
}

#[inline(always)]
fn dot(a: &[Vec4; 3], b: &[Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: &[Vec4; 3], b: &[Vec4; 3]) -> [Vec4; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
