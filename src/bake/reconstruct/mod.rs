//! Maps without most of their noise.
//!
//! A texel of an early bake holds a few photons, but scattering is smooth: narrow lobes stand on
//! wide ones. Every map is taken apart into bands of scales ([`scales`]); a band is kept, place by
//! place, by the share of its power that is signal (Wiener 1949; by neighborhoods of coefficients,
//! Cai and Silverman 2001). What is noise is known: photons are independent, so the variance of a
//! texel is its sum of squares, and a map of random signs of that variance, taken apart in the
//! same way, shows what noise alone has in every band. The error that is left is read off two
//! halves of the photons, each filtered and held against the other.
//!
//! Light that met no pigment, mostly the surface's reflection, and light that did are two maps: one
//! is narrow, the other wide. All absorption levels are filtered as the clear one. The sum of
//! every map is kept and nothing is negative. As photons come in, noise falls below every band and
//! the maps become the plain means.

mod scales;

use super::noise::{Noise, Norm};
use super::tally::Tally;
use crate::math::unicube::Unicube;
use crate::sampling::{Rng, hash64};
use crate::table::PHOTON;
use scales::Scales;

/// Noise counts this much more than it should: its power in a neighborhood is itself known from few
/// coefficients, and where they lie by chance below the mean, noise would pass for signal. At 0
/// maps of few photons are spotted; at 1 faint lobes come late.
const CAUTION: f32 = 0.5;

/// How much the squared error of a filtered map falls from half of the photons to all: by 2^0.95 in
/// bakes of human hair, where narrow lobes keep the filter narrow, and by 2^0.7 in bakes of a polar
/// bear's.
const HALVED: f64 = 1.8;

/// Which photons.
#[derive(Clone, Copy, Debug)]
enum Half {
    Both,
    First,
    Second,
}

/// The share of a texel's photons that fall to the first half if each is sent there by chance. A Poisson
/// count so thinned is two independent ones.
fn thinned(texel: usize, [sum, squares]: [f64; 2]) -> f64 {
    if squares <= 0.0 {
        return 0.5;
    }
    // As many equal photons have this sum and these squares.
    let count = (sum * sum / squares).round().max(1.0);
    let mut rng = Rng::new(0x7417, texel as u64 ^ hash64(sum.to_bits()));
    let first = if count <= 64.0 {
        let bits = u64::from(rng.bits()) << 32 | u64::from(rng.bits());
        f64::from((bits >> (64 - count as u32)).count_ones())
    } else {
        (0.5 * count + 0.5 * count.sqrt() * rng.normal_pair().0).clamp(0.0, count)
    };
    first / count
}

/// Filters maps of one size.
#[derive(Debug)]
pub(super) struct Reconstruction {
    scales: Scales,
    /// Solid angle of every cell's texel.
    solid_angle: Vec<f64>,
}

/// What is left of a node's noise.
pub(super) struct Maps {
    /// Flux fractions, level by level.
    pub(super) flux: Vec<f32>,
    /// Relative standard error of the clear level; infinite where nothing is.
    pub(super) error: Vec<f32>,
}

/// A map filtered: densities of the cells.
struct Filtered {
    mean: Vec<f32>,
    /// What the filter leaves of noise alone.
    noise: Vec<f32>,
    /// Shares kept, `[band][cell]`; of the last band everything.
    gains: Vec<Vec<f32>>,
}

impl Reconstruction {
    /// * `folded`: maps are averaged with their mirror images.
    pub(super) fn new(cube: &Unicube, folded: bool) -> Self {
        let scales = Scales::new(cube, folded);
        let cells = scales.texels.iter();
        let solid_angle = cells.map(|&[t, _]| cube.solid_angle(t)).collect();
        Self {
            scales,
            solid_angle,
        }
    }

    /// The maps of a node.
    pub(super) fn maps(&self, tally: &Tally) -> Maps {
        let texels = tally.texels();
        let levels = tally.levels();
        let mut flux = vec![0.0; levels * texels];
        let bare = self.filter(self.signal(tally, Tally::bare, Half::Both));
        let colored = self.filter(self.signal(tally, Tally::colored, Half::Both));
        for first in (0..levels).step_by(LANES) {
            self.levels(tally, first, &bare.mean, &colored, &mut flux);
        }
        Maps {
            error: self.errors(texels, &bare, &colored),
            flux,
        }
    }

    /// Error of a node's clear level, and its power.
    pub(super) fn noise(&self, tally: &Tally, norm: &Norm) -> Noise {
        let mut sum = Noise::default();
        let mut means = vec![0.0; self.scales.texels.len()];
        for kind in [Tally::bare, Tally::colored] {
            let halves = [Half::First, Half::Second].map(|half| {
                let signal = self.signal(tally, kind, half);
                (self.filter(signal.clone()).mean, signal)
            });
            for (cell, &[texel, mirror]) in self.scales.texels.iter().enumerate() {
                let copies = if texel == mirror { 1.0 } else { 2.0 };
                let weight = norm.weight(texel) * copies * self.solid_angle[cell].powi(2);
                for (one, other) in [(0, 1), (1, 0)] {
                    let mean = f64::from(halves[one].0[cell]);
                    // The other half has its own noise, of known variance.
                    let [raw, deviation] = halves[other].1[cell].map(f64::from);
                    let apart = (mean - raw).powi(2) - deviation * deviation;
                    sum.noise += 0.5 * weight * apart / HALVED;
                    means[cell] += 0.5 * mean * weight.sqrt();
                }
            }
        }
        sum.noise = sum.noise.max(0.0);
        sum.power = means.iter().map(|mean| mean * mean).sum();
        sum
    }

