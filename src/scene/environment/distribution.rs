//! Choice of texels by weight, exact and near in memory.
//!
//! Texels are gathered in cells of [`CELL`] by [`CELL`]. A cell is chosen by rows and columns of cells, then
//! a row of the cell, by sums that stay in the processor's cache; then a texel of the row by the
//! texels themselves, which the caller reads in any case. Every choice is an inversion, so that well-spread
//! numbers give well-spread directions. Within a cell single precision is more than is left of the 24
//! bits of a number once its cell is chosen.

use crate::pages::Table;
use rayon::prelude::*;

/// Side of a cell, texels.
pub(super) const CELL: usize = 8;

/// A distribution over the texels of a picture.
#[derive(Clone, Debug)]
pub(super) struct Distribution {
    across: usize,
    /// Share of all weight in rows of cells up to and including this one.
    rows: Vec<f64>,
    /// The same along each row of cells.
    columns: Vec<f64>,
    /// The same of the rows of each cell; those beyond the picture have none.
    cells: Table<[f32; CELL]>,
    total: f64,
}

impl Distribution {
    /// * `weight`: of a texel by column and row, >= 0.
    pub(super) fn new(
        width: usize,
        height: usize,
        weight: impl Fn(usize, usize) -> f64 + Sync,
    ) -> Self {
        let (across, down) = (width.div_ceil(CELL), height.div_ceil(CELL));
        let (cells, sums): (Vec<[f32; CELL]>, Vec<f64>) = (0..across * down)
            .into_par_iter()
            .map(|i| {
                let (x0, y0) = (i % across * CELL, i / across * CELL);
                let columns = x0..(x0 + CELL).min(width);
                let mut rows = [0.0; CELL];
                for (y, sum) in (y0..height).zip(&mut rows) {
                    *sum = columns.clone().map(|x| weight(x, y)).sum();
                }
                let sum = accumulate(&mut rows);
                (rows.map(|share| share as f32), sum)
            })
            .unzip();
        let mut columns = sums;
        let mut rows: Vec<f64> = columns.chunks_exact_mut(across).map(accumulate).collect();
        let total = accumulate(&mut rows);
        Self {
            across,
            rows,
            columns,
            cells: Table::new(cells),
            total,
        }
    }

    /// The sum of all weights.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// Cells in a row.
    pub(super) fn across(&self) -> usize {
        self.across
    }

    /// Share of all weight of each cell, in rows.
    pub(super) fn shares(&self) -> Vec<f64> {
        let share = |sums: &[f64], i: usize| sums[i] - if i == 0 { 0.0 } else { sums[i - 1] };
        (self.columns.chunks_exact(self.across).enumerate())
            .flat_map(|(y, columns)| {
                let row = share(&self.rows, y);
                (0..self.across).map(move |x| row * share(columns, x))
            })
            .collect()
    }

    /// A cell by its weight from two numbers in `[0, 1)`, and what is left of them.
    #[inline]
    pub(super) fn cell(&self, u: [f32; 2]) -> (usize, [f32; 2]) {
        let (row, v) = choose(&self.rows, f64::from(u[1]));
        let columns = &self.columns[row * self.across..(row + 1) * self.across];
        let (column, s) = choose(columns, f64::from(u[0]));
        (row * self.across + column, [s as f32, v as f32])
    }

    /// A row of a cell by its weight.
    #[inline]
    pub(super) fn row(&self, cell: usize, [s, v]: [f32; 2]) -> Row {
        let (y, v) = choose_near(&self.cells[cell], v);
        Row {
            column: cell % self.across * CELL,
            row: cell / self.across * CELL + y,
            rest: [s, v],
        }
    }
}

/// [`CELL`] texels of which one is about to be chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Of the first of them.
    pub(super) column: usize,
    pub(super) row: usize,
    /// Numbers in `[0, 1)`: for the texel, and the place from top to bottom.
    rest: [f32; 2],
}

impl Row {
    /// Column of a texel by its weight, and the place in it, 0..1 each. Of no meaning where all weights are zero.
    ///
    /// * `weights`: of its texels, to any one factor, 0 beyond the picture.
    #[inline]
    pub(super) fn texel(&self, mut weights: [f32; CELL]) -> (usize, [f32; 2]) {
        for i in 1..CELL {
            weights[i] += weights[i - 1];
        }
        let [s, v] = self.rest;
        let (x, s) = choose_near(&weights, s * weights[CELL - 1]);
        (self.column + x, [s, v])
    }
}

/// Makes running shares of the total, which is returned.
fn accumulate(weights: &mut [f64]) -> f64 {
    let mut sum = 0.0;
    for w in weights.iter_mut() {
        sum += *w;
        *w = sum;
    }
    for w in weights {
        *w /= sum.max(f64::MIN_POSITIVE);
    }
    sum
}

/// The interval of a cumulative distribution that holds `u`, and the place of `u` in it.
#[inline]
fn choose(cumulative: &[f64], u: f64) -> (usize, f64) {
    let mut i = cumulative.partition_point(|&c| c <= u);
    if i == cumulative.len() {
        // Rounding has carried `u` past the end: back to the last interval that is not empty.
        i = cumulative.len() - 1;
        while i > 0 && cumulative[i - 1] >= cumulative[i] {
            i -= 1;
        }
    }
    let low = if i == 0 { 0.0 } else { cumulative[i - 1] };
    let width = cumulative[i] - low;
    let place = if width > 0.0 { (u - low) / width } else { 0.5 };
    (i, place.clamp(0.0, 1.0 - 1e-9))
}

/// The same for the few of a cell, without a search.
#[inline(always)]
fn choose_near(cumulative: &[f32; CELL], u: f32) -> (usize, f32) {
    let mut i: usize = cumulative.iter().map(|&c| usize::from(c <= u)).sum();
    if i == CELL {
        i = CELL - 1;
        while i > 0 && cumulative[i - 1] >= cumulative[i] {
            i -= 1;
        }
    }
    let low = if i == 0 { 0.0 } else { cumulative[i - 1] };
    let width = cumulative[i] - low;
    let place = if width > 0.0 { (u - low) / width } else { 0.5 };
    (i, place.clamp(0.0, 1.0 - 0.5 * f32::EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sobol;

    /// Sizes that are no multiples of a cell; weights that are zero in places.
    #[test]
    fn texels_come_as_often_as_they_weigh() {
        for (width, height) in [(1, 1), (5, 3), (24, 13), (64, 32)] {
            let weight = |x: usize, y: usize| ((x * 7 + y * 13) % 5) as f64 + f64::from(x == y);
            let chosen = Distribution::new(width, height, weight);
            let mut seen = vec![0.0; width * height];
            let (net, n) = (Sobol::new(2), 1 << 21);
            for i in 0..n {
                let u = net.point(i);
                let (cell, rest) = chosen.cell([u[0], u[1]]);
                let row = chosen.row(cell, rest);
                let (x, place) = row.texel(std::array::from_fn(|i| match row.column + i < width {
                    true => weight(row.column + i, row.row) as f32,
                    false => 0.0,
                }));
                assert!(place.iter().all(|p| (0.0..1.0).contains(p)));
                seen[row.row * width + x] += chosen.total() / f64::from(n);
            }
            for (i, seen) in seen.iter().enumerate() {
                let w = weight(i % width, i / width);
                assert!(
                    (seen - w).abs() < 0.1 * w.max(0.1),
                    "{i}: {seen} is not {w}"
                );
                assert!(w > 0.0 || *seen == 0.0);
            }
        }
    }
}
