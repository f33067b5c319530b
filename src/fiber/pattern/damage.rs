//! Wear and damage: scales that are gone and scales that stand off.

use super::Builder;
use crate::sampling::{Rng, hash64};

/// A scale, or a piece of a row, that damage has raised about its base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lift {
    pub(super) scale: u32,
    /// Where it is hinged, micrometers.
    pub(super) hinge_um: f64,
    /// Added to the slope in the middle.
    slope: f64,
    /// The middle of the piece, 0..1 round the fiber, and half its width; infinite for all of a scale.
    turn: f64,
    half_width: f64,
}

/// Raised by so many degrees (Common damage of dry hair; the range is an estimate).
const LIFT_DEG: (f64, f64) = (5.0, 15.0);
/// A raised edge stands off by at most this share of the radius: on the finest hair 15 degrees of a
/// long petal would be more than the hair is thick.
const HIGHEST_LIFT: f64 = 0.3;
/// Width of a piece of a row over its pitch: cells of the cuticle are wider than their visible part
/// is long, and where margins are steep a wider piece would tear.
const PIECE: f64 = 3.0;

impl Lift {
    /// Added slope at a place round the fiber.
    pub(super) fn slope_at(&self, turn: f64) -> f64 {
        if self.half_width == f64::INFINITY {
            return self.slope;
        }
        let d = ((turn - self.turn + 0.5).rem_euclid(1.0) - 0.5) / self.half_width;
        self.slope * (1.0 - d * d).max(0.0).powi(2)
    }
}

impl Builder<'_> {
    fn chance(&self, what: u64, index: usize) -> f64 {
        Rng::new(self.seed ^ hash64(what), index as u64).uniform()
    }

    /// Whether a scale or piece is worn away.
    pub(super) fn is_worn(&self, index: usize) -> bool {
        self.cuticle.wear > 0.0 && self.chance(21, index) < self.cuticle.wear
    }

    /// `ends` without the worn scales, unless nothing would be left on the line.
    pub(super) fn unless_bare(&self, ends: &[f64], worn: impl Fn(usize) -> bool) -> Vec<f64> {
        let left = |k: usize| if worn(k) { f64::NEG_INFINITY } else { ends[k] };
        let kept: Vec<f64> = (0..ends.len()).map(left).collect();
        if kept.iter().any(|&end| end > f64::NEG_INFINITY) {
            kept
        } else {
            ends.to_vec()
        }
    }

    /// Cells in a row: one where a scale wraps the shaft.
    pub(super) fn pieces(&self) -> usize {
        let cells = self.circumference_um / (PIECE * self.cuticle.pitch_um);
        if self.around == 1 {
            1
        } else {
            self.around.max(cells.round() as usize)
        }
    }

    /// The cell of a row at a place round the fiber.
    pub(super) fn piece(&self, row: usize, turn: f64) -> usize {
        let pieces = self.pieces();
        let x = (turn + self.chance(23, row)) * pieces as f64;
        x as usize % pieces
    }

    /// The lift of a whole scale, if damage has raised it: from `base`, `length` pitches long.
    pub(super) fn lifted(&self, scale: usize, base: f64, length: f64) -> Option<Lift> {
        self.lift(scale, scale, base, length, None)
    }

    /// The lifts of rows whose margins lie about `ends`, by cells.
    pub(super) fn lifted_pieces(&self, ends: &[f64]) -> Vec<Lift> {
        let pieces = self.pieces();
        let mut lifts = Vec::new();
        for (row, end) in ends.iter().enumerate() {
            for piece in 0..pieces {
                let middle = (piece as f64 + 0.5) / pieces as f64 - self.chance(23, row);
                let turn = middle.rem_euclid(1.0);
                let extent = (pieces > 1).then_some((turn, 0.5 / pieces as f64));
                // Hinged where the row before ends there.
                let base = end - 1.0 + self.edge.at(row, row, turn);
                lifts.extend(self.lift(row, row * pieces + piece, base, 1.0, extent));
            }
        }
        lifts
    }

    fn lift(
        &self,
        scale: usize,
        index: usize,
        base: f64,
        length: f64,
        extent: Option<(f64, f64)>,
    ) -> Option<Lift> {
        if self.cuticle.lifted <= 0.0 || self.chance(22, index) >= self.cuticle.lifted {
            return None;
        }
        let pitch = self.cuticle.pitch_um;
        let (least, most) = LIFT_DEG;
        let angle = least + (most - least) * self.chance(24, index);
        let radius = self.circumference_um / std::f64::consts::TAU;
        let highest = HIGHEST_LIFT * radius / (length * pitch);
        let (turn, half_width) = extent.unwrap_or((0.0, f64::INFINITY));
        Some(Lift {
            scale: scale as u32,
            hinge_um: base * pitch,
            slope: angle.to_radians().tan().min(highest),
            turn,
            half_width,
        })
    }
}
