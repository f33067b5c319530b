//! How deep in microsurfaces eight walks are: [`super::super::microfacet`] lane by lane, with the same bits.

use super::super::microfacet::{Depth, FLAT, STEEP, Slope};
use crate::math::lanes::{F64x8, Mask, Row, Vectors, Wide};

/// Eight [`Depth`]s.
#[derive(Clone)]
pub(super) struct Depths<W: Wide> {
    pub(super) top: F64x8<W>,
    pub(super) base: F64x8<W>,
    pub(super) across: F64x8<W>,
    pub(super) along: F64x8<W>,
    pub(super) flipped: Mask<W>,
}

impl<W: Wide> Depths<W> {
    /// The rays that meet the microsurface again, at the depth that is then theirs; the others got
    /// away. See [`Depth::free`].
    #[inline(always)]
    pub(super) fn free(
        &mut self,
        simd: W,
        lanes: Mask<W>,
        d: Vectors<W>,
        alpha: F64x8<W>,
        u: F64x8<W>,
    ) -> Mask<W> {
        let (zero, one) = (simd.all(0.0), simd.all(1.0));
        let across = alpha * alpha * (d.x * d.x + d.y * d.y);
        let along = d.z * d.z;
        let upward = d.z.ge(simd.all(FLAT));
        let gain = 4.0 * along * u + across;
        let plain = (self.top * self.base * gain).gt(across);
        let whole = 4.0 * self.along + self.across;
        let least = whole - self.top * (whole - 4.0 * self.along * (1.0 - self.base));
        let turned = (least * gain).gt(across * whole);
        let gone = upward & ((self.flipped & turned) | (!self.flipped & plain));
        let mut walking = lanes & !gone;
        let downward = walking & d.z.le(simd.all(-FLAT));
        // What takes powers: shares below a place that is not the start, and rays up that no bound decides.
        let start = self.base.is(one) & !self.flipped;
        let slow = walking & (upward | (downward & !start));
        let quick = downward & start;
        let steep = d.z.lt(simd.all(-STEEP));
        let old = [self.top, self.base, self.across, self.along];
        self.top = (u * self.top).or(quick & steep, self.top);
        self.base = (1.0 - u).or(quick & !steep, self.base);
        self.across = zero.or(quick & steep, across.or(quick, self.across));
        self.along = one.or(quick & steep, along.or(quick, self.along));
        if slow.any() {
            let old = [old[0].row(), old[1].row(), old[2].row(), old[3].row()];
            let rays = [d.z.row(), across.row(), along.row(), u.row()];
            let gone = self.by_power(simd, slow, &old, &rays);
            walking = walking & !gone;
        }
        walking
    }

    /// What takes powers, one ray after another; those that get away.
    ///
    /// * `old`: depths before. * `rays`: cosine, slope and random number of each.
    #[inline(always)]
    fn by_power(&mut self, simd: W, slow: Mask<W>, old: &[Row; 4], rays: &[Row; 4]) -> Mask<W> {
        let (mut gone, mut flipped) = (0, self.flipped.bits());
        let mut new = [
            self.top.row(),
            self.base.row(),
            self.across.row(),
            self.along.row(),
        ];
        for lane in slow.lanes() {
            let [top, base, across, along] = old.map(|row| row.0[lane]);
            let depth = Depth {
                top,
                base,
                slope: Slope { across, along },
                flipped: flipped >> lane & 1 != 0,
            };
            let [z, across, along, u] = rays.map(|row| row.0[lane]);
            let here = 1 << lane;
            match depth.free_along(z, Slope { across, along }, u) {
                Some(depth) => {
                    let Slope { across, along } = depth.slope;
                    let parts = [depth.top, depth.base, across, along];
                    for (row, part) in new.iter_mut().zip(parts) {
                        row.0[lane] = part;
                    }
                    flipped = if depth.flipped {
                        flipped | here
                    } else {
                        flipped & !here
                    };
                }
                None => gone |= here,
            }
        }
        self.flipped = simd.lanes(flipped);
        self.top = simd.load(&new[0]);
        self.base = simd.load(&new[1]);
        self.across = simd.load(&new[2]);
        self.along = simd.load(&new[3]);
        simd.lanes(gone)
    }
}
