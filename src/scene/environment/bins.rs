//! An environment's light in few bins, for what is known of light by direction only roughly.

/// Most bins: what a place knows of all of them is two lines of a cache.
pub const BINS: usize = 64;

/// Rectangles of cells of the picture. Bins are split while there are fewer than [`BINS`], always the one with most
/// light times size, into halves of about the same light.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    /// Bin of each cell.
    of_cell: Vec<u8>,
    /// Share of all light of each bin that has any.
    shares: Vec<f32>,
    /// Cells with light by bins, and running shares of their bin's light.
    cells: Vec<u32>,
    running: Vec<f32>,
    /// For as many numbers in `[0, 1)` as a bin has cells, evenly spaced, the place of the cell that each chooses, less one so that
    /// rounding does no harm.
    guide: Vec<u32>,
    /// First of `cells` of each bin, and their number.
    first: Vec<u32>,
}

/// Columns and rows from the first to before the second.
#[derive(Clone, Copy)]
struct Rectangle {
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Rectangle {
    fn cells(self, across: usize) -> impl Iterator<Item = usize> {
        let [left, right] = self.columns;
        (self.rows[0]..self.rows[1]).flat_map(move |y| (left..right).map(move |x| y * across + x))
    }

    /// Width and height on the sphere, half turns.
    fn size(self, across: usize, down: usize) -> [f64; 2] {
        let middle = 0.5 * (self.rows[0] + self.rows[1]) as f64 / down as f64;
        let around = (middle * std::f64::consts::PI).sin();
        let part = |[from, to]: [usize; 2], of: usize| (to - from) as f64 / of as f64;
        [
            2.0 * around * part(self.columns, across),
            part(self.rows, down),
        ]
    }

    /// In two of about the same light, across its longer side; `None` if it is one cell.
    fn halves(self, across: usize, down: usize, power: &[f64]) -> Option<[Self; 2]> {
        let [width, height] = self.size(across, down);
        let is_single = |[from, to]: [usize; 2]| to - from == 1;
        let by_columns = match (is_single(self.columns), is_single(self.rows)) {
            (true, true) => return None,
            (false, false) => width >= height,
            (columns, _) => !columns,
        };
        let [from, to] = if by_columns { self.columns } else { self.rows };
        let mut lines = vec![0.0; to - from];
        for cell in self.cells(across) {
            let line = if by_columns {
                cell % across
            } else {
                cell / across
            };
            lines[line - from] += power[cell];
        }
        let all: f64 = lines.iter().sum();
        let mut before = 0.0;
        let unevenness = |at: usize| {
            before += lines[at - 1 - from];
            (at, (2.0 * before - all).abs())
        };
        let cuts = (from + 1..to).map(unevenness);
        let (even, _) = cuts.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let part = |range| match by_columns {
            true => Self {
                columns: range,
                ..self
            },
            false => Self {
                rows: range,
                ..self
            },
        };
        Some([part([from, even]), part([even, to])])
    }
}

impl Bins {
    /// * `power`: light of each of `across` times some rows of cells, >= 0.
    pub(super) fn new(across: usize, power: &[f64]) -> Self {
        let down = power.len() / across;
        let light = |r: Rectangle| r.cells(across).map(|c| power[c]).sum::<f64>();
        let whole = Rectangle {
            columns: [0, across],
            rows: [0, down],
        };
        let total = light(whole);
        let mut bins = vec![(whole, total)];
        while bins.len() < BINS {
            let worth = |&(r, power): &(Rectangle, f64)| {
                let [width, height] = r.size(across, down);
                let is_single = r.cells(across).nth(1).is_none();
                if is_single {
                    0.0
                } else {
                    power * width.hypot(height)
                }
            };
            let worths = bins.iter().map(worth).enumerate();
            let Some((widest, most)) = worths.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            let halves = bins[widest].0.halves(across, down, power);
            let Some(halves) = halves.filter(|_| most > 0.0) else {
                break;
            };
            bins.swap_remove(widest);
            bins.extend(halves.map(|half| (half, light(half))));
        }
        bins.retain(|&(_, power)| power > 0.0);
        let mut out = Self {
            of_cell: vec![0; power.len()],
            shares: bins
                .iter()
                .map(|&(_, power)| (power / total) as f32)
                .collect(),
            cells: Vec::new(),
            running: Vec::new(),
            guide: Vec::new(),
            first: vec![0],
        };
        for (bin, &(rectangle, all)) in bins.iter().enumerate() {
            let mut sum = 0.0;
            for cell in rectangle.cells(across) {
                out.of_cell[cell] = bin as u8;
                if power[cell] > 0.0 {
                    sum += power[cell];
                    out.cells.push(cell as u32);
                    out.running.push((sum / all) as f32);
                }
            }
            let running = &out.running[out.guide.len()..];
            out.guide.extend((0..running.len()).map(|i| {
                let u = i as f32 / running.len() as f32;
                running.partition_point(|&sum| sum <= u).saturating_sub(1) as u32
            }));
            out.first.push(out.cells.len() as u32);
        }
        out
    }

