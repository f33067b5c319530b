//! Maps without most of their noise.
//!
//! A texel of an early bake holds a few photons, but scattering is smooth: narrow lobes stand on
//! wide ones. What noise explains is taken out by scales, place by place (Wiener 1949; by neighborhoods of
//! coefficients, Cai and Silverman 2001), in two rounds. The first sees all nodes at once, on a
//! [`lattice`] where they help each other and where reciprocity counts every photon twice; a
//! [`pyramid`] takes it apart. It is a first guess. What the photons of a node say against the guess is
//! then taken apart in the node's own map ([`scales`]) and added as far as it is not noise.
//!
//! What is noise is known: photons are independent, so the variance of a texel is its sum of
//! squares, and a map of random signs of that variance, taken apart in the same way, shows what
//! noise alone has in every band. The error that is left is read off two halves of the photons, each
//! filtered and held against the other.
//!
//! Light that met no pigment, mostly the surface's reflection, and light that did are two maps: one
//! is narrow, the other wide. All absorption levels are filtered as the clear one. The sum of
//! every map is kept and nothing is negative. As photons come in, noise falls below every band and
//! the maps become the plain means.

mod field;
mod halves;
mod lattice;
mod pyramid;
mod scales;
mod signal;

use super::tally::Tally;
use crate::math::unicube::Unicube;
use crate::table::{Mode, Nodes, PHOTON};
use field::Field;
use lattice::Lattice;
use pyramid::{Gains, Pyramid};
use rayon::prelude::*;
use scales::Scales;
use signal::{Half, Kind};

/// Noise counts this much more than it should: its power in a neighborhood is itself known from few
/// coefficients, and where they lie by chance below the mean, noise would pass for signal. At 0
/// maps of few photons are spotted; at 1 faint lobes come late.
const CAUTION: f32 = 0.5;

/// Likewise where a map is held against a guess: nearly all that is left is noise.
const CAUTION_AFTER_GUESS: f32 = 1.0;

/// Scales of a map that is held against a guess: 11 degrees, wider ones are in the guess.
const SCALES_AFTER_GUESS: usize = 3;

/// Filters maps of one size.
#[derive(Debug)]
pub(super) struct Reconstruction {
    scales: Scales,
    /// Solid angle of every cell's texel.
    solid_angle: Vec<f64>,
    /// Where nodes meet; in paper mode and with several azimuths they do not.
    joint: Option<(Lattice, Pyramid)>,
}

/// What is left of a node's noise.
pub(super) struct Maps {
    /// Flux fractions, level by level.
    pub(super) flux: Vec<f32>,
    /// Relative standard error of the clear level; infinite where nothing is.
    pub(super) error: Vec<f32>,
}

/// A map filtered: densities of the cells.
#[derive(Default)]
struct Filtered {
    mean: Vec<f32>,
    /// What the filter leaves of noise alone.
    noise: Vec<f32>,
    /// Shares kept of what the guess does not say, `[band][cell]`; of the last band everything.
    gains: Vec<Vec<f32>>,
}

/// All maps of one kind, filtered.
struct All {
    nodes: Vec<Filtered>,
    /// Shares kept on the lattice.
    gains: Option<Gains>,
}

impl Reconstruction {
    /// * `folded`: maps are averaged with their mirror images.
    pub(super) fn new(cube: &Unicube, nodes: &Nodes, folded: bool) -> Self {
        // With several azimuths reciprocity is between maps of different ones.
        let joint = nodes.mode == Mode::Cone && nodes.azimuths.count == 1;
        let scales = Scales::new(
            cube,
            folded,
            if joint {
                SCALES_AFTER_GUESS
            } else {
                usize::MAX
            },
        );
        let cells = scales.texels.iter();
        let solid_angle = cells.map(|&[t, _]| cube.solid_angle(t)).collect();
        let joint = joint.then(|| {
            let lattice = Lattice::new(cube, nodes, &scales.texels, folded);
            let pyramid = Pyramid::new(lattice.size());
            (lattice, pyramid)
        });
        Self {
            scales,
            solid_angle,
            joint,
        }
    }

