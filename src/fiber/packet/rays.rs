//! Eight rays in the unit-circle frame.

use super::super::section::Section;
use crate::math::lanes::{F64x8, Mask, Vectors, Wide};

/// See [`super::super::section::UnitRay`].
#[derive(Clone, Copy)]
pub(super) struct UnitRays<W: Wide> {
    pub(super) at: Vectors<W>,
    pub(super) by: Vectors<W>,
    pub(super) a: F64x8<W>,
    pub(super) b: F64x8<W>,
    pub(super) c: F64x8<W>,
    inverse_a: F64x8<W>,
}

impl<W: Wide> UnitRays<W> {
    #[inline(always)]
    pub(super) fn new(section: &Section, origin: Vectors<W>, dir: Vectors<W>) -> Self {
        let [ia, ib] = section.inverse;
        let at = Vectors::new(origin.x * ia, origin.y * ib, origin.z);
        let by = Vectors::new(dir.x * ia, dir.y * ib, dir.z);
        let a = by.x * by.x + by.y * by.y;
        Self {
            at,
            by,
            a,
            b: at.x * by.x + at.y * by.y,
            c: at.x * at.x + at.y * at.y,
            inverse_a: 1.0 / a,
        }
    }

    /// The points at `t`.
    #[inline(always)]
    pub(super) fn at(&self, t: F64x8<W>) -> Vectors<W> {
        self.at.plus(self.by.times(t))
    }

    /// Those that are nearly along the axis.
    #[inline(always)]
    pub(super) fn axial(&self, simd: W) -> Mask<W> {
        self.a.lt(simd.all(1e-30))
    }

    /// Those so nearly along the axis that pigment takes another formula.
    #[inline(always)]
    pub(super) fn steep(&self, simd: W) -> Mask<W> {
        self.a.lt(simd.all(1e-12))
    }

    /// Where the rays' lines are inside the circle of radius `r`, and which ever are; see
    /// [`super::super::section::UnitRay::inside_circle`]. Not for axial ones.
    #[inline(always)]
    pub(super) fn inside_circle(&self, simd: W, r: f64) -> (F64x8<W>, F64x8<W>, Mask<W>) {
        let zero = simd.all(0.0);
        let c = self.c - r * r;
        let discriminant = self.b * self.b - self.a * c;
        let root = discriminant.sqrt();
        let inward = self.b.gt(zero);
        let q = (-self.b - root).or(inward, root - self.b);
        let (near, far) = (c / q, q * self.inverse_a);
        (
            far.or(inward, near),
            near.or(inward, far),
            discriminant.gt(zero),
        )
    }
}
