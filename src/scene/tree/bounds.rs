//! Boxes along some axes.

use glam::{Vec3A, Vec3Swizzles};

/// A box, by two corners.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) lo: Vec3A,
    pub(super) hi: Vec3A,
}

impl Bounds {
    pub(super) const NONE: Self = Self {
        lo: Vec3A::INFINITY,
        hi: Vec3A::NEG_INFINITY,
    };

    /// Around a point.
    pub(super) fn at(point: Vec3A) -> Self {
        Self {
            lo: point,
            hi: point,
        }
    }

    pub(super) fn with(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// Half of its surface; 0 for none.
    pub(super) fn area(&self) -> f32 {
        let size = (self.hi - self.lo).max(Vec3A::ZERO);
        size.dot(size.yzx())
    }

    /// Twice its middle.
    pub(super) fn middle(&self) -> Vec3A {
        self.lo + self.hi
    }
}
