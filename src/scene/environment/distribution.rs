//! Choice of texels by weight, exact and near in memory.
//!
//! Texels are gathered in cells of [`CELL`] by [`CELL`]. A cell is chosen by rows and columns of cells,
//! whose sums stay in the processor's cache, then a texel by rows and columns of the cell, which lie
//! together. Every choice is an inversion, so that well-spread numbers give well-spread directions.

use rayon::prelude::*;

/// Side of a cell, texels.
const CELL: usize = 8;

/// Cumulative shares of the texels of one cell. Rows and columns beyond the picture have none.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Cell {
    rows: [f64; CELL],
    /// Along each row.
    columns: [[f64; CELL]; CELL],
}

/// A distribution over the texels of a picture.
#[derive(Clone, Debug)]
pub(super) struct Distribution {
    across: usize,
    /// Share of all weight in rows of cells up to and including this one.
    rows: Vec<f64>,
    /// The same along each row of cells.
    columns: Vec<f64>,
    cells: Vec<Cell>,
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
        let (cells, sums): (Vec<Cell>, Vec<f64>) = (0..across * down)
            .into_par_iter()
            .map(|i| {
                let (x0, y0) = (i % across * CELL, i / across * CELL);
                let mut columns = [[0.0; CELL]; CELL];
                let mut rows = [0.0; CELL];
                for (y, (row, sum)) in columns.iter_mut().zip(&mut rows).enumerate() {
                    for (x, share) in row.iter_mut().enumerate() {
                        let inside = x0 + x < width && y0 + y < height;
                        *share = if inside { weight(x0 + x, y0 + y) } else { 0.0 };
                    }
                    *sum = accumulate(row);
                }
                let sum = accumulate(&mut rows);
                (Cell { rows, columns }, sum)
            })
            .unzip();
        let mut columns = sums;
        let mut rows: Vec<f64> = columns.chunks_exact_mut(across).map(accumulate).collect();
        let total = accumulate(&mut rows);
        Self {
            across,
            rows,
            columns,
            cells,
            total,
        }
    }

    /// The sum of all weights.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// Column and row of a texel and the place in it, 0..1 each, from two numbers in `[0, 1)`: texels are
    /// drawn in proportion to their weights. Of no meaning where the total is zero.
    pub(super) fn sample(&self, u: [f32; 2]) -> ([usize; 2], [f64; 2]) {
        let (row, v) = choose(&self.rows, f64::from(u[1]));
        let columns = &self.columns[row * self.across..(row + 1) * self.across];
        let (column, s) = choose(columns, f64::from(u[0]));
        let cell = &self.cells[row * self.across + column];
        let (y, v) = choose(&cell.rows, v);
        let (x, s) = choose(&cell.columns[y], s);
        ([column * CELL + x, row * CELL + y], [s, v])
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
                let ([x, y], place) = chosen.sample([u[0], u[1]]);
                assert!(place.iter().all(|p| (0.0..1.0).contains(p)));
                seen[y * width + x] += chosen.total() / f64::from(n);
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
