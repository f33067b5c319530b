//! Values on a lattice and on half as many cells.

/// Kernel of one step to half as many cells.
const TAPS: [f32; 4] = [0.125, 0.375, 0.375, 0.125];

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
                    .map(|(at, k)| k * self.values[self.row(axis, x, y, at)])
                    .sum();
                out.values[x * size[1] + y] = sum;
            }
        }
        out
    }

    /// The row that has `at` in place of its coordinate along `axis`.
    pub(super) fn row(&self, axis: usize, x: usize, y: usize, at: usize) -> usize {
        let [x, y] = if axis == 0 { [at, y] } else { [x, at] };
        x * self.size[1] + y
    }
}

/// Cells and weights that make cell `i` of half as many. Even at `y = 0`; elsewhere nothing is beyond.
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

    pub(super) fn row(&self, row: usize) -> &[[f32; N]] {
        &self.values[row * self.size[2]..][..self.size[2]]
    }

    /// Half as many cells along x or y: sums of taps, or means by weights.
    pub(super) fn reduced(&self, axis: usize, weights: Option<&Plane>) -> Self {
        let mut size = self.size;
        size[axis] /= 2;
        let mut out = Self::new(size);
        let np = size[2];
        let flat = Plane {
            size: [self.size[0], self.size[1]],
            values: Vec::new(),
        };
        for (row, to) in out.values.chunks_exact_mut(np).enumerate() {
            let (x, y) = (row / size[1], row % size[1]);
            let mut all = 0.0;
            for (at, k) in taps([x, y][axis], self.size[axis], axis) {
                let from = flat.row(axis, x, y, at);
                let k = weights.map_or(k, |weights| k * weights.values[from]);
                if k > 0.0 {
                    all += k;
                    add(to, k, self.row(from));
                }
            }
            if weights.is_some() && all > 0.0 {
                to.iter_mut().flatten().for_each(|v| *v /= all);
            }
        }
        out
    }

    /// Half as many cells along azimuth, even at both ends.
    pub(super) fn narrowed(&self) -> Self {
        let [nx, ny, np] = self.size;
        let mut out = Self::new([nx, ny, np / 2]);
        let rows = out.values.chunks_exact_mut(np / 2);
        for (to, from) in rows.zip(self.values.chunks_exact(np)) {
            if from.iter().all(|v| *v == [0.0; N]) {
                continue;
            }
            for (i, to) in to.iter_mut().enumerate() {
                for (tap, k) in TAPS.into_iter().enumerate() {
                    let at = (2 * i + tap).saturating_sub(1).min(np - 1);
                    for (to, from) in to.iter_mut().zip(from[at]) {
                        *to += k * from;
                    }
                }
            }
        }
        out
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
            add(to, 0.75 * sign, coarse.row(near));
            add(to, 0.25 * sign, coarse.row(next));
        }
    }

    /// Likewise along azimuth.
    pub(super) fn add_narrow(&mut self, sign: f32, coarse: &Self) {
        let half = coarse.size[2];
        let rows = self.values.chunks_exact_mut(2 * half);
        for (to, from) in rows.zip(coarse.values.chunks_exact(half)) {
            if from.iter().all(|v| *v == [0.0; N]) {
                continue;
            }
            for (i, to) in to.iter_mut().enumerate() {
                let near = i / 2;
                let next = match i % 2 {
                    0 => near.saturating_sub(1),
                    _ => (near + 1).min(half - 1),
                };
                for ((to, a), b) in to.iter_mut().zip(from[near]).zip(from[next]) {
                    *to += sign * (0.75 * a + 0.25 * b);
                }
            }
        }
    }

    /// Divides by what does not depend on azimuth; nothing where that is nothing.
    pub(super) fn divide(&mut self, by: &Plane) {
        let np = self.size[2];
        for (row, by) in self.values.chunks_exact_mut(np).zip(&by.values) {
            let scale = if *by > 0.0 { 1.0 / by } else { 0.0 };
            row.iter_mut().flatten().for_each(|v| *v *= scale);
        }
    }
}

fn add<const N: usize>(to: &mut [[f32; N]], k: f32, from: &[[f32; N]]) {
    for (to, from) in to.iter_mut().zip(from) {
        for (to, from) in to.iter_mut().zip(from) {
            *to += k * from;
        }
    }
}
