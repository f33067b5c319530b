//! A lattice in scales, each axis by itself, and the share of every scale that is signal.
//!
//! A Laplacian pyramid (Burt and Adelson 1983) along x, then y, then azimuth: what a coarser lattice
//! cannot hold is a band, and the bands add up to the lattice. Means over x and y are weighted by
//! exposure. Bands are kept by the share of their power, around a place, that noise does not
//! explain; what comes out shows where signal is, and with that the shares are taken again
//! (empirical Wiener filtering in two steps, Ghael, Sayeed and Baraniuk 1997).

use super::around::Surroundings;
use super::azimuth;
use super::field::{Field, Plane, Pool};
use crate::math::widest;

/// Most cells around that a row and its scales have.
const MOST: usize = 128;

/// How much noise counts in the second round, where it is held against the first round's result, which has lost part of
/// the signal: at 1 errors are a twentieth to a tenth larger, at 0.1 noise passes for signal with 2.5e4 photons.
const AFTER_PILOT: f32 = 0.25;

/// Exposure at all steps along x and y, the latter running fastest.
pub(super) struct Planes(Vec<Vec<Plane>>);

/// Shares of all bands: for each pair of steps along x and y the bands of every row.
pub(super) struct Gains(Vec<Vec<f32>>);

/// How a lattice is taken apart.
#[derive(Debug)]
pub(super) struct Pyramid {
    size: [usize; 3],
    /// Steps along each axis.
    depth: [usize; 3],
    /// `[axis][step]`: squared norm of what a band takes from white noise along an axis.
    norms: [Vec<f32>; 3],
}

impl Pyramid {
    /// * `size`: cells along x, y and azimuth.
    pub(super) fn new(size: [usize; 3]) -> Self {
        // Down to 8 cells around, 3 along the cone and 2 over half the azimuth.
        let steps = |n: usize, least: usize| (n / least).ilog2() as usize;
        let depth = [steps(size[0], 8), steps(size[1], 3), steps(size[2], 2)];
        Self {
            size,
            depth,
            norms: [0, 1, 2].map(|axis| norms(size[axis], depth[axis])),
        }
    }

    /// Exposure at all steps.
    pub(super) fn planes(&self, exposure: Plane) -> Planes {
        let mut planes = vec![vec![exposure]];
        for a in 1..=self.depth[0] {
            planes.push(vec![planes[a - 1][0].reduced(0)]);
        }
        for along_y in &mut planes {
            for c in 1..=self.depth[1] {
                along_y.push(along_y[c - 1].reduced(1));
            }
        }
        Planes(planes)
    }

    /// Cells of a row and its scales around.
    fn cells(&self) -> usize {
        azimuth::cells(self.size[2], self.depth[2])
    }

    /// Number of a pair of steps along x and y.
    fn number(&self, steps: [usize; 2]) -> usize {
        steps[0] * (self.depth[1] + 1) + steps[1]
    }

    /// Takes a field apart along x and y.
    ///
    /// * `again`: whether what `band` leaves of the parts is put together again.
    fn walk<const N: usize>(
        &self,
        planes: &Planes,
        field: &mut Field<N>,
        again: bool,
        band: &mut impl FnMut([usize; 2], &mut Field<N>),
    ) {
        self.scale(0, [0; 2], planes, field, &mut Pool::default(), again, band);
    }

    #[expect(clippy::too_many_arguments, reason = "one place in a recursion")]
    fn scale<const N: usize>(
        &self,
        axis: usize,
        steps: [usize; 2],
        planes: &Planes,
        field: &mut Field<N>,
        pool: &mut Pool<N>,
        again: bool,
        band: &mut impl FnMut([usize; 2], &mut Field<N>),
    ) {
        if axis == 2 {
            return band(steps, field);
        }
        if steps[axis] == self.depth[axis] {
            return self.scale(axis + 1, steps, planes, field, pool, again, band);
        }
        let mut next = steps;
        next[axis] += 1;
        let inside = [steps, next].map(|steps| planes.at(steps));
        let mut coarse = field.reduced(axis, Some(inside[0]), pool);
        field.add_coarse(axis, -1.0, &coarse, Some(inside));
        self.scale(axis + 1, steps, planes, field, pool, again, band);
        self.scale(axis, next, planes, &mut coarse, pool, again, band);
        if again {
            field.add_coarse(axis, 1.0, &coarse, Some(inside));
        }
        pool.give(coarse);
    }

