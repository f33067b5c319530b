//! The integral through streaks, eight columns of a ray at a time, with the bits of the walk from one to the next.
//!
//! First come the ends of some columns, without a branch for which side a ray leaves them by, as no processor guesses
//! that; then what lies in them, in lanes; then their sum, in their order.

use super::{Axial, Axis, Shade, Streaks};
use crate::fiber::section::UnitRay;
use crate::math::lanes::{LANES, Merge, Row, Set, Wide, run_with};

/// Rows of columns that are found before they are looked into.
const ROWS: usize = 4;
/// Ways through fewer columns than this are gone sooner one by one.
const FEWEST: f64 = 4.0;

/// Columns along a ray. What is found in them takes the place of what they were found by, as memory that is new
/// costs time.
struct Columns {
    /// Where they begin along the ray; then what the density is multiplied by.
    begins: [Row; ROWS],
    /// Where they end, the last one maybe beyond the part; then how long the way through them is.
    ends: [Row; ROWS],
    /// Where they begin in the table, as bits; then where the density is. Those of several cells along the ray, or of
    /// one beyond the second period, are [`ALONE`] and stay as they are.
    places: [Row; ROWS],
    /// Where their cells begin.
    phases: [[f32; LANES]; ROWS],
    count: usize,
}

/// Added to a place, it is in no table.
const ALONE: u64 = 1 << 63;

/// A ray and the part of it that is asked for.
struct Part<'a> {
    ray: &'a UnitRay,
    t0: f64,
    t1: f64,
    shade: &'a Shade,
    axial: Axial<'a>,
}

/// A ray's way from column to column.
struct Way {
    /// Where it leaves columns along x and along y.
    ends: Merge,
    /// Where it came into its column.
    begin: f64,
    /// Where the column begins in the table, and how far it is to the next one along y and x.
    place: u32,
    steps: [u32; 2],
}

impl Streaks {
    /// See [`Streaks::integral`]. `None` for a part that leaves the table, or passes few columns.
    #[inline]
    pub(super) fn integral_in_lanes(
        &self,
        set: Set,
        ray: &UnitRay,
        part: (f64, f64),
        shade: &Shade,
    ) -> Option<f64> {
        run_with!(set, |simd| self.integral_by(simd, ray, part, shade))
    }

    #[inline(always)]
    fn integral_by<W: Wide>(
        &self,
        simd: W,
        ray: &UnitRay,
        (t0, t1): (f64, f64),
        shade: &Shade,
    ) -> Option<f64> {
        let [rate_x, rate_y] = [ray.dx * self.scale[0], ray.dy * self.scale[1]];
        let through = (t1 - t0) * (rate_x.abs() + rate_y.abs());
        if through < FEWEST {
            return None;
        }
        let [x, y] = self.axes(ray, t0);
        if !(self.holds(ray, t1, &x, 0) && self.holds(ray, t1, &y, 1)) {
            return None;
        }
        let part = Part {
            ray,
            t0,
            t1,
            shade,
            axial: Axial::new(self, ray, t0, t1),
        };
        let mut way = self.way(&x, &y, t0);
        let mut columns = Columns {
            begins: [Row::default(); ROWS],
            ends: [Row::default(); ROWS],
            places: [Row::default(); ROWS],
            phases: [[0.0; LANES]; ROWS],
            count: 0,
        };
        let mut sum = 0.0;
        loop {
            let last = way.go(&mut columns, &self.columns, t1)?;
            self.look(simd, &part, &mut columns);
            sum = self.add(sum, &part, &columns);
            if last {
                return Some(sum);
            }
        }
    }

    /// Whether a ray stays within the table along an axis, with a column to spare for rounding.
    #[inline(always)]
    fn holds(&self, ray: &UnitRay, t1: f64, axis: &Axis, k: usize) -> bool {
        let scale = self.scale[k];
        let (at, rate) = ([ray.x, ray.y][k] * scale, [ray.dx, ray.dy][k] * scale);
        let half = f64::from(self.size[k] / 2 - 1);
        let end = at + t1 * rate;
        axis.cell >= 1 && axis.cell < axis.last && end > -half && end < half
    }

