//! Integer sums of one node: order-free and exact.

use crate::math::unicube::Unicube;
use crate::table::{Ledger, PHOTON};

/// Where the photons of one node went, per absorption level, in units of 2^-32 photon.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    levels: usize,
    /// `texels[texel * levels + level]`: a photon touches one contiguous run.
    texels: Vec<u64>,
    pub(super) ledger: Vec<Ledger>,
}

impl Tally {
    pub(super) fn new(texels: usize, levels: usize) -> Self {
        Self {
            levels,
            texels: vec![0; texels * levels],
            ledger: vec![Ledger::default(); levels],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ledger[0].emitted == 0
    }

    /// A photon left through `texel` after an optical path of `path` radii of pigment.
    pub(super) fn escape(&mut self, texel: usize, path: f64, levels: &[f64]) {
        let run = &mut self.texels[texel * self.levels..(texel + 1) * self.levels];
        for_each_level(path, levels, |k, weight| {
            run[k] += weight;
            self.ledger[k].emitted += PHOTON;
            self.ledger[k].escaped += weight;
            self.ledger[k].absorbed += PHOTON - weight;
        });
    }

    pub(super) fn truncate(&mut self, path: f64, levels: &[f64]) {
        for_each_level(path, levels, |k, weight| {
            self.ledger[k].emitted += PHOTON;
            self.ledger[k].truncated += weight;
            self.ledger[k].absorbed += PHOTON - weight;
        });
    }

    pub(super) fn lose(&mut self, path: f64, levels: &[f64]) {
        for_each_level(path, levels, |k, weight| {
            self.ledger[k].emitted += PHOTON;
            self.ledger[k].lost += weight;
            self.ledger[k].absorbed += PHOTON - weight;
        });
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (a, b) in self.texels.iter_mut().zip(&other.texels) {
            *a += b;
        }
        for (a, b) in self.ledger.iter_mut().zip(&other.ledger) {
            a.emitted += b.emitted;
            a.escaped += b.escaped;
            a.absorbed += b.absorbed;
            a.truncated += b.truncated;
            a.lost += b.lost;
        }
    }

    /// Averages the map with its mirror image phi -> -phi. The sum stays exact: an odd unit goes to
    /// the texel with the lower number.
    pub(super) fn fold(&mut self, cube: &Unicube) {
        for texel in 0..cube.texels() {
            let mirror = cube.mirrored(texel);
            if texel < mirror {
                for k in 0..self.levels {
                    let (a, b) = (texel * self.levels + k, mirror * self.levels + k);
                    let sum = self.texels[a] + self.texels[b];
                    self.texels[b] = sum / 2;
                    self.texels[a] = sum - sum / 2;
                }
            }
        }
    }

    /// Flux fractions, level by level.
    pub(super) fn flux(&self) -> Vec<f32> {
        let mut flux = Vec::with_capacity(self.texels.len());
        for k in 0..self.levels {
            let scale = 1.0 / self.ledger[k].emitted as f64;
            flux.extend(
                self.texels
                    .iter()
                    .skip(k)
                    .step_by(self.levels)
                    .map(|&v| (v as f64 * scale) as f32),
            );
        }
        flux
    }

    /// Relative standard error of the clear level: photons there count 1 each.
    pub(super) fn error(&self) -> Vec<f32> {
        let photons = |v: &u64| *v as f64 / PHOTON as f64;
        self.texels
            .iter()
            .step_by(self.levels)
            .map(|v| (1.0 / photons(v).sqrt()) as f32)
            .collect()
    }
}

/// Calls `f` with the fixed-point weight `exp(-level * path)` of every level. Levels from the second
/// on are a geometric series of ratio 2, so each weight is the square of the one before.
#[inline]
fn for_each_level(path: f64, levels: &[f64], mut f: impl FnMut(usize, u64)) {
    f(0, PHOTON);
    let Some(&first) = levels.get(1) else { return };
    let mut weight = (-first * path).exp();
    for k in 1..levels.len() {
        f(k, (weight * PHOTON as f64) as u64);
        weight *= weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::absorption_levels;

    #[test]
    fn ledger_is_exact_and_weights_follow_beer() {
        let levels = absorption_levels(12);
        let cube = Unicube::new(4);
        let mut tally = Tally::new(cube.texels(), levels.len());
        for i in 0..1000u32 {
            let path = f64::from(i % 37) * 0.31;
            match i % 10 {
                0 => tally.truncate(path, &levels),
                1 => tally.lose(path, &levels),
                _ => tally.escape(i as usize % cube.texels(), path, &levels),
            }
        }
        tally.fold(&cube);
        for (k, l) in tally.ledger.iter().enumerate() {
            assert_eq!(l.emitted, l.escaped + l.absorbed + l.truncated + l.lost);
            let sum: u64 = tally.texels.iter().skip(k).step_by(levels.len()).sum();
            assert_eq!(sum, l.escaped);
        }
        for_each_level(0.7, &levels, |k, weight| {
            let exact = (-levels[k] * 0.7).exp();
            assert!((weight as f64 / PHOTON as f64 - exact).abs() < 1e-9);
        });
    }
}
