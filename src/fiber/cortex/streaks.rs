//! Pigment in streaks: cells slender along the axis, each with a density of its own.

#[cfg(target_arch = "x86_64")]
mod lanes;

use super::Lean;
use crate::fiber::section::{UnitRay, floor, smaller};
#[cfg(target_arch = "x86_64")]
use crate::math::lanes::Set;
use crate::sampling::{Rng, hash64};

/// Width of a streak, micrometers: some granules side by side.
const STREAK_UM: f64 = 1.5;
/// Mean length of a streak, micrometers; reported as dots and dashes of 10 to 40.
const STREAK_LENGTH_UM: f64 = 25.0;

/// Columns beyond the outermost ones, which these go on into: scales may stand out a little.
const MARGIN: i32 = 2;

/// Density in cells that are slender along z: a log-normal number a cell, drawn beforehand, for a ray
/// passes dozens. Cells stand in square columns; in each they begin at a height of its own.
#[derive(Clone, Debug)]
pub(super) struct Streaks {
    /// Columns per unit of the unit-circle frame.
    scale: [f64; 2],
    /// Columns along x and y.
    size: [i32; 2],
    /// Cells of a column in one period, and their number per micrometer.
    count: i32,
    per_um: f64,
    /// Column by column, where its cells begin, in cells, and the density of each; the mean of these is 1.
    columns: Vec<f32>,
    #[cfg(target_arch = "x86_64")]
    set: Option<Set>,
}

/// What the density of a streak is multiplied by.
#[derive(Clone, Copy)]
pub(super) struct Shade {
    pub(super) lean: Lean,
    /// Radius within which it is that at this radius.
    pub(super) ratio: f64,
}

impl Shade {
    /// At a place of a ray.
    #[inline]
    pub(super) fn at(&self, ray: &UnitRay, t: f64) -> f64 {
        let rho2 = ray.c + t * (2.0 * ray.b + t * ray.a);
        self.lean.density(rho2.max(self.ratio * self.ratio).sqrt())
    }
}

impl Streaks {
    /// * `sigma`: standard deviation of the density's logarithm.
    /// * `semi`: semi-axes of the section, micrometers; `reach`: its largest radius in their units.
    pub(super) fn new(sigma: f64, semi: [f64; 2], reach: f64, period: f64, seed: u64) -> Self {
        let mut levels = [0.0; 256];
        for (k, level) in levels.iter_mut().enumerate() {
            let (normal, _) = Rng::new(seed ^ 0x57ea_0000, k as u64).normal_pair();
            *level = (sigma * normal).exp();
        }
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;

        let seed = hash64(seed ^ 0x57ea_4c00);
        let scale = semi.map(|s| s / STREAK_UM);
        let half = scale.map(|s| (s * reach) as i32 + 1);
        let count = (period / STREAK_LENGTH_UM).round().max(1.0) as i32;
        let mut columns = Vec::new();
        for y in -half[1] - MARGIN..half[1] + MARGIN {
            let y = y.clamp(-half[1], half[1] - 1);
            for x in -half[0] - MARGIN..half[0] + MARGIN {
                let x = x.clamp(-half[0], half[0] - 1);
                let key = hash64(seed ^ i64::from(x) as u64 ^ ((i64::from(y) as u64) << 32));
                columns.push((key >> 40) as f32 / (1u32 << 24) as f32);
                columns.extend((0..count).map(|k| {
                    let draw = hash64(key ^ i64::from(k) as u64) & 255;
                    (levels[draw as usize] / mean) as f32
                }));
            }
        }
        Self {
            scale,
            size: half.map(|h| 2 * (h + MARGIN)),
            count,
            per_um: f64::from(count) / period,
            columns,
            #[cfg(target_arch = "x86_64")]
            set: Set::detect(),
        }
    }

    /// The integral of the shaded density along a ray.
    pub(super) fn integral(&self, ray: &UnitRay, t0: f64, t1: f64, shade: &Shade) -> f64 {
        #[cfg(target_arch = "x86_64")]
        if let Some(sum) = self
            .set
            .and_then(|set| self.integral_in_lanes(set, ray, (t0, t1), shade))
        {
            return sum;
        }
        self.integral_by_walk(ray, t0, t1, shade)
    }

    /// The same on any processor.
    fn integral_by_walk(&self, ray: &UnitRay, t0: f64, t1: f64, shade: &Shade) -> f64 {
        let mut sum = 0.0;
        self.walk(ray, t0, t1, |streak, t0, t1| {
            sum += streak * shade.at(ray, 0.5 * (t0 + t1)) * (t1 - t0);
        });
        sum
    }

