//! Quadratics along eight rays, and where they turn negative.

use super::cells::Pair;
use crate::math::lanes::{F64x8, Mask, Wide};

/// `c + 2 b t + a t^2`; see [`super::super::crossing::Quadratic`].
pub(super) struct Quadratics<W: Wide> {
    pub(super) a: F64x8<W>,
    pub(super) b: F64x8<W>,
    pub(super) c: F64x8<W>,
}

impl<W: Wide> Quadratics<W> {
    #[inline(always)]
    pub(super) fn falling_root(&self, simd: W) -> F64x8<W> {
        let zero = simd.all(0.0);
        let root = (self.b * self.b - self.a * self.c).max(zero).sqrt();
        let q = root - self.b;
        let early = (self.c / q).or(q.gt(zero), zero);
        early.or(self.b.le(zero), -(self.b + root) / self.a)
    }

    /// Those that turn negative up to `limit`, and where.
    #[inline(always)]
    pub(super) fn turn_negative(&self, simd: W, limit: F64x8<W>) -> (Mask<W>, F64x8<W>) {
        let zero = simd.all(0.0);
        let end = self.c + limit * (2.0 * self.b + limit * self.a);
        let falls = end.lt(zero)
            | (self.a.gt(zero)
                & self.b.lt(zero)
                & (-self.b).lt(limit * self.a)
                & (self.b * self.b).gt(self.a * self.c));
        let at_once = self.c.is(zero) & self.b.le(zero);
        let root = self.falling_root(simd).max(zero).min(limit);
        (falls, zero.or(at_once, root))
    }
}

/// Distances from both planes and heights, and how they change along the rays.
pub(super) struct Window<W: Wide> {
    pub(super) a: F64x8<W>,
    pub(super) b: F64x8<W>,
    pub(super) da: F64x8<W>,
    pub(super) db: F64x8<W>,
    pub(super) z: F64x8<W>,
    pub(super) dz: F64x8<W>,
}

impl<W: Wide> Window<W> {
    /// `(a + b) (end(u) - z)`: positive below the end. See `Window::below` for one ray.
    #[inline(always)]
    pub(super) fn below(&self, end: Pair<W>) -> Quadratics<W> {
        let (w, dw) = (self.a + self.b, self.da + self.db);
        let (e0, e1) = (end[0] - self.z, end[1] - self.z);
        Quadratics {
            a: -self.dz * dw,
            b: 0.5 * (e0 * self.db + e1 * self.da - self.dz * w),
            c: e0 * self.b + e1 * self.a,
        }
    }
}