    /// The maps of all nodes.
    pub(super) fn maps(&self, tallies: &[Tally]) -> Vec<Maps> {
        let every = vec![true; tallies.len()];
        let (bare, colored) = rayon::join(
            || self.filter_all(tallies, Tally::bare, Half::Both, &every),
            || self.filter_all(tallies, Tally::colored, Half::Both, &every),
        );
        let levels = tallies.first().map_or(0, Tally::levels);
        // Densities of the light that met pigment, [group of levels][node][cell].
        let groups: Vec<Vec<Vec<[f32; LANES]>>> = (0..levels.div_ceil(LANES))
            .into_par_iter()
            .map(|group| self.levels(tallies, group * LANES, &colored))
            .collect();
        let nodes = tallies.par_iter().enumerate();
        nodes
            .map(|(node, tally)| {
                let (bare, clear) = (&bare.nodes[node], &colored.nodes[node]);
                let mut flux = Vec::with_capacity(levels * tally.texels());
                for level in 0..levels {
                    let colored = &groups[level / LANES][node];
                    flux.extend(self.map(tally, level, &bare.mean, colored));
                }
                Maps {
                    error: self.errors(tally.texels(), bare, clear),
                    flux,
                }
            })
            .collect()
    }

    /// Maps of one kind of light, guessed from all nodes and put right by their own photons.
    ///
    /// * `wanted`: nodes whose maps are made; the others stay empty.
    fn filter_all(&self, tallies: &[Tally], kind: Kind, half: Half, wanted: &[bool]) -> All {
        let signals: Vec<_> = tallies
            .par_iter()
            .map(|tally| self.signal(tally, kind, half))
            .collect();
        let Some((lattice, pyramid)) = &self.joint else {
            let nodes = signals.into_par_iter();
            return All {
                nodes: nodes.map(|signal| self.filter(signal, CAUTION)).collect(),
                gains: None,
            };
        };
        let photons: Vec<f64> = tallies.iter().map(|tally| tally.photons() as f64).collect();
        let mut sums: Field<2> = Field::new(lattice.size());
        let mut squares: Field<1> = Field::new(lattice.size());
        for (node, (signal, photons)) in signals.iter().zip(&photons).enumerate() {
            let counts = || {
                let cells = signal.iter().zip(&self.solid_angle);
                cells.map(|(v, omega)| v.map(|v| v * (omega * photons) as f32))
            };
            lattice.gather(node, counts(), &mut sums);
            lattice.gather(node, counts().map(|[_, dev]| [dev * dev]), &mut squares);
        }
        let exposure = lattice.exposure(&photons);
        sums.divide(&exposure);
        let s = Field {
            size: sums.size,
            values: sums.values.iter().map(|[v, _]| [*v]).collect(),
        };
        let gains = pyramid.gains(&s, squares, exposure, CAUTION);
        let guess = pyramid.apply(sums, &gains);
        let nodes = signals.into_par_iter().enumerate();
        let nodes = nodes.map(|(node, mut signal)| {
            if !wanted[node] {
                return Filtered::default();
            }
            let guess = lattice.project(node, &guess);
            for (v, guess) in signal.iter_mut().zip(&guess) {
                *v = [v[0] - guess[0], v[1] - guess[1]];
            }
            let mut filtered = self.filter(signal, CAUTION_AFTER_GUESS);
            for (cell, guess) in guess.iter().enumerate() {
                filtered.mean[cell] += guess[0];
                filtered.noise[cell] += guess[1];
            }
            filtered
        });
        All {
            nodes: nodes.collect(),
            gains: Some(gains),
        }
    }

