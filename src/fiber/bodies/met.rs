//! Which bodies a ray has been tested with.

/// The bodies that a ray has been tested with last: they reach over several cells of the grid.
pub(super) struct Met {
    bodies: [u32; Met::KEPT],
    heights: [f64; Met::KEPT],
    next: usize,
    /// Two images of a body are farther apart than this, two cells that it reaches into are nearer.
    near: f64,
}

impl Met {
    /// A power of two.
    const KEPT: usize = 8;

    #[inline]
    pub(super) fn new(period: f64) -> Self {
        Self {
            bodies: [u32::MAX; Self::KEPT],
            heights: [0.0; Self::KEPT],
            next: 0,
            near: 0.25 * period,
        }
    }

    /// Whether a body's image next to `z` is among them; if not it is from now on.
    #[inline]
    pub(super) fn before(&mut self, index: u32, z: f64) -> bool {
        let known = (0..Self::KEPT)
            .any(|i| self.bodies[i] == index && (self.heights[i] - z).abs() < self.near);
        if !known {
            (self.bodies[self.next], self.heights[self.next]) = (index, z);
            self.next = (self.next + 1) % Self::KEPT;
        }
        known
    }
}