    #[inline(always)]
    fn way(&self, x: &Axis, y: &Axis, t0: f64) -> Way {
        let stride = self.count + 1;
        let place = |x: i32, y: i32| (stride * (y * self.size[0] + x)) as u32;
        Way {
            ends: Merge::new([x.next, y.next], [x.delta, y.delta]),
            begin: t0,
            place: place(x.cell, y.cell),
            steps: [place(0, y.step), place(x.step, 0)],
        }
    }

    /// Finds what lies in columns.
    #[inline(always)]
    fn look<W: Wide>(&self, simd: W, part: &Part, columns: &mut Columns) {
        let (ray, shade, axial) = (part.ray, part.shade, &part.axial);
        let (t0, t1) = (simd.all(part.t0), simd.all(part.t1));
        let (zero, one) = (simd.all(0.0), simd.all_bits(1));
        let count = simd.all_bits(self.count as u64);
        for row in 0..columns.rows() {
            let begin = simd.load(&columns.begins[row]).min(t1).max(t0);
            let end = simd.load(&columns.ends[row]).min(t1).max(t0);
            let z = axial.z + simd.widened(&columns.phases[row]);
            let k = (z + begin * axial.dz).whole();
            let same = k.is((z + end * axial.dz).whole());
            let k = k.or(k.lt(count), k.minus(count));
            let simple = same & k.lt(count);

            let middle = 0.5 * (begin + end);
            let rho2 = ray.c + middle * (2.0 * ray.b + middle * ray.a);
            let rho = rho2.max(simd.all(shade.ratio * shade.ratio)).sqrt();
            let density = (shade.lean.base - shade.lean.rise * rho).max(zero);
            let density = density.or(rho.lt(simd.all(shade.lean.rim)), zero);

            let place = simd.load(&columns.places[row]).bits();
            let alone = place.plus(simd.all_bits(ALONE));
            let cell = place.plus(one).plus(k).or(simple, alone);
            columns.places[row] = cell.numbers().row();
            columns.begins[row] = density.or(simple, begin).row();
            columns.ends[row] = (end - begin).or(simple, end).row();
        }
    }

    /// Adds what lies in columns to a sum.
    #[inline(always)]
    fn add(&self, mut sum: f64, part: &Part, columns: &Columns) -> f64 {
        let table = &self.columns[..];
        for row in 0..columns.rows() {
            let rows = (
                &columns.places[row],
                &columns.begins[row],
                &columns.ends[row],
            );
            for lane in 0..LANES.min(columns.count - row * LANES) {
                let place = rows.0.0[lane].to_bits();
                let (begin, end) = (rows.1.0[lane], rows.2.0[lane]);
                sum = match table.get(place as usize) {
                    Some(&streak) => sum + f64::from(streak) * begin * end,
                    None => part.add(sum, (place & !ALONE) as usize, (begin, end)),
                }
            }
        }
        sum
    }
}

impl Part<'_> {
    /// Adds what lies in a column to a sum, cell by cell. Apart, so that the sum elsewhere stays in a register.
    #[inline(never)]
    fn add(&self, mut sum: f64, place: usize, (begin, end): (f64, f64)) -> f64 {
        if begin < end {
            self.axial.walk(place, begin, end, &mut |streak, t0, t1| {
                sum += streak * self.shade.at(self.ray, 0.5 * (t0 + t1)) * (t1 - t0);
            });
        }
        sum
    }
}

impl Columns {
    /// Rows in use.
    #[inline(always)]
    fn rows(&self) -> usize {
        self.count.div_ceil(LANES).min(ROWS)
    }
}

impl Way {
    /// Finds the next columns, up to `t1`; whether they are the last ones. `None` where it leaves the table.
    #[inline(always)]
    fn go(&mut self, columns: &mut Columns, table: &[f32], t1: f64) -> Option<bool> {
        for row in 0..ROWS {
            for lane in 0..LANES {
                let (end, along_x) = self.ends.pop();
                columns.begins[row].0[lane] = self.begin;
                columns.ends[row].0[lane] = end;
                columns.places[row].0[lane] = f64::from_bits(u64::from(self.place));
                columns.phases[row][lane] = *table.get(self.place as usize)?;
                if end >= t1 {
                    columns.count = row * LANES + lane + 1;
                    return Some(true);
                }
                self.begin = end;
                self.place = self.place.wrapping_add(self.steps[along_x]);
            }
        }
        columns.count = ROWS * LANES;
        Some(false)
    }
}

#[cfg(test)]
mod tests;
