//! How much of the environment's light comes to each place in the fur, roughly: where rays to light are worth
//! sending, and which paths are worth following. Nothing but noise depends on it.
//!
//! Light of each bin of the environment is swept through a grid of what the strands and the skin block; then what
//! they send each other.

mod fur;
mod glow;
mod sweep;

use super::{BINS, Environment, Strands, Surface};
use crate::pages::Table;
use fur::{Fur, Grid};
use glam::Vec3;
use glow::glow;
use rayon::prelude::*;
use sweep::Sweep;

/// Cells along the longest side. With 48 and 72 noise is the same.
const SIDE: f32 = 32.0;

/// Where in a bin directions are that stand for it.
const DIRECTIONS: [[f32; 2]; 4] = [
    [0.125, 0.625],
    [0.375, 0.125],
    [0.625, 0.875],
    [0.875, 0.375],
];

/// Share of directions that is drawn as if nothing were in the way, since a cell does not know its brightest
/// places: where it errs a direction is at most ten times as rare as without it.
const UNGUIDED: f32 = 0.1;

/// Share of all light below which it does not matter where it comes from.
const DARK: f32 = 1e-6;

/// Ones of what is stored.
const STEPS: f32 = 65_535.0;

/// No sight.
const NONE: u32 = u32::MAX;

/// What one cell sees of the environment.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Sight {
    /// Running sums of the shares of bins of what is seen, in [`STEPS`]; behind the last, which is all, the share of all light
    /// that is seen.
    running: [u16; BINS],
}

/// Sights of the cells that have something in them.
pub struct Outlook {
    grid: Grid,
    /// Sight of each cell.
    cells: Vec<u32>,
    sights: Table<Sight>,
    /// Mean radiance at each of them over that of the environment.
    glow: Vec<f32>,
}

/// What is known of a place.
#[derive(Clone, Copy)]
pub struct Look<'a> {
    /// What it sees of the environment.
    pub sight: &'a Sight,
    /// About the mean radiance there over that of the environment.
    pub glow: f32,
}

impl Outlook {
    /// `None` where all light is in one bin.
    ///
    /// * `bounds`: of everything, millimeters.
    pub(super) fn build(
        strands: &Strands,
        surface: Option<&Surface>,
        environment: &Environment,
        (low, high): (Vec3, Vec3),
    ) -> Option<Self> {
        let shares = environment.bins();
        if shares.len() < 2 {
            return None;
        }
        let grid = Grid::new(low, high, SIDE);
        let fur = Fur::new(&grid, strands, surface);
        let of_bin = |bin: usize| {
            let mut sweep = Sweep::new(&grid);
            let mut sum = vec![0.0f32; fur.cells.len()];
            let directions = DIRECTIONS
                .iter()
                .filter_map(|&u| environment.sample_in(bin, u));
            for sample in directions {
                sweep.run(&grid, &fur, sample.dir);
                for (sum, &cell) in sum.iter_mut().zip(&fur.cells) {
                    *sum += sweep.light[cell as usize];
                }
            }
            let scale = shares[bin] / DIRECTIONS.len() as f32;
            sum.iter_mut().for_each(|sum| *sum *= scale);
            sum
        };
        let light: Vec<Vec<f32>> = (0..shares.len()).into_par_iter().map(of_bin).collect();
        let seen = |i: usize| light.iter().map(|bin| bin[i]).sum();
        let seen: Vec<f32> = (0..fur.cells.len()).map(seen).collect();
        let sights = (0..fur.cells.len())
            .map(|i| Sight::new(shares, |bin| light[bin][i]))
            .collect();
        let mut cells = vec![NONE; grid.cells()];
        for (i, &cell) in fur.cells.iter().enumerate() {
            cells[cell as usize] = i as u32;
        }
        Some(Self {
            cells,
            sights: Table::new(sights),
            glow: glow(&grid, &fur, &seen),
            grid,
        })
    }

    /// Any guess at how bright it is, for tests: nothing but noise may depend on it.
    #[cfg(test)]
    pub(crate) fn guess(&mut self, mut glow: impl FnMut() -> f32) {
        self.glow.iter_mut().for_each(|of_cell| *of_cell = glow());
    }

    /// What is known of a place: of one of the cells around it, chosen by chance, so that no edges are seen. Its sight is
    /// brought near, since reading it takes a while. `None` where no strand and no skin is.
    ///
    /// * `u`: numbers in `[0, 1)`.
    #[inline]
    pub fn look(&self, place: Vec3, [x, y, z]: [f32; 3]) -> Option<Look<'_>> {
        let sight = |moved| {
            let cell = self.grid.cell(place, moved)?;
            Some(self.cells[cell]).filter(|&sight| sight != NONE)
        };
        let found = sight(Vec3::new(x, y, z) - 0.5).or_else(|| sight(Vec3::ZERO))? as usize;
        self.sights.fetch(found);
        Some(Look {
            sight: &self.sights[found],
            glow: self.glow[found],
        })
    }
}

impl Sight {
    /// * `light`: that comes from each bin. * `shares`: what would come if nothing were in the way.
    fn new(shares: &[f32], light: impl Fn(usize) -> f32) -> Self {
        let seen: f32 = (0..shares.len()).map(&light).sum();
        let unguided = if seen > DARK { UNGUIDED } else { 1.0 };
        let guided = (1.0 - unguided) / seen.max(DARK);
        let (mut sum, mut running) = (0.0, [STEPS as u16; BINS]);
        for (bin, share) in shares[..shares.len() - 1].iter().enumerate() {
            sum += guided * light(bin) + unguided * share;
            running[bin] = (sum * STEPS).round() as u16;
        }
        running[BINS - 1] = (seen * STEPS).round() as u16;
        Self { running }
    }

    /// Running sum of the shares before a bin and with it.
    #[inline]
    fn range(&self, bin: usize) -> [f32; 2] {
        let low = if bin == 0 { 0 } else { self.running[bin - 1] };
        let high = if bin == BINS - 1 {
            STEPS as u16
        } else {
            self.running[bin]
        };
        [low, high].map(f32::from)
    }

    /// A bin by the light that comes from it from a number in `[0, 1)`, and what is left of the number.
    #[inline]
    pub fn choose(&self, u: f32) -> (usize, f32) {
        let at = u * STEPS;
        // All before the last, which is not a running sum.
        let sums = &self.running[..BINS - 1];
        let bin: usize = sums.iter().map(|&sum| usize::from(sum <= at as u16)).sum();
        let [low, high] = self.range(bin);
        (
            bin,
            ((at - low) / (high - low)).clamp(0.0, 1.0 - 0.5 * f32::EPSILON),
        )
    }

    /// Probability of a bin.
    #[inline]
    pub fn share(&self, bin: usize) -> f32 {
        let [low, high] = self.range(bin);
        (high - low) * (1.0 / STEPS)
    }

    /// Share of all light that is seen.
    #[inline]
    pub fn seen(&self) -> f32 {
        f32::from(self.running[BINS - 1]) * (1.0 / STEPS)
    }
}

#[cfg(test)]
mod tests;
