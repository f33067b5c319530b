//! Maps of two nodes, side by side, and the memory to filter them in.
//!
//! Taps are the same for all maps, so what is read through them is wide: eight numbers a cell.

use super::scales::Scales;
use super::{Map, share};
use crate::math::widest;
use std::sync::{Mutex, PoisonError};

/// Nodes that are filtered side by side.
pub(super) const PAIR: usize = 2;
/// Numbers a cell of one node.
pub(super) const SIDE: usize = 4;
/// Numbers a cell.
pub(super) const LANES: usize = PAIR * SIDE;

/// Numbers of every cell.
pub(super) type Lanes = Vec<[f32; LANES]>;

/// A place to filter at.
#[derive(Default)]
pub(super) struct Desk {
    /// What is expected: of the kinds of light, then of every group of levels. Empty without a guess.
    pub(super) guess: Vec<Lanes>,
    /// What is read off lattices.
    pub(super) seen: Vec<[f32; super::lattice::STRIP]>,
    /// The maps less the guess come first; the others are memory to take them apart.
    parts: [Lanes; 4],
    /// Which guess `parts` is held against.
    at: usize,
    power: [Lanes; 2],
    /// Shares kept of every band, `[band][cell]`: one for each two lanes.
    gains: Vec<Vec<[f32; LANES / 2]>>,
    /// Densities filtered: of the two kinds of light, and what the filter leaves of noise alone.
    pub(super) kinds: Lanes,
    /// Of some levels.
    pub(super) levels: Lanes,
    pub(super) squares: [Vec<[f32; 2]>; 2],
}

impl Desk {
    /// Puts maps here, less what is expected.
    ///
    /// * `at`: which guess.
    /// * `sides`: one or two maps.
    pub(super) fn load<'a>(&mut self, at: usize, sides: impl IntoIterator<Item = &'a Map>) {
        let to = &mut self.parts[0];
        let mut sides = sides.into_iter();
        let (first, second) = (sides.next(), sides.next());
        let cells = first.map_or(0, Vec::len);
        to.clear();
        to.resize(cells, [0.0; LANES]);
        for (map, lane) in first.into_iter().chain(second).zip([0, SIDE]) {
            for (to, from) in to.iter_mut().zip(map) {
                to[lane..lane + SIDE].copy_from_slice(from);
            }
        }
        if let Some(guess) = self.guess.get(at) {
            for (to, guess) in to.iter_mut().zip(guess) {
                for (to, guess) in to.iter_mut().zip(guess) {
                    *to -= guess;
                }
            }
        }
        self.at = at;
    }

    /// See [`super::Reconstruction::filter`].
    ///
    /// * `noisy`: bands that may be noise; what comes after them is kept.
    pub(super) fn filter(&mut self, scales: &Scales, caution: f32, noisy: usize) {
        let Self {
            parts,
            power: [power, other],
            gains,
            kinds,
            ..
        } = self;
        let cells = parts[0].len();
        gains.resize(scales.bands(), Vec::new());
        kinds.clear();
        kinds.resize(cells, [0.0; LANES]);
        scales.take_apart(parts, |band, part| {
            let gains = &mut gains[band];
            gains.resize(cells, [1.0; LANES / 2]);
            if band < noisy {
                power.resize(cells, [0.0; LANES]);
                widest(
                    #[inline(always)]
                    || {
                        for (power, part) in power.iter_mut().zip(part) {
                            *power = part.map(|v| v * v);
                        }
                    },
                );
                scales.around(band, power, other);
            }
            widest(
                #[inline(always)]
                || {
                    if band < noisy {
                        for (gains, power) in gains.iter_mut().zip(&*power) {
                            let (pairs, _) = power.as_chunks::<2>();
                            for (gain, &[all, noise]) in gains.iter_mut().zip(pairs) {
                                *gain = share(all, noise, caution);
                            }
                        }
                    }
                    for ((out, gains), part) in kinds.iter_mut().zip(gains).zip(part) {
                        for (lane, (out, part)) in out.iter_mut().zip(part).enumerate() {
                            *out += gains[lane / 2] * part;
                        }
                    }
                },
            );
        });
        if let Some(guess) = self.guess.get(self.at) {
            for (out, guess) in self.kinds.iter_mut().zip(guess) {
                for (out, guess) in out.iter_mut().zip(guess) {
                    *out += guess;
                }
            }
        }
    }

    /// Filters levels with the shares that were kept of the light that met pigment.
    pub(super) fn filter_levels(&mut self, scales: &Scales) {
        let Self {
            parts,
            gains,
            levels,
            ..
        } = self;
        levels.clear();
        match self.guess.get(self.at) {
            Some(guess) => levels.extend_from_slice(guess),
            None => levels.resize(parts[0].len(), [0.0; LANES]),
        }
        scales.take_apart(parts, |band, part| {
            widest(
                #[inline(always)]
                || {
                    let cells = levels.iter_mut().zip(&gains[band]).zip(part);
                    for ((out, gains), part) in cells {
                        for (lane, (out, part)) in out.iter_mut().zip(part).enumerate() {
                            *out += gains[lane / SIDE * 2 + 1] * part;
                        }
                    }
                },
            );
        });
    }
}

/// Desks that nobody works at: as many as there were threads.
#[derive(Default)]
pub(super) struct Desks(Mutex<Vec<Desk>>);

impl Desks {
    pub(super) fn take(&self) -> Desk {
        self.all().pop().unwrap_or_default()
    }

    pub(super) fn give(&self, desk: Desk) {
        self.all().push(desk);
    }

    fn all(&self) -> std::sync::MutexGuard<'_, Vec<Desk>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
