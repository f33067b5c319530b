//! Vectors eight at a time, with the bits of [`glam::DVec3`].

use super::{F64x8, Mask, Wide};

/// Eight vectors.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<W: Wide> {
    pub(crate) x: F64x8<W>,
    pub(crate) y: F64x8<W>,
    pub(crate) z: F64x8<W>,
}

impl<W: Wide> Vectors<W> {
    #[inline(always)]
    pub(crate) fn new(x: F64x8<W>, y: F64x8<W>, z: F64x8<W>) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> F64x8<W> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn times(self, by: F64x8<W>) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }

    /// Of length 1.
    #[inline(always)]
    pub(crate) fn normalized(self) -> Self {
        self.times(1.0 / self.dot(self).sqrt())
    }

    /// These in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: Mask<W>, other: Self) -> Self {
        Self::new(
            self.x.or(mask, other.x),
            self.y.or(mask, other.y),
            self.z.or(mask, other.z),
        )
    }
}
