//! Pigment along eight rays.

use super::super::cortex::{Lean, Pigment};
use super::rays::UnitRays;
use crate::math::lanes::{F64x8, Mask, Wide};

impl Pigment {
    /// [`Pigment::along`] without pieces, and the lanes in which it is known.
    #[inline(always)]
    pub(super) fn along_rays<W: Wide>(
        &self,
        simd: W,
        lanes: Mask<W>,
        ray: &UnitRays<W>,
        t: F64x8<W>,
    ) -> (F64x8<W>, Mask<W>) {
        if self.is_streaked() {
            return (t, simd.none());
        }
        let zero = simd.all(0.0);
        let (mut from, mut to) = (zero, zero);
        if self.ratio > 0.0 {
            let square = simd.all(self.ratio * self.ratio);
            let end = ray.c + t * (2.0 * ray.b + t * ray.a);
            let within = ray.c.max(end).le(square);
            let (a, b, near) = ray.inside_circle(simd, self.ratio);
            from = zero.or(within, a.max(zero).or(near, zero));
            to = t.or(within, b.min(t).or(near, zero));
        }
        let inside = (to - from).max(zero);
        let core = self.walls * inside;
        let Some(lean) = &self.lean else {
            return (t - inside + core, simd.every());
        };
        let apart = inside.gt(zero);
        let first = lean.integral_along(simd, lanes, ray, zero, from.or(apart, t));
        let split = lanes & apart;
        if !split.any() {
            return (first, !ray.steep(simd));
        }
        let second = lean.integral_along(simd, split, ray, to, t);
        ((core + first + second).or(apart, first), !ray.steep(simd))
    }
}

impl Lean {
    /// [`Lean::integral`], 0 where `t1` is not after `t0`; not for rays along the axis.
    #[inline(always)]
    fn integral_along<W: Wide>(
        &self,
        simd: W,
        lanes: Mask<W>,
        ray: &UnitRays<W>,
        t0: F64x8<W>,
        t1: F64x8<W>,
    ) -> F64x8<W> {
        let zero = simd.all(0.0);
        let (a, b, near) = ray.inside_circle(simd, self.rim);
        let some = t0.lt(t1) & near;
        let (t0, t1) = (t0.max(a), t1.min(b));
        let some = lanes & some & t0.lt(t1);
        if !some.any() {
            return zero;
        }
        let flat = self.base * (t1 - t0);
        if self.rise == 0.0 {
            return flat.or(some, zero);
        }
        let foot = -ray.b / ray.a;
        let k = (ray.c - ray.b * ray.b / ray.a).max(zero);
        let root = ray.a.sqrt();
        let (s0, s1) = (root * (t0 - foot), root * (t1 - foot));
        let (rho0, rho1) = ((s0 * s0 + k).sqrt(), (s1 * s1 + k).sqrt());
        let sum0 = (k / (rho0 - s0)).or(s0.lt(zero), rho0 + s0);
        let sum1 = (k / (rho1 - s1)).or(s1.lt(zero), rho1 + s1);
        let bent = some & k.gt(simd.all(1e-20));
        let mut logs = (sum1 / sum0).row();
        for lane in bent.lanes() {
            logs.0[lane] = logs.0[lane].ln();
        }
        let log = (k * simd.load(&logs)).or(bent, zero);
        let radius = 0.5 * (s1 * rho1 - s0 * rho0 + log) / root;
        (flat - self.rise * radius).or(some, zero)
    }
}