    /// Densities of the cells, and a random sign times their standard deviation.
    fn signal(
        &self,
        tally: &Tally,
        kind: impl Fn(&Tally, usize) -> (u64, u64),
        half: Half,
    ) -> Vec<[f32; 2]> {
        let photons = tally.photons() as f64;
        let parts = |(sum, squares): (u64, u64)| [sum, squares].map(|v| v as f64 / PHOTON as f64);
        let cells = self.scales.texels.iter().zip(&self.solid_angle);
        cells
            .map(|(&[texel, mirror], omega)| {
                let [a, b] = [texel, mirror].map(|texel| parts(kind(tally, texel)));
                // Sums, and how many times the density of one photon they stand for.
                let ([sum, squares], copies) = match half {
                    Half::Both if texel == mirror => (a, 1.0),
                    Half::Both => ([a[0] + b[0], a[1] + b[1]], 2.0),
                    // The sides of the mirror plane are independent.
                    Half::First if texel != mirror => (a, 1.0),
                    Half::Second if texel != mirror => (b, 1.0),
                    Half::First => (a.map(|v| v * thinned(texel, a)), 0.5),
                    Half::Second => (a.map(|v| v * (1.0 - thinned(texel, a))), 0.5),
                };
                let scale = 1.0 / (copies * photons * omega);
                let bits = hash64(texel as u64 ^ hash64(sum.to_bits()));
                let sign = if bits & 1 == 0 { -1.0 } else { 1.0 };
                [(sum * scale) as f32, (sign * squares.sqrt() * scale) as f32]
            })
            .collect()
    }

    fn filter(&self, signal: Vec<[f32; 2]>) -> Filtered {
        let cells = signal.len();
        let mut filtered = Filtered {
            mean: vec![0.0; cells],
            noise: vec![0.0; cells],
            gains: Vec::with_capacity(self.scales.bands()),
        };
        self.scales.take_apart(signal, |band, part| {
            let gains: Vec<f32> = if band + 1 == self.scales.bands() {
                vec![1.0; cells]
            } else {
                let power = part.iter().map(|v| v.map(|v| v * v)).collect();
                let around = self.scales.around(band, power);
                around
                    .iter()
                    .map(|&[all, noise]| share(all, noise))
                    .collect()
            };
            for (cell, (gain, [value, noise])) in gains.iter().zip(part).enumerate() {
                filtered.mean[cell] += gain * value;
                filtered.noise[cell] += gain * noise;
            }
            filtered.gains.push(gains);
        });
        filtered
    }

    /// Filters some levels as the clear one was and writes them to `flux`.
    fn levels(
        &self,
        tally: &Tally,
        first: usize,
        bare: &[f32],
        colored: &Filtered,
        flux: &mut [f32],
    ) {
        let texels = tally.texels();
        let unit = 1.0 / (tally.photons() as f64 * PHOTON as f64);
        let levels = first..(first + LANES).min(tally.levels());
        let cells = self.scales.texels.iter().zip(&self.solid_angle);
        let maps: Vec<[f32; LANES]> = cells
            .map(|(&[texel, mirror], omega)| {
                let mut sums = [0.0; LANES];
                let (a, b) = (tally.run(texel), tally.run(mirror));
                for (sum, level) in sums.iter_mut().zip(levels.clone()) {
                    *sum = (0.5 * (a[level] as f64 + b[level] as f64) * unit / omega) as f32;
                }
                sums
            })
            .collect();
        let mut out = vec![[0.0f32; LANES]; maps.len()];
        self.scales.take_apart(maps, |band, part| {
            for ((out, gain), part) in out.iter_mut().zip(&colored.gains[band]).zip(part) {
                for (out, v) in out.iter_mut().zip(part) {
                    *out += gain * v;
                }
            }
        });
        for level in levels {
            let escaped = tally.escaped(level) as f64 * unit;
            let value = |cell: usize| {
                let density = bare[cell].max(0.0) + out[cell][level - first].max(0.0);
                f64::from(density) * self.solid_angle[cell]
            };
            let copies = |[texel, mirror]: [usize; 2]| if texel == mirror { 1.0 } else { 2.0 };
            let cells = self.scales.texels.iter().enumerate();
            let sum: f64 = cells.clone().map(|(i, &t)| copies(t) * value(i)).sum();
            let scale = if sum > 0.0 { escaped / sum } else { 0.0 };
            let map = &mut flux[level * texels..(level + 1) * texels];
            for (cell, &[texel, mirror]) in cells {
                let value = (scale * value(cell)) as f32;
                (map[texel], map[mirror]) = (value, value);
            }
        }
    }

    /// Relative standard errors per texel.
    fn errors(&self, texels: usize, bare: &Filtered, colored: &Filtered) -> Vec<f32> {
        let power = |filtered: &Filtered| {
            let squares = filtered.noise.iter().map(|v| [v * v]).collect();
            self.scales.around(0, squares)
        };
        let (a, b) = (power(bare), power(colored));
        let mut error = vec![f32::INFINITY; texels];
        for (cell, &[texel, mirror]) in self.scales.texels.iter().enumerate() {
            let mean = bare.mean[cell].max(0.0) + colored.mean[cell].max(0.0);
            if mean > 0.0 {
                let value = (a[cell][0] + b[cell][0]).sqrt() / mean;
                (error[texel], error[mirror]) = (value, value);
            }
        }
        error
    }
}

/// Levels that are filtered side by side: as many as a SIMD register of plain x86-64 holds.
const LANES: usize = 4;

/// The share of a band's power that is signal.
fn share(all: f32, noise: f32) -> f32 {
    if all > 0.0 {
        (1.0 - (1.0 + CAUTION) * noise / all).max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