    /// Visits the cells along a ray: density, begin and end.
    #[inline]
    pub(super) fn walk(
        &self,
        ray: &UnitRay,
        t0: f64,
        t1: f64,
        mut visit: impl FnMut(f64, f64, f64),
    ) {
        let [mut x, mut y] = self.axes(ray, t0);
        let axial = Axial::new(self, ray, t0, t1);
        let mut t = t0;
        while t < t1 {
            let column = y.index() * self.size[0] + x.index();
            let end = smaller(smaller(x.next, y.next), t1);
            if end > t {
                axial.walk(self.place(column), t, end, &mut visit);
                t = end;
            }
            if x.next <= y.next {
                x.advance();
            } else {
                y.advance();
            }
        }
    }

    /// A ray's ways along x and y from `t0` on.
    #[inline]
    fn axes(&self, ray: &UnitRay, t0: f64) -> [Axis; 2] {
        let [a, b] = self.scale;
        [
            Axis::new(ray.x * a, ray.dx * a, t0, self.size[0]),
            Axis::new(ray.y * b, ray.dy * b, t0, self.size[1]),
        ]
    }

    /// Where a column begins.
    #[inline]
    fn place(&self, column: i32) -> usize {
        (column * (self.count + 1)) as usize
    }
}

/// A ray's way through the columns along one axis.
struct Axis {
    cell: i32,
    last: i32,
    step: i32,
    /// Where the ray leaves the cell, and the way between two such places.
    next: f64,
    delta: f64,
}

impl Axis {
    #[inline]
    fn new(at: f64, rate: f64, t0: f64, size: i32) -> Self {
        let cell = floor(at + t0 * rate);
        let (mut next, mut delta) = (f64::INFINITY, f64::INFINITY);
        if rate != 0.0 {
            let inverse = 1.0 / rate;
            next = (cell + f64::from(u8::from(rate > 0.0)) - at) * inverse;
            delta = inverse.abs();
        }
        Self {
            cell: cell as i32 + size / 2,
            last: size - 1,
            step: if rate > 0.0 { 1 } else { -1 },
            next,
            delta,
        }
    }

    /// Beyond the outermost columns these go on.
    #[inline]
    fn index(&self) -> i32 {
        self.cell.clamp(0, self.last)
    }

    #[inline]
    fn advance(&mut self) {
        self.cell += self.step;
        self.next += self.delta;
    }
}

/// A ray's height in cells: `z + t dz`, never negative where it is asked for, so that the number of
/// the cell is the whole part.
struct Axial<'a> {
    streaks: &'a Streaks,
    z: f64,
    dz: f64,
}

impl<'a> Axial<'a> {
    #[inline]
    fn new(streaks: &'a Streaks, ray: &UnitRay, t0: f64, t1: f64) -> Self {
        let (z, count) = (ray.z * streaks.per_um, f64::from(streaks.count));
        let dz = ray.dz * streaks.per_um;
        // The lowest place in the first period, where most of the way then is.
        let lowest = z + smaller(t0 * dz, t1 * dz);
        Self {
            streaks,
            z: z - count * floor(lowest / count),
            dz,
        }
    }

    /// * `place`: where the column begins.
    #[inline]
    fn walk(&self, place: usize, t0: f64, t1: f64, visit: &mut impl FnMut(f64, f64, f64)) {
        // Rounding may leave it a little below 0, which truncation takes for 0.
        let z = self.z + f64::from(self.streaks.columns[place]);
        let (k, last) = ((z + t0 * self.dz) as i32, (z + t1 * self.dz) as i32);
        if k == last {
            visit(self.density(place, k), t0, t1);
        } else {
            self.climb(place, (k, last), (t0, t1), visit);
        }
    }

    /// More than one cell of a column, which is rare: columns are slender.
    fn climb(
        &self,
        place: usize,
        (mut k, last): (i32, i32),
        (mut t, t1): (f64, f64),
        visit: &mut impl FnMut(f64, f64, f64),
    ) {
        let z = self.z + f64::from(self.streaks.columns[place]);
        while k != last {
            let (edge, next) = if last > k { (k + 1, k + 1) } else { (k, k - 1) };
            let end = ((f64::from(edge) - z) / self.dz).clamp(t, t1);
            visit(self.density(place, k), t, end);
            (t, k) = (end, next);
        }
        visit(self.density(place, k), t, t1);
    }

    #[inline]
    fn density(&self, place: usize, mut k: i32) -> f64 {
        let count = self.streaks.count;
        if k >= count {
            k %= count;
        }
        f64::from(self.streaks.columns[place + 1 + k as usize])
    }
}
