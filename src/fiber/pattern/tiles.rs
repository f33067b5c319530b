//! Separate scales: petals and polygons.

use super::covering::{ascend, envelope, visible};
use super::damage::Lift;
use super::rise::Rise;
use super::{Builder, Pattern, Scale, Shown};
use crate::species::PatternLayout;

/// Where a petal stands.
struct Petal {
    base: f64,
    /// Of its middle, 0..1.
    turn: f64,
    length: f64,
}

impl Builder<'_> {
    /// Petals in rows, every other row set off.
    pub(super) fn petals(&self) -> Pattern {
        let PatternLayout::Petals {
            length,
            width,
            waist,
            taper,
            stagger,
        } = self.recipe.layout
        else {
            return Pattern::bare(self.lines, self.rows as f64 * self.cuticle.pitch_um);
        };
        let n = self.around;
        let petals: Vec<Petal> = (0..self.rows * n)
            .map(|index| {
                let (row, i) = (index / n, index % n);
                let shift = stagger * (row % 2) as f64 + 0.06 * self.jitter(2, index);
                Petal {
                    base: row as f64 + 0.12 * self.jitter(1, index),
                    turn: (i as f64 + shift) / n as f64,
                    length: length * (1.0 + 0.08 * self.jitter(3, index)),
                }
            })
            .collect();
        let end = |k: usize, turn: f64| {
            let petal = &petals[k];
            let d = (turn - petal.turn + 0.5).rem_euclid(1.0) - 0.5;
            let across = 2.0 * (d * n as f64).abs() / width;
            if across >= 1.0 {
                return f64::NEG_INFINITY;
            }
            let reach = waist + (1.0 - waist) * (1.0 - across).powf(1.0 / taper);
            petal.base + petal.length * reach + self.edge.at(k, k / n, turn)
        };
        // The bare shaft where no petal stands: a scale of its own, hidden by all others.
        let shaft = petals.len();
        let period = self.rows as f64;
        let shown: Vec<Shown> = self
            .lines
            .iter()
            .map(|line| {
                let ends: Vec<f64> = (0..shaft).map(|k| end(k, line.turn)).collect();
                let ends = self.unless_bare(&ends, |k| self.is_worn(k));
                let shown: Shown = visible(&ends, period)
                    .into_iter()
                    .map(|k| (k, ends[k]))
                    .collect();
                if shown.is_empty() {
                    vec![(shaft, period)]
                } else {
                    shown
                }
            })
            .collect();
        let mut scales: Vec<Scale> = petals
            .iter()
            .map(|petal| Scale {
                base: petal.base,
                pivot: 1.0,
            })
            .collect();
        scales.push(Scale {
            base: 2.0 * period,
            pivot: 0.0,
        });
        let lifts = (0..shaft).filter_map(|k| self.lifted(k, petals[k].base, length));
        let lifts: Vec<Lift> = lifts.collect();
        let rise = Rise::new(self.recipe.rise, length).on_shaft();
        self.assemble(&scales, &rise, 1.0, shown, lifts)
    }

    /// Polygons: the Voronoi cells of staggered seeds that stray by `scatter`.
    pub(super) fn mosaic(&self, scatter: f64) -> Pattern {
        let n = self.around.max(2);
        let mut seeds: Vec<(f64, f64)> = (0..self.rows * n)
            .map(|index| {
                let (row, i) = (index / n, index % n);
                let turn = i as f64 + 0.5 * (row % 2) as f64 + scatter * self.jitter(1, index);
                let z = row as f64 + scatter * self.jitter(2, index);
                (z, turn)
            })
            .collect();
        seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let scales: Vec<Scale> = seeds
            .iter()
            .map(|seed| Scale {
                base: seed.0 - 0.5,
                pivot: 0.5,
            })
            .collect();
        let period = self.rows as f64;
        let shown = self
            .lines
            .iter()
            .map(|line| {
                // With equal curvature along z the lower envelope of the squared distances is the
                // upper envelope of straight lines with slopes in seed order.
                let offset = |k: usize| {
                    let d = line.turn * n as f64 - seeds[k].1 + 0.5 * n as f64;
                    (d.rem_euclid(n as f64) - 0.5 * n as f64).powi(2)
                };
                let all: Shown = envelope(&seeds, period, offset)
                    .into_iter()
                    .map(|(k, end)| (k, end + self.edge.at(k, k / n, line.turn)))
                    .collect();
                let mut kept: Shown = all
                    .iter()
                    .copied()
                    .filter(|&(k, _)| !self.is_worn(k))
                    .collect();
                if kept.is_empty() {
                    kept = all;
                }
                ascend(&mut kept, period);
                kept
            })
            .collect();
        let lifts = (0..seeds.len()).filter_map(|k| self.lifted(k, seeds[k].0 - 0.5, 1.0));
        let lifts: Vec<Lift> = lifts.collect();
        self.assemble(
            &scales,
            &Rise::new(self.recipe.rise, 1.0),
            1.0,
            shown,
            lifts,
        )
    }
}
