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

mod around;
mod azimuth;
mod desk;
mod field;
mod guess;
mod halves;
mod lattice;
mod pyramid;
mod scales;
mod signal;

use super::tally::Tally;
use crate::math::unicube::Unicube;
use crate::table::{Mode, Nodes, PHOTON};
use desk::{Desk, Desks, PAIR, SIDE};
use lattice::Lattice;
use pyramid::Pyramid;
use rayon::prelude::*;
use scales::Scales;
use signal::Half;
use std::time::{Duration, Instant};

/// Noise counts this much more than it should: its power in a neighborhood is itself known from few
/// coefficients, and where they lie by chance below the mean, noise would pass for signal. At 0
/// maps of few photons are spotted; at 1 faint lobes come late.
const CAUTION: f32 = 0.5;

/// Likewise where a map is held against a guess: nearly all that is left is noise. At 1 a red fox has 1.25 times the
/// error with 6e4 photons, at 2.5 human hair loses detail of its own.
const CAUTION_AFTER_GUESS: f32 = 2.0;

/// Scales of a map that is held against a guess: 11 degrees, wider ones are in the guess.
const SCALES_AFTER_GUESS: usize = 3;

/// What making a filter takes over the quicker of its two halves, for scales and for the lattice, which are alike to a twentieth. Much
/// more, and one run in six, in which the system holds up one of them, ends a fifth too early; less than 2.05, and tables come late.
const HALF: f64 = 2.1;

/// Filters maps of one size.
#[derive(Debug)]
pub(super) struct Reconstruction {
    scales: Scales,
    /// Solid angle of every cell's texel.
    solid_angle: Vec<f64>,
    /// Where nodes meet; in paper mode and with several azimuths they do not.
    joint: Option<(Lattice, Pyramid)>,
    /// See [`Reconstruction::took`].
    took: Duration,
}

/// Four numbers a cell: light that met no pigment, its deviation, light that met pigment, its deviation; or
/// four levels of the latter.
type Map = Vec<[f32; SIDE]>;

impl Reconstruction {
    /// * `folded`: maps are averaged with their mirror images.
    pub(super) fn new(cube: &Unicube, nodes: &Nodes, folded: bool) -> Self {
        // With several azimuths reciprocity is between maps of different ones.
        let joint = nodes.mode == Mode::Cone && nodes.azimuths.count == 1;
        let start = Instant::now();
        let scales = Scales::new(
            cube,
            folded,
            if joint {
                SCALES_AFTER_GUESS
            } else {
                usize::MAX
            },
        );
        let mut took = start.elapsed();
        let cells = scales.texels.iter();
        let solid_angle = cells.map(|&[t, _]| cube.solid_angle(t)).collect();
        let joint = joint.then(|| {
            let lattice = Lattice::new(cube, nodes, &scales.texels, folded);
            let pyramid = Pyramid::new(lattice.size());
            let other = start.elapsed() - took;
            took = (took + other).min(took.min(other).mul_f64(HALF));
            (lattice, pyramid)
        });
        Self {
            scales,
            solid_angle,
            joint,
            took,
        }
    }

    /// How long it takes to make it on the threads that made it, without what has held up one half of that.
    pub(super) fn took(&self) -> Duration {
        self.took
    }

