//! Boxes along some axes.

use glam::Vec3;

/// A box, by two corners.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
}

impl Bounds {
    pub(super) const NONE: Self = Self {
        lo: Vec3::INFINITY,
        hi: Vec3::NEG_INFINITY,
    };

    pub(super) fn with(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// Half of its surface; 0 for none.
    pub(super) fn area(&self) -> f32 {
        let size = (self.hi - self.lo).max(Vec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// Twice its middle.
    pub(super) fn middle(&self) -> Vec3 {
        self.lo + self.hi
    }
}
