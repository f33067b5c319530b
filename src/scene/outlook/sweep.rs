//! Light from one direction on its way through the grid.

use super::fur::{Fur, Grid};
use glam::Vec3;

/// Scratch space of a sweep, kept from direction to direction.
pub(super) struct Sweep {
    /// What each cell lets through.
    pub(super) through: Vec<f32>,
    /// What comes to each cell.
    pub(super) light: Vec<f32>,
    /// What leaves the slice before, and this one; with a border all around.
    before: Vec<f32>,
    now: Vec<f32>,
}

impl Sweep {
    pub(super) fn new(grid: &Grid) -> Self {
        Self {
            through: vec![1.0; grid.cells()],
            light: vec![1.0; grid.cells()],
            before: Vec::new(),
            now: Vec::new(),
        }
    }

    /// Share of the light from unit `dir` that comes to each cell, into [`Self::light`]. Slices across the longest component of
    /// the direction are taken one after the other from where light comes in, and between the four cells of
    /// the slice before it is interpolated.
    ///
    /// What a cell itself blocks is left out: the brightest places in it matter most, and see past it.
    pub(super) fn run(&mut self, grid: &Grid, fur: &Fur, dir: Vec3) {
        self.face(fur, dir);
        self.carry(grid, dir, 1.0, |_, _| 0.0);
    }

    /// Takes down what each cell lets through from a direction.
    pub(super) fn face(&mut self, fur: &Fur, dir: Vec3) {
        for (&cell, depth) in fur.cells.iter().zip(fur.depths(dir)) {
            self.through[cell as usize] = exp_minus(depth);
        }
    }

    /// As [`Self::run`] from the direction that it faces, with what cells send on themselves.
    ///
    /// * `outside`: light that comes in. * `sent`: by a cell that blocks a share of the light.
    pub(super) fn carry(
        &mut self,
        grid: &Grid,
        dir: Vec3,
        outside: f32,
        sent: impl Fn(usize, f32) -> f32,
    ) {
        let counts = grid.counts.to_array().map(|n| n as usize);
        let strides = [1, counts[0], counts[0] * counts[1]];
        let [x, y, z] = dir.abs().to_array();
        let axis = if x >= y.max(z) {
            0
        } else {
            1 + usize::from(z > y)
        };
        let [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
        let along = dir[axis];
        // Where light comes from in the slice before, in cells: at most one to either side.
        let (from_u, from_v) = (dir[u] / along.abs(), dir[v] / along.abs());
        let (near_u, near_v) = (from_u.floor(), from_v.floor());
        let (part_u, part_v) = (from_u - near_u, from_v - near_v);
        // Two cells of border: interpolation reaches from -1 to count + 1.
        let width = counts[u] + 3;
        let open = |slice: &mut Vec<f32>| {
            slice.clear();
            slice.resize(width * (counts[v] + 3), outside);
        };
        open(&mut self.before);
        open(&mut self.now);
        for step in 0..counts[axis] {
            let slice = if along > 0.0 {
                counts[axis] - 1 - step
            } else {
                step
            };
            for j in 0..counts[v] {
                let at = |row: usize| {
                    let first = (j + 1 + row).wrapping_add_signed(near_v as isize) * width;
                    first.wrapping_add_signed(1 + near_u as isize)
                };
                let near = &self.before[at(0)..][..counts[u] + 1];
                let far = &self.before[at(1)..][..counts[u] + 1];
                let out = &mut self.now[(j + 1) * width + 1..][..counts[u]];
                let cells = slice * strides[axis] + j * strides[v];
                for (i, out) in out.iter_mut().enumerate() {
                    let a = near[i] + part_u * (near[i + 1] - near[i]);
                    let b = far[i] + part_u * (far[i + 1] - far[i]);
                    let light = a + part_v * (b - a);
                    let cell = cells + i * strides[u];
                    self.light[cell] = light;
                    let through = self.through[cell];
                    *out = light * through + sent(cell, 1.0 - through);
                }
            }
            std::mem::swap(&mut self.before, &mut self.now);
        }
    }
}

/// About `e^-x` for x >= 0, within 0.012 everywhere.
fn exp_minus(x: f32) -> f32 {
    1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0)))))
}
