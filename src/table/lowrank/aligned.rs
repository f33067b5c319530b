//! Directions seen from the specular cone: a grid on which the maps of all nodes fall together.
//!
//! A map of node `theta_j` holds its specular cone at the inclination `-theta_j`. On the grid
//! `(x, phi)` with `x = theta + theta_j` all cones lie at `x = 0`, and what the grid holds, the
//! density times `cos(theta)` (flux per inclination and azimuth), is what the renderer's look-up keeps
//! as well when it moves from node to node.

use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::table::pack::Layout;
use std::f64::consts::{FRAC_PI_2, PI};

/// Points along each axis at which the grid is read for one texel: two leave steps in sharp cones,
/// four gain nothing more.
const POINTS: usize = 3;

/// The grid of one fiber's maps: `rows x columns` cells, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::table) struct Grid {
    /// Over `x` from -pi to pi.
    pub(in crate::table) rows: usize,
    /// Over azimuths 0 to pi if folded, else -pi to pi.
    pub(in crate::table) columns: usize,
    folded: bool,
}

impl Grid {
    /// The grid with cells about as large as the texels of a map: a texel spans 90 degrees / res.
    pub(in crate::table) fn new(layout: Layout) -> Self {
        let rows = 4 * layout.res;
        Self {
            rows,
            columns: if layout.folded { rows / 2 } else { rows },
            folded: layout.folded,
        }
    }

    /// Cells.
    pub(in crate::table) fn len(self) -> usize {
        self.rows * self.columns
    }

    /// For every cell the place in a map of `layout` whose texel holds it, for the node at `theta`;
    /// `None` where the inclination would lie beyond a pole.
    pub(super) fn sources(self, layout: Layout, theta: f64) -> Vec<Option<(u32, f32)>> {
        let cube = Unicube::new(layout.res);
        let mut place = vec![0u32; cube.texels()];
        for i in 0..layout.len() {
            place[layout.texel(i)] = i as u32;
        }
        (0..self.len())
            .map(|cell| {
                let (row, column) = (cell / self.columns, cell % self.columns);
                let inclination = (2.0 * (row as f64 + 0.5) / self.rows as f64 - 1.0) * PI - theta;
                let turn = (column as f64 + 0.5) / self.columns as f64;
                let phi = if self.folded { turn } else { 2.0 * turn - 1.0 } * PI;
                (inclination.abs() < FRAC_PI_2).then(|| {
                    let texel = cube.texel(frame::direction(inclination, phi));
                    (place[texel], inclination.cos() as f32)
                })
            })
            .collect()
    }

    /// How a map of `layout` for the node at `theta` follows from an image: for every place of the
    /// map the cells and the weights with which they sum to its density.
    pub(in crate::table) fn footprints(self, layout: Layout, theta: f64) -> Footprints {
        let cube = Unicube::new(layout.res);
        let mut all = Footprints {
            cells: Vec::with_capacity(4 * POINTS * POINTS * layout.len()),
        };
        let at = |i: usize| (i as f64 + 0.5) / POINTS as f64;
        for i in 0..layout.len() {
            let texel = layout.texel(i);
            for point in 0..POINTS * POINTS {
                let (w, _) = cube.direction(texel, at(point % POINTS), at(point / POINTS));
                let inclination = frame::theta_of(w);
                // The pole itself is never hit, the texels about it nearly.
                let share = 1.0 / (POINTS * POINTS) as f64 / inclination.cos().max(1e-3);
                for (cell, weight) in self.around(inclination + theta, w.y.atan2(w.x)) {
                    all.cells.push((cell as u32, (weight * share) as f32));
                }
            }
        }
        all
    }

    /// The four cells about a point and their shares. Azimuth wraps, or mirrors if folded.
    fn around(self, x: f64, phi: f64) -> [(usize, f64); 4] {
        let turn = if self.folded {
            phi.abs() / PI
        } else {
            0.5 * (phi / PI + 1.0)
        };
        let (row, down) = split(0.5 * (x / PI + 1.0) * self.rows as f64 - 0.5);
        let (column, right) = split(turn * self.columns as f64 - 0.5);
        let last = self.columns as i64 - 1;
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(dy, dx)| {
            let r = (row + dy).clamp(0, self.rows as i64 - 1) as usize;
            let c = if self.folded {
                (column + dx).clamp(0, last)
            } else {
                (column + dx).rem_euclid(last + 1)
            };
            let weight = |step: i64, f: f64| if step == 1 { f } else { 1.0 - f };
            let share = weight(dy, down) * weight(dx, right);
            (r * self.columns + c as usize, share)
        })
    }
}

/// Which cells make up which place of a map.
pub(in crate::table) struct Footprints {
    /// As many for each place.
    cells: Vec<(u32, f32)>,
}

impl Footprints {
    /// The map of an image.
    pub(in crate::table) fn apply(&self, image: &[f32]) -> Vec<f32> {
        let mean = |cells: &[(u32, f32)]| cells.iter().map(|&(c, w)| w * image[c as usize]).sum();
        self.cells.chunks(4 * POINTS * POINTS).map(mean).collect()
    }
}

fn split(v: f64) -> (i64, f64) {
    let floor = v.floor();
    (floor as i64, v - floor)
}
