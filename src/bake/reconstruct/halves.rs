//! The error that filtering leaves, from two halves of the photons.
//!
//! Two readings of it. What lies between the filtered halves is their variance; the filter weighs noise
//! against detail, so what it takes off the signal is about as large as the noise it leaves ([`BIASED`]).
//! And each filtered half is held against the plain counts of the other, noise of known variance
//! taken off: this sees all that is wrong, but is itself uncertain while counts are few. Each counts by
//! its own uncertainty.

use super::desk::{Desk, Desks, SIDE};
use super::signal::Half;
use super::{Map, Reconstruction};
use crate::bake::noise::{Noise, Norm};
use crate::bake::tally::Tally;
use rayon::prelude::*;

/// Squared error of a filtered map over its variance: 1.2 to 2.5 in bakes of eight animals with 2.5e4 and 6e4 photons, held
/// against plain counts. Lower and tables are worse than they say; higher and bakes to a target error fly too long.
const BIASED: f64 = 1.7;
/// How uncertain that is, relative to the squared error.
const BIASED_WITHIN: f64 = 0.35;
/// How much more uncertain than independent photons of one weight the other reading is.
const SPREAD: f64 = 1.5;
/// How much the squared error falls from half of the photons to all: 1.4 to 2.0 in bakes of the same animals with 3e4 to
/// 2e5 photons.
const HALVED: f64 = 1.6;

/// What the halves say of one node, in common units.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Variance of a filtered half.
    variance: f64,
    /// Squared error of a filtered half against the counts of the other.
    apart: f64,
    /// Variance of that.
    spread: f64,
    /// What the halves have in common, squared.
    signal: f64,
}

impl Reconstruction {
    /// Errors of the clear levels of all nodes, and their power.
    ///
    /// * `counts`: whether a node is within the norm.
    pub(in crate::bake) fn noise(
        &self,
        tallies: &[Tally],
        norm: &Norm,
        counts: &[bool],
    ) -> Vec<Noise> {
        let halves = [Half::First, Half::Second].map(|half| {
            let tallies = tallies.par_iter().with_max_len(1);
            let signals = tallies.map(|tally| self.signals(tally, half));
            signals.collect::<Vec<Map>>()
        });
        let [first, second] = &halves;
        let (mut guess, other) = rayon::join(
            || self.guess(tallies, first, &[]),
            || self.guess(tallies, second, &[]),
        );
        guess.extend(other);
        let desks = Desks::default();
        let nodes = (0..tallies.len()).into_par_iter().with_max_len(1);
        let found: Vec<Found> = nodes
            .map(|node| {
                // Every second node tells as much, for two thirds of the work.
                if !counts[node] || node % 2 == 1 {
                    return Found::default();
                }
                let mut desk = desks.take();
                self.expect_halves(&mut desk, node, &guess);
                let raw = [&first[node], &second[node]];
                desk.load(0, raw);
                self.filter(&mut desk);
                let found = self.held_against(&desk, raw, norm);
                desks.give(desk);
                found
            })
            .collect();
        let sum = |of: fn(&Found) -> f64| found.iter().map(of).sum::<f64>();
        let variance = sum(|f| f.variance);
        let error = joined(variance, sum(|f| f.apart), sum(|f| f.spread)) / HALVED;
        // Of the nodes one by one only the variances are certain enough.
        let each = if variance > 0.0 {
            error / variance
        } else {
            0.0
        };
        let noise = found.iter().map(|f| Noise {
            noise: each * f.variance,
            power: f.signal + each * f.variance,
        });
        noise.collect()
    }

    /// What filtered halves say when each is held against the counts of the other.
    fn held_against(&self, desk: &Desk, raw: [&Map; 2], norm: &Norm) -> Found {
        let mut found = Found::default();
        let mut means = vec![[0.0; 2]; self.scales.texels.len()];
        for kind in [0, 2] {
            let [sum, squares] = raw
                .into_iter()
                .flatten()
                .fold([0.0; 2], |[sum, squares], v| {
                    let [density, deviation] = [v[kind], v[kind + 1]].map(f64::from);
                    [sum + density, squares + deviation * deviation]
                });
            // The variance of a count over the count.
            let unit = if sum > 0.0 { squares / sum } else { 0.0 };
            for (cell, &[texel, mirror]) in self.scales.texels.iter().enumerate() {
                let copies = if texel == mirror { 1.0 } else { 2.0 };
                let weight = norm.weight(texel) * copies * self.solid_angle[cell].powi(2);
                if weight == 0.0 {
                    continue;
                }
                let mean = [0, SIDE].map(|half| f64::from(desk.kinds[cell][half + kind]));
                found.variance += 0.5 * weight * (mean[0] - mean[1]).powi(2);
                for (one, other) in [(0, 1), (1, 0)] {
                    let [raw, deviation] =
                        [raw[other][cell][kind], raw[other][cell][kind + 1]].map(f64::from);
                    let apart = (mean[one] - raw).powi(2) - deviation * deviation;
                    found.apart += 0.5 * weight * apart;
                    found.spread += (weight * mean[one].max(0.0) * unit).powi(2);
                }
                for (sum, mean) in means[cell].iter_mut().zip(mean) {
                    *sum += mean * weight.sqrt();
                }
            }
        }
        found.signal = means.iter().map(|[a, b]| a * b).sum();
        found
    }
}

/// The squared error of a half from both readings.
fn joined(variance: f64, apart: f64, spread: f64) -> f64 {
    let by_variance = BIASED * variance;
    let certainty = 1.0 / (BIASED_WITHIN * by_variance).powi(2);
    let other = 1.0 / (SPREAD * SPREAD * spread);
    if certainty.is_finite() && other.is_finite() {
        ((certainty * by_variance + other * apart) / (certainty + other)).max(variance)
    } else {
        by_variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_more_certain_reading_counts_more_and_none_is_below_the_variance() {
        let sharp = joined(1.0, 3.0, 1e-4);
        assert!((sharp - 3.0).abs() < 0.01, "{sharp}");
        let vague = joined(1.0, 3.0, 1e4);
        assert!((vague - BIASED).abs() < 0.01, "{vague}");
        assert_eq!(joined(1.0, -5.0, 1.0), 1.0);
        assert_eq!(joined(0.0, 0.0, 0.0), 0.0);
    }
}
