//! A lattice in scales, each axis by itself, and the share of every scale that is signal.
//!
//! A Laplacian pyramid (Burt and Adelson 1983) along x, then y, then azimuth: what a coarser lattice
//! cannot hold is a band, and the bands add up to the lattice. Means over x and y are weighted by
//! exposure. Bands are kept by the share of their power, around a place, that noise does not
//! explain; what comes out shows where signal is, and with that the shares are taken again
//! (empirical Wiener filtering in two steps, Ghael, Sayeed and Baraniuk 1997).

use super::field::{Field, Plane};

/// Shares of all bands, in the order in which they are met.
pub(super) struct Gains {
    planes: Vec<Vec<Plane>>,
    bands: Vec<Vec<f32>>,
}

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

    /// Shows all bands of a field in a fixed order and puts together what it is given for them.
    fn walk<const N: usize>(
        &self,
        planes: &[Vec<Plane>],
        field: Field<N>,
        band: &mut impl FnMut([usize; 3], Field<N>) -> Option<Field<N>>,
    ) -> Option<Field<N>> {
        self.scale(0, [0; 3], planes, field, band)
    }

    fn scale<const N: usize>(
        &self,
        axis: usize,
        steps: [usize; 3],
        planes: &[Vec<Plane>],
        mut field: Field<N>,
        band: &mut impl FnMut([usize; 3], Field<N>) -> Option<Field<N>>,
    ) -> Option<Field<N>> {
        if axis == 3 {
            return band(steps, field);
        }
        if steps[axis] == self.depth[axis] {
            return self.scale(axis + 1, steps, planes, field, band);
        }
        let mut next = steps;
        next[axis] += 1;
        let inside = [steps, next].map(|steps| &planes[steps[0]][steps[1]]);
        let coarse = if axis == 2 {
            let coarse = field.narrowed();
            field.add_narrow(-1.0, &coarse);
            coarse
        } else {
            let coarse = field.reduced(axis, Some(inside[0]));
            field.add_coarse(axis, -1.0, &coarse, Some(inside));
            coarse
        };
        let fine = self.scale(axis + 1, steps, planes, field, band);
        let coarse = self.scale(axis, next, planes, coarse, band);
        let (mut fine, coarse) = (fine?, coarse?);
        match axis {
            2 => fine.add_narrow(1.0, &coarse),
            _ => fine.add_coarse(axis, 1.0, &coarse, Some(inside)),
        }
        Some(fine)
    }

    /// Exposure at all steps along x and y.
    fn planes(&self, exposure: Plane) -> Vec<Vec<Plane>> {
        let mut planes = vec![vec![exposure]];
        for a in 1..=self.depth[0] {
            planes.push(vec![planes[a - 1][0].reduced(0)]);
        }
        for along_y in &mut planes {
            for c in 1..=self.depth[1] {
                along_y.push(along_y[c - 1].reduced(1));
            }
        }
        planes
    }

    /// The shares to keep of S.
    ///
    /// * `s`: photons over exposure; `squares`: variance of the photons.
    pub(super) fn gains(
        &self,
        s: &Field<1>,
        squares: Field<1>,
        exposure: Plane,
        caution: f32,
    ) -> Gains {
        let planes = self.planes(exposure);
        // All means of squares that bands are held against, azimuth running fastest.
        let mut noise = Vec::new();
        let mut along_x = squares;
        for a in 0..=self.depth[0] {
            let mut along_y = along_x.clone();
            for c in 0..=self.depth[1] {
                let mut around = along_y.clone();
                for b in 0..=self.depth[2] {
                    let next = (b < self.depth[2]).then(|| around.narrowed());
                    noise.push(std::mem::replace(
                        &mut around,
                        next.unwrap_or(Field::new([0; 3])),
                    ));
                }
                if c < self.depth[1] {
                    along_y = along_y.reduced(1, None);
                }
            }
            if a < self.depth[0] {
                along_x = along_x.reduced(0, None);
            }
        }
        let local = |steps: [usize; 3], field: &Field<1>, share: fn(f32, f32, f32) -> f32| {
            if steps == self.depth {
                return vec![1.0; field.values.len()];
            }
            let [a, c, b] = steps;
            let of = (a * (self.depth[1] + 1) + c) * (self.depth[2] + 1) + b;
            let norm: f32 = (0..3).map(|axis| self.norms[axis][steps[axis]]).product();
            around(field, &noise[of], &planes[a][c], norm, |all, noise| {
                share(all, noise, caution)
            })
        };
        let mut clean = self
            .walk(&planes, s.clone(), &mut |steps, mut field| {
                let gains = local(steps, &field, |all, noise, caution| {
                    super::share(all, noise, caution)
                });
                for (v, gain) in field.values.iter_mut().zip(gains) {
                    v[0] *= gain;
                }
                Some(field)
            })
            .unwrap_or_else(|| s.clone());
        clean.values.iter_mut().for_each(|v| v[0] = v[0].max(0.0));
        let mut bands = Vec::new();
        self.walk(&planes, clean, &mut |steps, field| {
            bands.push(local(steps, &field, |signal, noise, _| {
                if signal > 0.0 {
                    signal / (signal + noise)
                } else {
                    0.0
                }
            }));
            None
        });
        Gains { planes, bands }
    }

    /// S with only those shares of its bands.
    pub(super) fn apply<const N: usize>(&self, field: Field<N>, gains: &Gains) -> Field<N> {
        let mut bands = gains.bands.iter();
        let kept = self.walk(&gains.planes, field, &mut |_, mut field| {
            for (v, gain) in field.values.iter_mut().zip(bands.next()?) {
                *v = v.map(|v| v * gain);
            }
            Some(field)
        });
        kept.unwrap_or_else(|| Field::new(self.size))
    }
}

