//! The course of a free edge round the fiber: the recipe's terms and the cuticle's margin modifier.

use super::symmetric;
use crate::sampling::hash64;
use crate::species::{Cuticle, CyclesPer, Margin, MarginTerm, MarginWave, PatternRecipe, RowPhase};
use std::f64::consts::TAU;

/// All terms of a free edge, ready for one fiber.
#[derive(Clone, Debug)]
pub(super) struct FreeEdge {
    terms: Vec<Term>,
    rows: usize,
    jitter: f64,
    seed: u64,
}

#[derive(Clone, Copy, Debug)]
struct Term {
    curve: Curve,
    /// Pitches.
    amplitude: f64,
    /// Whole cycles, or knots of a noise, round the fiber.
    cycles: usize,
    phase: RowPhase,
    /// Whether teeth differ in size and distance.
    uneven: bool,
}

#[derive(Clone, Copy, Debug)]
enum Curve {
    Sine,
    Triangle,
    Comb { sharpness: f64 },
    Scallop,
    Noise { rows: usize, gate: usize },
}

/// Share of the amplitude and of a cycle by which teeth differ at full jitter: less looks machined,
/// more makes teeth run into each other.
const UNEVEN: f64 = 0.4;
/// How far a wandering phase goes, radians, and its change per row.
const WANDER: f64 = 1.1;
const WANDER_RATE: f64 = 0.9;
/// Lines that a cycle of a margin modifier must have: fewer would alias.
const LINES_PER_CYCLE: f64 = 3.0;

impl FreeEdge {
    /// * `spacing_um`: distance between the lines on which the edge will be given.
    pub(super) fn new(
        cuticle: &Cuticle,
        recipe: &PatternRecipe,
        rows: usize,
        circumference_um: f64,
        spacing_um: f64,
        seed: u64,
    ) -> Self {
        let around = f64::from(cuticle.around.max(1));
        let mut terms: Vec<Term> = recipe.margin.iter().map(|t| term(t, around)).collect();
        // Sizes after the terms of Brunner and Coman 1974: crenate shallow and pointed, rippled
        // deeper and rounded, scalloped round lobes, dentate teeth. Micrometers are estimates.
        let modifier = match cuticle.margin {
            Margin::Smooth => None,
            Margin::Crenate => Some((Curve::Noise { rows: 1, gate: 0 }, 0.6, 1.5)),
            Margin::Rippled => Some((Curve::Sine, 1.5, 6.0)),
            Margin::Scalloped => Some((Curve::Scallop, 1.0, 8.0)),
            Margin::Dentate => Some((Curve::Triangle, 1.5, 7.0)),
        };
        terms.extend(modifier.map(|(curve, amplitude_um, wave_um)| {
            let wave_um: f64 = f64::max(wave_um, LINES_PER_CYCLE * spacing_um);
            Term {
                curve,
                amplitude: amplitude_um / cuticle.pitch_um,
                cycles: ((circumference_um / wave_um).round() as usize).max(2),
                phase: RowPhase::Random,
                uneven: true,
            }
        }));
        Self {
            terms,
            rows,
            jitter: cuticle.jitter,
            seed,
        }
    }

    /// How far the edge may reach beyond its mean, pitches.
    pub(super) fn reach(&self) -> f64 {
        self.terms.iter().map(|t| t.amplitude).sum()
    }

    /// How far the edge of a scale reaches toward the tip, pitches.
    ///
    /// * `scale`: its index, `row`: its row, `turn`: the place round the fiber, 0..1.
    pub(super) fn at(&self, scale: usize, row: usize, turn: f64) -> f64 {
        let term = |(i, t): (usize, &Term)| t.amplitude * self.curve(i as u64, t, scale, row, turn);
        self.terms.iter().enumerate().map(term).sum()
    }

    fn curve(&self, index: u64, term: &Term, scale: usize, row: usize, turn: f64) -> f64 {
        let what = 64 + 8 * index;
        if let Curve::Noise { rows, gate } = term.curve {
            let noise = |k: usize| self.noise(what, k, term.cycles, turn);
            let value = if rows <= 1 {
                noise(scale)
            } else {
                // Shared by some rows, with a cross-fade.
                let knots = (self.rows / rows).max(1);
                let x = row as f64 * knots as f64 / self.rows as f64;
                let (i, f) = (x.floor() as usize, x.fract());
                (1.0 - f) * noise(i % knots) + f * noise((i + 1) % knots)
            };
            return if gate == 0 {
                value
            } else {
                value * self.noise(what + 1, scale, gate, turn).abs()
            };
        }
        let mut x = turn * term.cycles as f64 + self.phase(what, term.phase, scale, row);
        let mut size = 1.0;
        if term.uneven {
            x += UNEVEN * self.jitter * self.noise(what + 2, scale, term.cycles, turn);
            size += UNEVEN * self.jitter * self.noise(what + 3, scale, term.cycles, turn);
        }
        let share = x.rem_euclid(1.0);
        size * match term.curve {
            Curve::Sine => (TAU * x).sin(),
            Curve::Triangle => 4.0 * (share - 0.5).abs() - 1.0,
            Curve::Comb { sharpness } => {
                2.0 * (1.0 - (2.0 * share - 1.0).abs()).powf(sharpness) - 1.0
            }
            Curve::Scallop => 2.0 * (0.5 * TAU * x).sin().abs() - 1.0,
            Curve::Noise { .. } => 0.0,
        }
    }

    /// In cycles.
    fn phase(&self, what: u64, phase: RowPhase, scale: usize, row: usize) -> f64 {
        match phase {
            RowPhase::Same => 0.0,
            RowPhase::Alternate => 0.5 * (row % 2) as f64,
            RowPhase::Wander => {
                // Back at its start after the period.
                let rows = self.rows as f64;
                let rate = TAU * (WANDER_RATE * rows / TAU).round().max(1.0) / rows;
                WANDER / TAU * (rate * row as f64).sin()
            }
            RowPhase::Random => 0.5 * symmetric(self.seed, what + 4, scale),
        }
    }

    /// Value noise round the fiber, -1..1, with `knots` values a turn so that it closes.
    fn noise(&self, what: u64, scale: usize, knots: usize, turn: f64) -> f64 {
        let x = turn.rem_euclid(1.0) * knots as f64;
        let f = x.fract();
        let knot = |k: usize| symmetric(self.seed, hash64(what) ^ scale as u64, k % knots);
        let (a, b) = (knot(x as usize), knot(x as usize + 1));
        a + (b - a) * f * f * (3.0 - 2.0 * f)
    }
}

fn term(term: &MarginTerm, around: f64) -> Term {
    let share = match term.per {
        CyclesPer::Turn => 1.0,
        CyclesPer::Scale => around,
    };
    let whole = |cycles: f64| ((cycles * share).round() as usize).max(1);
    let (curve, least) = match term.wave {
        MarginWave::Sine => (Curve::Sine, 1),
        MarginWave::Triangle => (Curve::Triangle, 1),
        MarginWave::Comb { sharpness } => (Curve::Comb { sharpness }, 1),
        MarginWave::Noise { rows, gate } => {
            let gate = if gate > 0.0 { whole(gate) } else { 0 };
            let rows = rows as usize;
            // Fewer knots than this are a circle off its center, no noise.
            (Curve::Noise { rows, gate }, 4)
        }
    };
    Term {
        curve,
        amplitude: term.amplitude,
        cycles: whole(term.cycles).max(least),
        phase: term.phase,
        uneven: false,
    }
}
