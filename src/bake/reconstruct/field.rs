//! Values on a lattice and on half as many cells.

use crate::math::widest;

/// Kernel of one step to half as many cells.
pub(super) const TAPS: [f32; 4] = [0.125, 0.375, 0.375, 0.125];

/// Values on a lattice, azimuth running fastest.
#[derive(Clone, Debug)]
pub(super) struct Field<const N: usize> {
    pub(super) size: [usize; 3],
    pub(super) values: Vec<[f32; N]>,
}

/// Values that do not depend on azimuth.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    size: [usize; 2],
    pub(super) values: Vec<f32>,
}

/// Memory of fields that are done with: pages that the system has given already cost nothing more.
#[derive(Debug, Default)]
pub(super) struct Pool<const N: usize>(Vec<Vec<[f32; N]>>);

impl<const N: usize> Pool<N> {
    /// A field of zeros.
    pub(super) fn field(&mut self, size: [usize; 3]) -> Field<N> {
        let mut values = self.0.pop().unwrap_or_default();
        values.clear();
        values.resize(size.iter().product(), [0.0; N]);
        Field { size, values }
    }

    pub(super) fn give(&mut self, field: Field<N>) {
        self.0.push(field.values);
    }
}

impl Plane {
    pub(super) fn new(nx: usize, ny: usize) -> Self {
        Self {
            size: [nx, ny],
            values: vec![0.0; nx * ny],
        }
    }

    pub(super) fn reduced(&self, axis: usize) -> Self {
        let mut size = self.size;
        size[axis] /= 2;
        let mut out = Self::new(size[0], size[1]);
        for x in 0..size[0] {
            for y in 0..size[1] {
                let sum = taps([x, y][axis], self.size[axis], axis)
                    .map(|(at, k)| k * self.values[row(self.size[1], axis, x, y, at)])
                    .sum();
                out.values[x * size[1] + y] = sum;
            }
        }
        out
    }
}

/// The row that has `at` in place of its coordinate along `axis`.
#[inline(always)]
fn row(ny: usize, axis: usize, x: usize, y: usize, at: usize) -> usize {
    let [x, y] = if axis == 0 { [at, y] } else { [x, at] };
    x * ny + y
}

/// Cells and weights that make cell `i` of half as many. Even at `y = 0`; elsewhere nothing is beyond.
#[inline(always)]
fn taps(i: usize, len: usize, axis: usize) -> impl Iterator<Item = (usize, f32)> {
    TAPS.into_iter().enumerate().filter_map(move |(tap, k)| {
        let at = match (2 * i + tap).checked_sub(1) {
            None if axis == 1 => 0,
            None => return None,
            Some(at) => at,
        };
        (at < len).then_some((at, k))
    })
}

impl<const N: usize> Field<N> {
    pub(super) fn new(size: [usize; 3]) -> Self {
        Self {
            size,
            values: vec![[0.0; N]; size.iter().product()],
        }
    }

    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &[[f32; N]] {
        &self.values[row * self.size[2]..][..self.size[2]]
    }

    /// Half as many cells along x or y: sums of taps, or means by weights.
    pub(super) fn reduced(&self, axis: usize, weights: Option<&Plane>, pool: &mut Pool<N>) -> Self {
        let mut size = self.size;
        size[axis] /= 2;
        let mut out = pool.field(size);
        widest(
            #[inline(always)]
            || self.reduce(axis, weights, &mut out),
        );
        out
    }

    #[inline(always)]
    fn reduce(&self, axis: usize, weights: Option<&Plane>, out: &mut Self) {
        let [_, ny, np] = out.size;
        for (to_row, to) in out.values.chunks_exact_mut(np).enumerate() {
            let (x, y) = (to_row / ny, to_row % ny);
            let mut all = 0.0;
            for (at, k) in taps([x, y][axis], self.size[axis], axis) {
                let from = row(self.size[1], axis, x, y, at);
                let k = weights.map_or(k, |weights| k * weights.values[from]);
                if k > 0.0 {
                    all += k;
                    add(to, k, self.row(from));
                }
            }
            if weights.is_some() && all > 0.0 {
                to.as_flattened_mut().iter_mut().for_each(|v| *v /= all);
            }
        }
    }

    /// Adds `sign` times a field of half as many cells along x or y, linear between centers.
    ///
    /// * `inside`: rows of this field that count, and of the coarse one.
    pub(super) fn add_coarse(
        &mut self,
        axis: usize,
        sign: f32,
        coarse: &Self,
        inside: Option<[&Plane; 2]>,
    ) {
        widest(
            #[inline(always)]
            || self.add_coarse_rows(axis, sign, coarse, inside),
        );
    }

    #[inline(always)]
    fn add_coarse_rows(
        &mut self,
        axis: usize,
        sign: f32,
        coarse: &Self,
        inside: Option<[&Plane; 2]>,
    ) {
        let [_, ny, np] = self.size;
        let [_, coarse_ny, _] = coarse.size;
        for (row, to) in self.values.chunks_exact_mut(np).enumerate() {
            if inside.is_some_and(|[fine, _]| fine.values[row] <= 0.0) {
                continue;
            }
            let mut at = [row / ny, row % ny];
            let odd = at[axis] % 2 == 1;
            at[axis] /= 2;
            let near = at[0] * coarse_ny + at[1];
            let next = match odd {
                true => Some(at[axis] + 1).filter(|i| *i < coarse.size[axis]),
                false => at[axis].checked_sub(1),
            };
            let next = next.map_or(near, |i| {
                at[axis] = i;
                at[0] * coarse_ny + at[1]
            });
            let outside = inside.is_some_and(|[_, coarse]| coarse.values[next] <= 0.0);
            let next = if outside { near } else { next };
            let (near, next) = (coarse.row(near), coarse.row(next));
            let (a, b) = (0.75 * sign, 0.25 * sign);
            let from = near.as_flattened().iter().zip(next.as_flattened());
            for (to, (near, next)) in to.as_flattened_mut().iter_mut().zip(from) {
                *to = (*to + a * near) + b * next;
            }
        }
    }

    /// Divides by what does not depend on azimuth; nothing where that is nothing.
    pub(super) fn divide(&mut self, by: &Plane) {
        let np = self.size[2];
        for (row, by) in self.values.chunks_exact_mut(np).zip(&by.values) {
            let scale = if *by > 0.0 { 1.0 / by } else { 0.0 };
            row.as_flattened_mut().iter_mut().for_each(|v| *v *= scale);
        }
    }

    /// One of the values of every cell.
    pub(super) fn lane(&self, lane: usize) -> Field<1> {
        Field {
            size: self.size,
            values: self.values.iter().map(|v| [v[lane]]).collect(),
        }
    }
}

#[inline(always)]
fn add<const N: usize>(to: &mut [[f32; N]], k: f32, from: &[[f32; N]]) {
    let pairs = to.as_flattened_mut().iter_mut().zip(from.as_flattened());
    for (to, from) in pairs {
        *to += k * from;
    }
}