    /// The shares to keep of S.
    ///
    /// * `s`: photons over exposure; `squares`: variance of the photons.
    pub(super) fn gains(
        &self,
        planes: &Planes,
        s: &Field<1>,
        squares: Field<1>,
        caution: f32,
    ) -> Gains {
        let mut pool = Pool::default();
        let noise = self.noise(planes, squares, &mut pool);
        let [np, depth] = [self.size[2], self.depth[2]];
        let around = Surroundings { np, depth };
        // The coarsest band of all is kept whole.
        let keep_last = |steps: [usize; 2], gains: &mut Field<1>| {
            if steps == [self.depth[0], self.depth[1]] {
                let cells = gains.size[2];
                for row in gains.values.chunks_exact_mut(cells) {
                    row[cells - (np >> depth)..].fill([1.0]);
                }
            }
        };
        let mut clean = s.clone();
        self.walk(planes, &mut clean, true, &mut |steps, field| {
            let (plane, noise) = (planes.at(steps), &noise[self.number(steps)]);
            let mut bands = self.split(plane, field, &mut pool);
            let mut gains = around.shares(&bands, plane, noise, &mut pool, |all, noise| {
                super::share(all, noise, caution)
            });
            keep_last(steps, &mut gains);
            widest(
                #[inline(always)]
                || {
                    let cells = bands.size[2];
                    let rows = bands.values.chunks_exact_mut(cells);
                    let rows = rows.zip(gains.values.chunks_exact(cells));
                    let rows = rows.zip(field.values.chunks_exact_mut(np));
                    for (((bands, gains), field), _) in rows.zip(&plane.values).filter(inside) {
                        for (v, gain) in bands.iter_mut().zip(gains) {
                            v[0] *= gain[0];
                        }
                        azimuth::join(bands, np, depth);
                        field.copy_from_slice(&bands[..np]);
                    }
                },
            );
            pool.give(bands);
            pool.give(gains);
        });
        clean.values.iter_mut().for_each(|v| v[0] = v[0].max(0.0));
        let mut all = Vec::new();
        self.walk(planes, &mut clean, false, &mut |steps, field| {
            let (plane, noise) = (planes.at(steps), &noise[self.number(steps)]);
            let bands = self.split(plane, field, &mut pool);
            let mut gains = around.shares(&bands, plane, noise, &mut pool, |signal, noise| {
                if signal > 0.0 {
                    signal / (signal + AFTER_PILOT * noise)
                } else {
                    0.0
                }
            });
            keep_last(steps, &mut gains);
            pool.give(bands);
            all.push(gains.values.into_flattened());
        });
        Gains(all)
    }

    /// The bands around of every row that is anything.
    fn split(&self, plane: &Plane, field: &Field<1>, pool: &mut Pool<1>) -> Field<1> {
        let [nx, ny, np] = field.size;
        let mut bands = pool.field([nx, ny, self.cells()]);
        widest(
            #[inline(always)]
            || {
                let rows = bands.values.chunks_exact_mut(self.cells());
                let rows = rows.zip(field.values.chunks_exact(np));
                for ((bands, field), _) in rows.zip(&plane.values).filter(inside) {
                    bands[..np].copy_from_slice(field);
                    azimuth::split(bands, np, self.depth[2]);
                }
            },
        );
        bands
    }

    /// What noise puts into the surroundings of every place of every band.
    fn noise(&self, planes: &Planes, squares: Field<1>, pool: &mut Pool<1>) -> Vec<Field<1>> {
        let [np, depth] = [self.size[2], self.depth[2]];
        let around = Surroundings { np, depth };
        let mut noise = Vec::new();
        let mut along_x = squares;
        for a in 0..=self.depth[0] {
            let mut along_y = along_x.clone();
            for c in 0..=self.depth[1] {
                let norms: Vec<f32> = self.norms[2]
                    .iter()
                    .map(|norm| self.norms[0][a] * self.norms[1][c] * norm)
                    .collect();
                noise.push(around.noise(&along_y, planes.at([a, c]), &norms, pool));
                if c < self.depth[1] {
                    let next = along_y.reduced(1, None, pool);
                    pool.give(std::mem::replace(&mut along_y, next));
                }
            }
            pool.give(along_y);
            if a < self.depth[0] {
                let next = along_x.reduced(0, None, pool);
                pool.give(std::mem::replace(&mut along_x, next));
            }
        }
        noise
    }

    /// S with only those shares of its bands.
    ///
    /// * `gains`: of the first two lanes and of the others.
    pub(super) fn apply(&self, planes: &Planes, field: &mut Field<4>, gains: [&Gains; 2]) {
        let [np, depth] = [self.size[2], self.depth[2]];
        let cells = self.cells();
        self.walk(planes, field, true, &mut |steps, field| {
            let [first, others] = gains.map(|gains| &gains.0[self.number(steps)]);
            let plane = planes.at(steps);
            widest(
                #[inline(always)]
                || {
                    let mut bands = [[0.0; 4]; MOST];
                    let bands = &mut bands[..cells];
                    let rows = field.values.chunks_exact_mut(np);
                    let rows = rows.zip(first.chunks_exact(cells));
                    let rows = rows.zip(others.chunks_exact(cells));
                    for (((field, first), others), _) in rows.zip(&plane.values).filter(inside) {
                        bands[..np].copy_from_slice(field);
                        azimuth::split(bands, np, depth);
                        for (v, (a, b)) in bands.iter_mut().zip(first.iter().zip(others)) {
                            *v = [v[0] * a, v[1] * a, v[2] * b, v[3] * b];
                        }
                        azimuth::join(bands, np, depth);
                        field.copy_from_slice(&bands[..np]);
                    }
                },
            );
        });
    }
}

