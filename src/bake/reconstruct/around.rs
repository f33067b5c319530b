//! Power around places of a band, and the share of it that is signal.

use super::azimuth;
use super::field::{Field, Plane, Pool};
use crate::math::widest;

/// Rows of azimuth in scales ([`azimuth`]) on a lattice.
#[derive(Clone, Copy)]
pub(super) struct Surroundings {
    /// Cells around.
    pub(super) np: usize,
    /// Steps around.
    pub(super) depth: usize,
}

impl Surroundings {
    /// Shares of bands from their power and that of noise around every place.
    ///
    /// * `bands`: of all rows; `noise`: see [`Surroundings::noise`].
    pub(super) fn shares(
        self,
        bands: &Field<1>,
        exposure: &Plane,
        noise: &Field<1>,
        pool: &mut Pool<1>,
        share: impl Fn(f32, f32) -> f32,
    ) -> Field<1> {
        let [nx, ny, cells] = bands.size;
        let mut power = pool.field(bands.size);
        widest(
            #[inline(always)]
            || {
                let rows = power.values.chunks_exact_mut(cells);
                for ((to, from), exposure) in rows
                    .zip(bands.values.chunks_exact(cells))
                    .zip(&exposure.values)
                {
                    let scale = exposure.powi(2);
                    if scale > 0.0 {
                        for (to, from) in to.iter_mut().zip(from) {
                            to[0] = scale * from[0] * from[0];
                        }
                    }
                }
            },
        );
        let power = self.halved(power, pool);
        let [hx, hy, half] = power.size;
        let mut gains = pool.field([hx, hy, cells]);
        widest(
            #[inline(always)]
            || {
                let mut shares = vec![[0.0]; half];
                let rows = power.values.chunks_exact(half);
                let rows = rows.zip(noise.values.chunks_exact(half));
                for (to, (all, noise)) in gains.values.chunks_exact_mut(cells).zip(rows) {
                    for (to, (all, noise)) in shares.iter_mut().zip(all.iter().zip(noise)) {
                        to[0] = share(all[0], noise[0]);
                    }
                    for [from, end] in azimuth::segments(self.np, self.depth) {
                        azimuth::add_wide(&mut to[from..end], 1.0, &shares[from / 2..end / 2]);
                    }
                }
            },
        );
        pool.give(power);
        for axis in [1, 0] {
            let whole = [nx, ny][axis];
            if gains.size[axis] < whole {
                let mut size = gains.size;
                size[axis] = whole;
                let mut wide = pool.field(size);
                wide.add_coarse(axis, 1.0, &gains, None);
                pool.give(std::mem::replace(&mut gains, wide));
            }
        }
        gains
    }

    /// What noise puts around every place of every band of the rows.
    ///
    /// * `squares`: variance; `norms`: what each scale around takes of it.
    pub(super) fn noise(
        self,
        squares: &Field<1>,
        exposure: &Plane,
        norms: &[f32],
        pool: &mut Pool<1>,
    ) -> Field<1> {
        let [nx, ny, np] = squares.size;
        let cells = azimuth::cells(np, self.depth);
        let mut bands = pool.field([nx, ny, cells]);
        widest(
            #[inline(always)]
            || {
                let rows = bands.values.chunks_exact_mut(cells);
                let rows = rows.zip(squares.values.chunks_exact(np));
                for ((bands, squares), exposure) in rows.zip(&exposure.values) {
                    if exposure.powi(2) <= 0.0 {
                        continue;
                    }
                    bands[..np].copy_from_slice(squares);
                    let mut rest = &mut *bands;
                    for step in 0..self.depth {
                        let (fine, coarse) = rest.split_at_mut(np >> step);
                        azimuth::narrow(fine, &mut coarse[..np >> (step + 1)]);
                        rest = coarse;
                    }
                    let segments = azimuth::segments(np, self.depth);
                    for ([from, to], norm) in segments.zip(norms) {
                        bands[from..to].iter_mut().for_each(|v| v[0] *= norm);
                    }
                }
            },
        );
        self.halved(bands, pool)
    }

    /// Sums over neighbors along every axis that has an even number of cells.
    fn halved(self, bands: Field<1>, pool: &mut Pool<1>) -> Field<1> {
        let mut sums = bands;
        for axis in [0, 1] {
            if sums.size[axis].is_multiple_of(2) {
                let next = sums.reduced(axis, None, pool);
                pool.give(std::mem::replace(&mut sums, next));
            }
        }
        let [nx, ny, cells] = sums.size;
        let mut out = pool.field([nx, ny, cells / 2]);
        widest(
            #[inline(always)]
            || {
                let rows = out.values.chunks_exact_mut(cells / 2);
                for (to, from) in rows.zip(sums.values.chunks_exact(cells)) {
                    for [start, end] in azimuth::segments(self.np, self.depth) {
                        azimuth::narrow(&from[start..end], &mut to[start / 2..end / 2]);
                    }
                }
            },
        );
        pool.give(sums);
        out
    }
}
