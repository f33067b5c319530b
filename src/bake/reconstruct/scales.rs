//! Maps in scales: what changes from texel to texel, over two texels, over four, ..., along
//! inclination and along azimuth.
//!
//! Scattering lobes are arcs around the fiber, narrow in inclination and wide in azimuth, so the two
//! are taken apart: every band is a pair of scales, and a map is the sum of its bands. The
//! smoothing is the cubic B-spline "a trous" (Starck, Murtagh and Fadili 2010), which has no grid
//! of its own to shift or to resample to: its taps are the texels at given angles.

use crate::math::unicube::Unicube;
use crate::math::{frame, widest};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// The cubic B-spline at -2, -1, 0, 1, 2.
const CENTER: f32 = 6.0 / 16.0;
const TAPS: [f32; 4] = [1.0 / 16.0, 4.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
const OFFSETS: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// For every cell, the cells at the offsets.
type Taps = Vec<[u32; 4]>;

/// The cells of a map, texels or pairs of mirrored texels, and who is whose neighbor.
#[derive(Debug)]
pub(super) struct Scales {
    /// The texel of every cell, and its mirror image (itself if not folded).
    pub(super) texels: Vec<[usize; 2]>,
    /// Smoothings along inclination, each twice as wide as the one before.
    theta: Vec<Taps>,
    /// Along azimuth.
    phi: Vec<Taps>,
}

impl Scales {
    /// * `folded`: maps are even in azimuth and only one half is kept.
    /// * `most`: scales along each axis at most.
    pub(super) fn new(cube: &Unicube, folded: bool, most: usize) -> Self {
        let mut cells = vec![0u32; cube.texels()];
        let mut texels = Vec::new();
        for texel in 0..cube.texels() {
            let mirror = cube.mirrored(texel);
            if !folded || texel < mirror {
                cells[texel] = texels.len() as u32;
                texels.push([texel, if folded { mirror } else { texel }]);
            } else {
                cells[texel] = cells[mirror];
            }
        }
        // The widest taps reach 22 degrees in inclination and 45 in azimuth: beyond, maps have no
        // structure that noise could hide.
        let depth = cube.res().trailing_zeros() as usize;
        let step = FRAC_PI_2 / cube.res() as f64;
        // Inclination and azimuth of every cell, with their sines and cosines.
        let at = |&[texel, _]: &[usize; 2]| {
            let (w, _) = cube.direction(texel, 0.5, 0.5);
            let (theta, phi) = (frame::theta_of(w), w.y.atan2(w.x));
            (theta, phi, theta.sin_cos(), phi.sin_cos())
        };
        let places: Vec<_> = texels.par_iter().with_min_len(256).map(at).collect();
        let taps = |scale: usize, along_theta: bool| -> Taps {
            let places = places.par_iter().with_min_len(256);
            let taps = places.map(|&(theta, phi, at_theta, at_phi)| {
                OFFSETS.map(|offset| {
                    let angle = offset * step * f64::from(1u32 << scale);
                    let ((sin_t, cos_t), (sin_p, cos_p)) = match along_theta {
                        true => ((theta + angle).sin_cos(), at_phi),
                        false => (at_theta, (phi + angle).sin_cos()),
                    };
                    let to = DVec3::new(cos_t * cos_p, cos_t * sin_p, sin_t);
                    cells[cube.texel(to)]
                })
            });
            taps.collect()
        };
        Self {
            theta: (0..depth.saturating_sub(2).min(most))
                .map(|s| taps(s, true))
                .collect(),
            phi: (0..depth.saturating_sub(1).min(most))
                .map(|s| taps(s, false))
                .collect(),
            texels,
        }
    }

    /// Number of bands, the mean over everything included, which comes last.
    pub(super) fn bands(&self) -> usize {
        (self.theta.len() + 1) * (self.phi.len() + 1)
    }

    /// Takes maps apart and shows every band. Their sum is the maps.
    ///
    /// * `maps`: `N` densities a cell in the first of the buffers, whose contents are lost.
    /// * `see`: gets the number of the band and its part of the maps.
    pub(super) fn take_apart<const N: usize>(
        &self,
        [rest, smooth, row, wide]: &mut [Vec<[f32; N]>; 4],
        mut see: impl FnMut(usize, &[[f32; N]]),
    ) {
        let cells = rest.len();
        for buffer in [&mut *smooth, row, wide] {
            buffer.resize(cells, [0.0; N]);
        }
        let mut band = 0;
        for theta in 0..=self.theta.len() {
            // What this scale of inclination holds, then along azimuth.
            if let Some(taps) = self.theta.get(theta) {
                blur_and_take(taps, rest, smooth, row);
                std::mem::swap(rest, smooth);
            } else {
                row.copy_from_slice(rest);
            }
            for taps in &self.phi {
                // `smooth` is free until the next scale of inclination.
                blur_and_take(taps, row, wide, smooth);
                see(band, smooth);
                band += 1;
                std::mem::swap(row, wide);
            }
            see(band, row);
            band += 1;
        }
    }

    /// Means over the surroundings that a band's coefficients have in common.
    ///
    /// * `maps`, `other`: the maps, which end where they began, and as much memory.
    pub(super) fn around<const N: usize>(
        &self,
        band: usize,
        maps: &mut Vec<[f32; N]>,
        other: &mut Vec<[f32; N]>,
    ) {
        other.resize(maps.len(), [0.0; N]);
        let (theta, phi) = (band / (self.phi.len() + 1), band % (self.phi.len() + 1));
        // Twice as wide as the taps that made the band.
        let wider = |all: &[Taps], scale: usize| (scale + 1).min(all.len().saturating_sub(1));
        for (all, scale) in [
            (&self.theta, theta),
            (&self.phi, phi),
            (&self.theta, theta + 1),
            (&self.phi, phi + 1),
        ] {
            if let Some(taps) = all.get(wider(all, scale)) {
                blur(taps, maps, other);
                std::mem::swap(maps, other);
            }
        }
    }
}

fn blur<const N: usize>(taps: &Taps, from: &[[f32; N]], to: &mut [[f32; N]]) {
    widest(
        #[inline(always)]
        || {
            for ((to, here), taps) in to.iter_mut().zip(from).zip(taps) {
                *to = blurred(here, taps, from);
            }
        },
    );
}

/// Blurs, and what that takes away.
fn blur_and_take<const N: usize>(
    taps: &Taps,
    from: &[[f32; N]],
    smooth: &mut [[f32; N]],
    rest: &mut [[f32; N]],
) {
    widest(
        #[inline(always)]
        || {
            let cells = smooth.iter_mut().zip(rest).zip(from).zip(taps);
            for (((smooth, rest), here), taps) in cells {
                let sum = blurred(here, taps, from);
                for ((rest, here), sum) in rest.iter_mut().zip(here).zip(sum) {
                    *rest = here - sum;
                }
                *smooth = sum;
            }
        },
    );
}

#[inline(always)]
fn blurred<const N: usize>(here: &[f32; N], taps: &[u32; 4], from: &[[f32; N]]) -> [f32; N] {
    let mut sum = here.map(|v| CENTER * v);
    for (&cell, weight) in taps.iter().zip(TAPS) {
        for (sum, v) in sum.iter_mut().zip(from[cell as usize]) {
            *sum += weight * v;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn bands_sum_to_the_map_and_a_constant_has_only_the_last() {
        let cube = Unicube::new(16);
        for folded in [false, true] {
            let scales = Scales::new(&cube, folded, usize::MAX);
            let mut rng = Rng::new(1, 2);
            let map: Vec<[f32; 2]> = scales
                .texels
                .iter()
                .map(|_| [rng.uniform_f32(), 3.0])
                .collect();
            let mut sum = vec![0.0; map.len()];
            let mut bands = 0;
            let mut buffers = [map.clone(), Vec::new(), Vec::new(), Vec::new()];
            scales.take_apart(&mut buffers, |band, part| {
                assert_eq!(band, bands);
                bands += 1;
                for (sum, part) in sum.iter_mut().zip(part) {
                    *sum += part[0];
                    let expected = if bands == scales.bands() { 3.0 } else { 0.0 };
                    assert!((part[1] - expected).abs() < 1e-5);
                }
            });
            assert_eq!(bands, scales.bands());
            for (sum, v) in sum.iter().zip(&map) {
                assert!((sum - v[0]).abs() < 1e-5);
            }
        }
    }
}