/// Whether photons reach a row.
fn inside<T>((_, exposure): &(T, &f32)) -> bool {
    **exposure > 0.0
}

impl Planes {
    fn at(&self, steps: [usize; 2]) -> &Plane {
        &self.0[steps[0]][steps[1]]
    }
}

/// Squared norms along one axis: what the bands hold, a cell, of noise of variance 1 a cell.
fn norms(cells: usize, depth: usize) -> Vec<f32> {
    let mut sums = vec![0.0; depth + 1];
    // Impulses at as many places as the coarsest step can tell apart, in the middle.
    let places = (1 << depth).min(cells);
    let mut bands = vec![[0.0f32]; azimuth::cells(cells, depth)];
    for place in 0..places {
        bands.fill([0.0]);
        bands[(cells - places) / 2 + place] = [1.0];
        azimuth::split(&mut bands, cells, depth);
        let segments = azimuth::segments(cells, depth);
        for (step, ([from, to], sum)) in segments.zip(&mut sums).enumerate() {
            let power: f32 = bands[from..to].iter().map(|v| v[0] * v[0]).sum();
            // One impulse in all cells of a band: so many cells of the lattice a cell of it.
            *sum += power * (1 << step) as f32 / places as f32;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    /// Uneven exposure with an empty corner, and noise on it.
    fn scene(size: [usize; 3]) -> (Plane, Field<1>, Field<1>) {
        let mut rng = Rng::new(1, 1);
        let mut exposure = Plane::new(size[0], size[1]);
        for (row, value) in exposure.values.iter_mut().enumerate() {
            let inside = row / size[1] >= 8 || row % size[1] < 6;
            *value = if inside {
                50.0 + 30.0 * rng.uniform_f32()
            } else {
                0.0
            };
        }
        let (mut s, mut squares) = (Field::new(size), Field::new(size));
        let cells = s.values.iter_mut().zip(&mut squares.values);
        for (cell, (s, squares)) in cells.enumerate() {
            let exposure = exposure.values[cell / size[2]];
            if exposure > 0.0 {
                // Photons of weight 1, a mean of 2 in units of S.
                let count = 2.0 * exposure;
                let noise = rng.normal_pair().0 as f32;
                s[0] = (count + noise * count.sqrt()) / exposure;
                squares[0] = count;
            }
        }
        (exposure, s, squares)
    }

    #[test]
    fn bands_add_up_to_the_lattice() {
        let size = [32, 12, 16];
        let pyramid = Pyramid::new(size);
        let (exposure, s, _) = scene(size);
        let planes = pyramid.planes(exposure);
        let (mut bands, mut same) = (0, s.clone());
        pyramid.walk(&planes, &mut same, true, &mut |_, _| bands += 1);
        assert_eq!(bands, 3 * 3);
        for (a, b) in same.values.iter().zip(&s.values) {
            assert!((a[0] - b[0]).abs() < 1e-5);
        }
    }

    #[test]
    fn a_constant_loses_its_noise_and_a_lobe_stays() {
        let size = [32, 12, 16];
        let pyramid = Pyramid::new(size);
        let (exposure, s, squares) = scene(size);
        let off = |s: &Field<1>, lobe: bool| {
            let (mut off, mut count) = (0.0, 0.0);
            for (cell, v) in s.values.iter().enumerate() {
                if exposure.values[cell / size[2]] > 0.0 {
                    let height = if lobe {
                        lobe_at(cell / (size[1] * size[2]))
                    } else {
                        0.0
                    };
                    off += f64::from(v[0] - 2.0 - height).powi(2);
                    count += 1.0;
                }
            }
            (off / count).sqrt()
        };
        let filtered = |s: &Field<1>| {
            let planes = pyramid.planes(exposure.clone());
            let gains = pyramid.gains(&planes, s, squares.clone(), 0.5);
            let mut fields = Field::new(size);
            for (to, v) in fields.values.iter_mut().zip(&s.values) {
                *to = [0.0, 0.0, v[0], 0.0];
            }
            pyramid.apply(&planes, &mut fields, [&gains, &gains]);
            fields.lane(2)
        };
        let (before, after) = (off(&s, false), off(&filtered(&s), false));
        assert!(after < 0.2 * before, "{after} of {before}");
        let mut with_lobe = s.clone();
        for (cell, v) in with_lobe.values.iter_mut().enumerate() {
            if exposure.values[cell / size[2]] > 0.0 {
                v[0] += lobe_at(cell / (size[1] * size[2]));
            }
        }
        let after = off(&filtered(&with_lobe), true);
        assert!(after < 0.6 * before, "{after} of {before}");
    }

    /// A lobe of two cells along x, far above the noise.
    fn lobe_at(x: usize) -> f32 {
        if x == 16 || x == 17 { 10.0 } else { 0.0 }
    }
}
