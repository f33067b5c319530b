//! Integer sums of one node: order-free and exact.

use crate::math::unicube::Unicube;
use crate::table::{Ledger, PHOTON};

/// Most absorption levels a tally holds.
pub(super) const MAX_LEVELS: usize = 24;

/// Where the photons of one node went, per absorption level, in units of 2^-32 photon.
///
/// What was absorbed is summed photon by photon and what escaped is the sum of the texels: that
/// they add up to what was emitted is a check, not a definition.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    levels: usize,
    /// `texels[texel * levels + level]`: a photon touches one contiguous run.
    texels: Vec<u64>,
    photons: u64,
    absorbed: [u64; MAX_LEVELS],
    truncated: [u64; MAX_LEVELS],
    lost: [u64; MAX_LEVELS],
}

impl Tally {
    pub(super) fn new(texels: usize, levels: usize) -> Self {
        debug_assert!((1..=MAX_LEVELS).contains(&levels));
        let zero = [0; MAX_LEVELS];
        let texels = vec![0; texels * levels];
        Self {
            levels,
            texels,
            photons: 0,
            absorbed: zero,
            truncated: zero,
            lost: zero,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.photons == 0
    }

    /// A photon left through `texel`.
    ///
    /// * `share`: what is left of it, pigment aside; `path`: its way through pigment in radii.
    pub(super) fn escape(&mut self, texel: usize, share: f64, path: f64, levels: &[f64]) {
        let weights = self.arrive(share, path, levels);
        let run = &mut self.texels[texel * self.levels..(texel + 1) * self.levels];
        for (sum, weight) in run.iter_mut().zip(weights) {
            *sum += weight;
        }
    }

    /// A photon was given up.
    pub(super) fn truncate(&mut self, share: f64, path: f64, levels: &[f64]) {
        let weights = self.arrive(share, path, levels);
        add(&mut self.truncated, &weights);
    }

    /// A photon found no boundary.
    pub(super) fn lose(&mut self, share: f64, path: f64, levels: &[f64]) {
        let weights = self.arrive(share, path, levels);
        add(&mut self.lost, &weights);
    }

    /// Nothing was left of a photon.
    pub(super) fn absorb(&mut self, levels: &[f64]) {
        self.arrive(0.0, 0.0, levels);
    }

    /// Books a photon and what was taken of it on its way; returns what is left at each level.
    fn arrive(&mut self, share: f64, path: f64, levels: &[f64]) -> [u64; MAX_LEVELS] {
        self.photons += 1;
        let weights = weights(share, path, levels);
        for (absorbed, weight) in self.absorbed.iter_mut().zip(&weights).take(levels.len()) {
            *absorbed += PHOTON - weight;
        }
        weights
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (a, b) in self.texels.iter_mut().zip(&other.texels) {
            *a += b;
        }
        self.photons += other.photons;
        add(&mut self.absorbed, &other.absorbed);
        add(&mut self.truncated, &other.truncated);
        add(&mut self.lost, &other.lost);
    }

    /// The books, per level.
    pub(super) fn ledger(&self) -> Vec<Ledger> {
        (0..self.levels)
            .map(|k| Ledger {
                emitted: self.photons * PHOTON,
                escaped: self.texels.iter().skip(k).step_by(self.levels).sum(),
                absorbed: self.absorbed[k],
                truncated: self.truncated[k],
                lost: self.lost[k],
            })
            .collect()
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
        let scale = 1.0 / (self.photons as f64 * PHOTON as f64);
        for k in 0..self.levels {
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

    /// Relative standard error of the clear level: photons there count 1 each. An upper bound where
    /// they count less because something opaque was on their way.
    pub(super) fn error(&self) -> Vec<f32> {
        let photons = |v: &u64| *v as f64 / PHOTON as f64;
        self.texels
            .iter()
            .step_by(self.levels)
            .map(|v| (1.0 / photons(v).sqrt()) as f32)
            .collect()
    }
}

fn add(a: &mut [u64; MAX_LEVELS], b: &[u64; MAX_LEVELS]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
}

/// The fixed-point weight `share * exp(-level * path)` of every level. Levels from the second on are a
/// geometric series of ratio 2, so each weight is the square of the one before.
#[inline]
fn weights(share: f64, path: f64, levels: &[f64]) -> [u64; MAX_LEVELS] {
    let mut weights = [0; MAX_LEVELS];
    let clear = share * PHOTON as f64;
    weights[0] = clear as u64;
    let mut left = levels.get(1).map_or(0.0, |first| (-first * path).exp());
    for weight in weights.iter_mut().take(levels.len()).skip(1) {
        *weight = (left * clear) as u64;
        left *= left;
    }
    weights
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
            let share = 1.0 / f64::from(1 + i % 7);
            match i % 10 {
                0 => tally.truncate(share, path, &levels),
                1 => tally.lose(share, path, &levels),
                2 => tally.absorb(&levels),
                _ => tally.escape(i as usize % cube.texels(), share, path, &levels),
            }
        }
        tally.fold(&cube);
        for l in tally.ledger() {
            assert_eq!(l.emitted, l.escaped + l.absorbed + l.truncated + l.lost);
            assert!(l.truncated > 0 && l.lost > 0);
        }
        let weights = weights(0.3, 0.7, &levels);
        for (level, weight) in levels.iter().zip(weights) {
            let exact = 0.3 * (-level * 0.7).exp();
            assert!((weight as f64 / PHOTON as f64 - exact).abs() < 1e-9);
        }
    }
}