    /// Makes the maps of all nodes.
    ///
    /// * `flux`: gets flux fractions, node by node and level by level.
    /// * `error`: gets the relative standard error of the clear level, node by node; infinite where nothing is.
    pub(super) fn maps(&self, tallies: &[Tally], flux: &mut [f32], error: &mut [f32]) {
        let Some(first) = tallies.first() else {
            return;
        };
        let (levels, texels) = (first.levels(), first.texels());
        let signals: Vec<Map> = tallies
            .par_iter()
            .with_max_len(1)
            .map(|tally| self.signals(tally, Half::Both))
            .collect();
        // [node][group of levels][cell]
        let densities: Vec<Vec<Map>> = tallies
            .par_iter()
            .with_max_len(1)
            .map(|tally| self.densities(tally))
            .collect();
        let guess = self.guess(tallies, &signals, &densities);
        let desks = Desks::default();
        let maps = flux.par_chunks_mut(PAIR * levels * texels);
        let maps = maps.zip(error.par_chunks_mut(PAIR * texels)).enumerate();
        maps.with_max_len(1).for_each(|(pair, (flux, error))| {
            let nodes = pair * PAIR..(pair * PAIR + PAIR).min(tallies.len());
            let mut desk = desks.take();
            self.expect(&mut desk, nodes.clone(), &guess);
            desk.load(0, &signals[nodes.clone()]);
            self.filter(&mut desk);
            for (side, error) in error.chunks_exact_mut(texels).enumerate() {
                self.errors(&mut desk, side, error);
            }
            let escaped = tallies[nodes.clone()].iter().map(|tally| {
                let unit = 1.0 / (tally.photons() as f64 * PHOTON as f64);
                let escaped = tally.escaped().into_iter();
                escaped.map(|sum| sum as f64 * unit).collect::<Vec<_>>()
            });
            let escaped: Vec<_> = escaped.collect();
            for group in 0..levels.div_ceil(SIDE) {
                let densities = densities[nodes.clone()].iter().map(|node| &node[group]);
                desk.load(1 + group, densities);
                self.filter_levels(&mut desk);
                for (side, escaped) in escaped.iter().enumerate() {
                    for level in group * SIDE..(group * SIDE + SIDE).min(levels) {
                        let flux = &mut flux[(side * levels + level) * texels..][..texels];
                        self.map(&desk, side, level, escaped[level], flux);
                    }
                }
            }
            desks.give(desk);
        });
    }

    /// Filters what is on a desk: takes apart what photons say against the guess and keeps what is not noise,
    /// in all lanes.
    fn filter(&self, desk: &mut Desk) {
        let (caution, whole) = match self.joint {
            Some(_) => (CAUTION_AFTER_GUESS, self.scales.bands()),
            // The mean over everything is not noise.
            None => (CAUTION, self.scales.bands() - 1),
        };
        desk.filter(&self.scales, caution, whole);
    }

    /// Filters levels as the clear one was.
    fn filter_levels(&self, desk: &mut Desk) {
        desk.filter_levels(&self.scales);
    }

    /// Flux fractions of a level.
    ///
    /// * `escaped`: their sum.
    fn map(&self, desk: &Desk, side: usize, level: usize, escaped: f64, map: &mut [f32]) {
        let lanes = [side * SIDE, side * SIDE + level % SIDE];
        let cells = desk.kinds.iter().zip(&desk.levels).zip(&self.solid_angle);
        let values = cells.map(|((kinds, levels), omega)| {
            let density = kinds[lanes[0]].max(0.0) + levels[lanes[1]].max(0.0);
            f64::from(density) * omega
        });
        let copies = |[texel, mirror]: [usize; 2]| if texel == mirror { 1.0 } else { 2.0 };
        let texels = &self.scales.texels;
        let sum: f64 = values
            .clone()
            .zip(texels)
            .map(|(v, &t)| copies(t) * v)
            .sum();
        let scale = if sum > 0.0 { escaped / sum } else { 0.0 };
        for (value, &[texel, mirror]) in values.zip(texels) {
            let value = (scale * value) as f32;
            (map[texel], map[mirror]) = (value, value);
        }
    }

    /// Relative standard errors per texel of one side of a desk.
    fn errors(&self, desk: &mut Desk, side: usize, error: &mut [f32]) {
        let Desk {
            kinds,
            squares: [squares, other],
            ..
        } = desk;
        let noise = [side * SIDE + 1, side * SIDE + 3];
        squares.clear();
        squares.extend(kinds.iter().map(|v| noise.map(|lane| v[lane] * v[lane])));
        self.scales.around(0, squares, other);
        let cells = kinds.iter().zip(&*squares).zip(&self.scales.texels);
        for ((v, [a, b]), &[texel, mirror]) in cells {
            let mean = v[side * SIDE].max(0.0) + v[side * SIDE + 2].max(0.0);
            let value = match mean > 0.0 {
                true => (a + b).sqrt() / mean,
                false => f32::INFINITY,
            };
            (error[texel], error[mirror]) = (value, value);
        }
    }
}

/// The share of a band's power that is signal.
#[inline(always)]
fn share(all: f32, noise: f32, caution: f32) -> f32 {
    let signal = all - (1.0 + caution) * noise;
    if signal > 0.0 { signal / all } else { 0.0 }
}

#[cfg(test)]
mod tests;