    /// Share of all light of each bin, > 0.
    pub(super) fn shares(&self) -> &[f32] {
        &self.shares
    }

    /// The bin of a cell that has light.
    #[inline]
    pub(super) fn of_cell(&self, cell: usize) -> usize {
        self.of_cell[cell].into()
    }

    /// A cell of a bin by its light from a number in `[0, 1)`, and what is left of the number.
    #[inline]
    pub(super) fn cell(&self, bin: usize, u: f32) -> (usize, f32) {
        let range = self.first[bin] as usize..self.first[bin + 1] as usize;
        let running = &self.running[range.clone()];
        let last = running.len() - 1;
        let near = ((u * running.len() as f32) as usize).min(last);
        let mut i = self.guide[range.start + near] as usize;
        while i < last && running[i] <= u {
            i += 1;
        }
        let low = if i == 0 { 0.0 } else { running[i - 1] };
        let rest = (u - low) / (running[i] - low).max(f32::MIN_POSITIVE);
        (
            self.cells[range.start + i] as usize,
            rest.clamp(0.0, 1.0 - 0.5 * f32::EPSILON),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    /// Every cell with light is in one bin, bins have the light of their cells, and cells come as often as they have light.
    #[test]
    fn bins_hold_all_light() {
        let mut rng = Rng::new(3, 0);
        let across = 12;
        let power: Vec<f64> = (0..12 * 7)
            .map(|i| {
                if i % 3 == 0 {
                    0.0
                } else {
                    f64::from(rng.uniform_f32()).powi(6)
                }
            })
            .collect();
        let total: f64 = power.iter().sum();
        let bins = Bins::new(across, &power);
        assert!(bins.shares.len() <= BINS && bins.shares.len() > BINS / 2);
        for (bin, &share) in bins.shares.iter().enumerate() {
            let inside = (0..power.len()).filter(|&c| power[c] > 0.0 && bins.of_cell(c) == bin);
            let light: f64 = inside.map(|c| power[c]).sum();
            assert!((light / total - f64::from(share)).abs() < 1e-6);
        }
        let (mut seen, n) = (vec![0.0; power.len()], 1 << 16);
        for i in 0..n {
            for (bin, &share) in bins.shares.iter().enumerate() {
                let (cell, rest) = bins.cell(bin, (i as f32 + 0.5) / n as f32);
                assert!(bins.of_cell(cell) == bin && (0.0..1.0).contains(&rest));
                seen[cell] += f64::from(share) / f64::from(n);
            }
        }
        for (seen, power) in seen.iter().zip(&power) {
            assert!((seen - power / total).abs() < 1e-5, "{seen} {power}");
        }
    }

    #[test]
    fn the_dark_has_no_bins() {
        assert!(Bins::new(2, &[0.0; 4]).shares().is_empty());
        assert_eq!(Bins::new(1, &[2.0]).shares(), [1.0]);
    }
}
