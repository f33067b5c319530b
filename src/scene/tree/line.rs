//! Rays as the search has them.

use super::super::ribbon::Across;
use crate::accel::Ray;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// A ball around all strands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    middle: Vec3,
    radius: f32,
}

impl Ball {
    /// * `joints`: half width in w.
    pub(super) fn around(joints: &[Vec4]) -> Self {
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for joint in joints {
            lo = lo.min(joint.xyz() - joint.w);
            hi = hi.max(joint.xyz() + joint.w);
        }
        Self {
            middle: 0.5 * (lo + hi),
            radius: 0.501 * (hi - lo).length(),
        }
    }

    /// How far from where it is a [`Line`] may be for a box or a leaf, by rounding: some thirty times half of the last
    /// place of coordinates that are at most twice the radius.
    pub(super) fn blur(&self) -> f32 {
        32.0 * f32::EPSILON * self.radius
    }
}

/// A ray from where it comes near the strands on, so that from there on nothing is far away and rounding has a bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) origin: Vec4,
    /// Unit length.
    pub(super) dir: Vec4,
    pub(super) across: Across,
    /// Distance of the origin from that of the ray.
    pub(super) ahead: f32,
}

impl Line {
    #[inline(always)]
    pub(super) fn new(ray: &Ray, ball: &Ball) -> Self {
        let ahead = (ball.middle - ray.origin).dot(ray.dir) * (1.0 - 1e-6) - ball.radius;
        let (origin, ahead) = match ahead > 0.0 {
            true => {
                let way = f64::from(ahead) * ray.dir.as_dvec3();
                ((ray.origin.as_dvec3() + way).as_vec3(), ahead)
            }
            false => (ray.origin, 0.0),
        };
        Self {
            origin: origin.extend(0.0),
            dir: ray.dir.extend(0.0),
            across: Across::new(ray.dir),
            ahead,
        }
    }

    /// A distance from the origin of the ray as one along this line, not less.
    #[inline(always)]
    pub(super) fn along(&self, t: f32) -> f32 {
        (t - self.ahead) + (4.0 * f32::EPSILON) * t.abs().max(self.ahead)
    }
}