    fn filter(&self, signal: Vec<[f32; 2]>, caution: f32) -> Filtered {
        let cells = signal.len();
        let mut filtered = Filtered {
            mean: vec![0.0; cells],
            noise: vec![0.0; cells],
            gains: Vec::with_capacity(self.scales.bands()),
        };
        self.scales.take_apart(signal, |band, part| {
            let gains: Vec<f32> = if self.joint.is_none() && band + 1 == self.scales.bands() {
                vec![1.0; cells]
            } else {
                let power = part.iter().map(|v| v.map(|v| v * v)).collect();
                let around = self.scales.around(band, power);
                around
                    .iter()
                    .map(|&[all, noise]| share(all, noise, caution))
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

    /// Some levels, filtered as the clear one was: densities `[node][cell]`.
    fn levels(&self, tallies: &[Tally], first: usize, clear: &All) -> Vec<Vec<[f32; LANES]>> {
        let maps: Vec<_> = tallies
            .par_iter()
            .map(|tally| self.densities(tally, first))
            .collect();
        let guess = self.joint.as_ref().zip(clear.gains.as_ref());
        let guess = guess.map(|((lattice, pyramid), gains)| {
            let photons: Vec<f64> = tallies.iter().map(|tally| tally.photons() as f64).collect();
            let mut sums = Field::new(lattice.size());
            for (node, (map, photons)) in maps.iter().zip(&photons).enumerate() {
                let cells = map.iter().zip(&self.solid_angle);
                let counts = cells.map(|(v, omega)| v.map(|v| v * (omega * photons) as f32));
                lattice.gather(node, counts, &mut sums);
            }
            sums.divide(&lattice.exposure(&photons));
            (lattice, pyramid.apply(sums, gains))
        });
        let nodes = maps.into_par_iter().zip(&clear.nodes).enumerate();
        let filtered = nodes.map(|(node, (mut map, clear))| {
            let mut out = match &guess {
                Some((lattice, guess)) => lattice.project(node, guess),
                None => vec![[0.0; LANES]; map.len()],
            };
            for (v, guess) in map.iter_mut().zip(&out) {
                for (v, guess) in v.iter_mut().zip(guess) {
                    *v -= guess;
                }
            }
            self.scales.take_apart(map, |band, part| {
                for ((out, gain), part) in out.iter_mut().zip(&clear.gains[band]).zip(part) {
                    for (out, v) in out.iter_mut().zip(part) {
                        *out += gain * v;
                    }
                }
            });
            out
        });
        filtered.collect()
    }

    /// Densities of the light that met pigment, at some levels.
    fn densities(&self, tally: &Tally, first: usize) -> Vec<[f32; LANES]> {
        let unit = 1.0 / (tally.photons() as f64 * PHOTON as f64);
        let levels = first..(first + LANES).min(tally.levels());
        let cells = self.scales.texels.iter().zip(&self.solid_angle);
        cells
            .map(|(&[texel, mirror], omega)| {
                let mut sums = [0.0; LANES];
                let (a, b) = (tally.run(texel), tally.run(mirror));
                for (sum, level) in sums.iter_mut().zip(levels.clone()) {
                    *sum = (0.5 * (a[level] as f64 + b[level] as f64) * unit / omega) as f32;
                }
                sums
            })
            .collect()
    }

    /// Flux fractions of a level, of the sum that was counted.
    fn map(&self, tally: &Tally, level: usize, bare: &[f32], colored: &[[f32; LANES]]) -> Vec<f32> {
        let unit = 1.0 / (tally.photons() as f64 * PHOTON as f64);
        let escaped = tally.escaped(level) as f64 * unit;
        let value = |cell: usize| {
            let density = bare[cell].max(0.0) + colored[cell][level % LANES].max(0.0);
            f64::from(density) * self.solid_angle[cell]
        };
        let copies = |[texel, mirror]: [usize; 2]| if texel == mirror { 1.0 } else { 2.0 };
        let cells = self.scales.texels.iter().enumerate();
        let sum: f64 = cells.clone().map(|(i, &t)| copies(t) * value(i)).sum();
        let scale = if sum > 0.0 { escaped / sum } else { 0.0 };
        let mut map = vec![0.0; tally.texels()];
        for (cell, &[texel, mirror]) in cells {
            let value = (scale * value(cell)) as f32;
            (map[texel], map[mirror]) = (value, value);
        }
        map
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
fn share(all: f32, noise: f32, caution: f32) -> f32 {
    let signal = all - (1.0 + caution) * noise;
    if signal > 0.0 { signal / all } else { 0.0 }
}
#[cfg(test)]
mod tests;