/// Shares of a band from its power and that of noise around every place, in common units.
fn around(
    field: &Field<1>,
    squares: &Field<1>,
    exposure: &Plane,
    norm: f32,
    share: impl Fn(f32, f32) -> f32,
) -> Vec<f32> {
    let np = field.size[2];
    let mut power: Field<2> = Field::new(field.size);
    for (row, to) in power.values.chunks_exact_mut(np).enumerate() {
        let scale = exposure.values[row].powi(2);
        if scale > 0.0 {
            let from = field.row(row).iter().zip(squares.row(row));
            for (to, (v, squares)) in to.iter_mut().zip(from) {
                *to = [scale * v[0] * v[0], norm * squares[0]];
            }
        }
    }
    let halved = [0, 1, 2].map(|axis| field.size[axis].is_multiple_of(2));
    for axis in [0, 1] {
        if halved[axis] {
            power = power.reduced(axis, None);
        }
    }
    if halved[2] {
        power = power.narrowed();
    }
    let mut gains: Field<1> = Field::new(power.size);
    for (gain, [all, noise]) in gains.values.iter_mut().zip(&power.values) {
        gain[0] = share(*all, *noise);
    }
    if halved[2] {
        let [nx, ny, np] = gains.size;
        let mut wide = Field::new([nx, ny, 2 * np]);
        wide.add_narrow(1.0, &gains);
        gains = wide;
    }
    for axis in [1, 0] {
        if halved[axis] {
            let mut size = gains.size;
            size[axis] *= 2;
            let mut wide = Field::new(size);
            wide.add_coarse(axis, 1.0, &gains, None);
            gains = wide;
        }
    }
    gains.values.into_iter().map(|[gain]| gain).collect()
}

/// Squared norms along one axis: what the bands hold, a cell, of noise of variance 1 a cell.
fn norms(cells: usize, depth: usize) -> Vec<f32> {
    let mut sums = vec![0.0; depth + 1];
    // Impulses at as many places as the coarsest step can tell apart, in the middle.
    let places = (1 << depth).min(cells);
    for place in 0..places {
        let mut field: Field<1> = Field::new([1, 1, cells]);
        field.values[(cells - places) / 2 + place] = [1.0];
        for (step, sum) in sums.iter_mut().enumerate() {
            let coarse = (step < depth).then(|| field.narrowed());
            if let Some(coarse) = &coarse {
                field.add_narrow(-1.0, coarse);
            }
            let power: f32 = field.values.iter().map(|v| v[0] * v[0]).sum();
            // One impulse in all cells of a band: so many cells of the lattice a cell of it.
            *sum += power * (1 << step) as f32 / places as f32;
            if let Some(coarse) = coarse {
                field = coarse;
            }
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
        let mut bands = 0;
        let same = pyramid.walk(&planes, s.clone(), &mut |_, band| {
            bands += 1;
            Some(band)
        });
        assert_eq!(bands, 3 * 3 * 4);
        for (a, b) in same.unwrap().values.iter().zip(&s.values) {
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
            let gains = pyramid.gains(s, squares.clone(), exposure.clone(), 0.5);
            pyramid.apply(s.clone(), &gains)
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
