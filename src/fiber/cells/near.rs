//! A cell near a point, to begin a search from.

use glam::{DVec2, DVec3, IVec3};

/// For each box of a coarse grid a cell that is there or near.
#[derive(Clone, Debug)]
pub(super) struct Near {
    pub(super) inverse: DVec3,
    pub(super) count: IVec3,
    pub(super) cells: Vec<u32>,
}

/// Boxes of the coarse grid along an axis at most.
const MOST_BOXES: f64 = 64.0;

impl Near {
    pub(super) fn new(semi: DVec2, period: f64, size: f64) -> Self {
        let whole = (2.0 * semi).extend(period);
        let count = (whole / size)
            .ceil()
            .clamp(DVec3::ONE, DVec3::splat(MOST_BOXES));
        Self {
            inverse: count / whole,
            count: count.as_ivec3(),
            cells: Vec::new(),
        }
    }

    #[inline]
    pub(super) fn cell(&self, p: DVec3, semi: DVec2, period: f64) -> u32 {
        let z = p.z - period * (p.z / period).floor();
        let at = DVec3::new(p.x + semi.x, p.y + semi.y, z) * self.inverse;
        let b = at.as_ivec3().clamp(IVec3::ZERO, self.count - IVec3::ONE);
        self.cells[((b.z * self.count.y + b.y) * self.count.x + b.x) as usize]
    }
}
