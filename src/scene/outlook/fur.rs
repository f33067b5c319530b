//! How thick the fur is, in the cells of a grid.

use crate::scene::{Strands, Surface};
use glam::{UVec3, Vec3, Vec4Swizzles};

/// Strands that are looked at; of more of them every so many. A tenth of it makes neighboring cells uneven.
const STRANDS: usize = 25_000;

/// Layers of the skin where it fills a cell: light is to be blocked for good by what is half a cell thick here.
const SKIN_LAYERS: f32 = 4.0;

/// A box of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) low: Vec3,
    /// Side of a cell, millimeters, and its inverse.
    pub(super) step: f32,
    inverse: f32,
    pub(super) counts: UVec3,
}

impl Grid {
    /// * `side`: cells along the longest side.
    pub(super) fn new(low: Vec3, high: Vec3, side: f32) -> Self {
        let step = ((high - low).max_element() / side).max(f32::MIN_POSITIVE.sqrt());
        let counts = ((high - low) / step).ceil().as_uvec3();
        Self {
            low,
            step,
            inverse: 1.0 / step,
            counts: counts.max(UVec3::ONE),
        }
    }

    pub(super) fn cells(&self) -> usize {
        self.counts.as_usizevec3().element_product()
    }

    /// The cell of a place that is moved by a part of a cell; `None` outside.
    #[inline]
    pub(super) fn cell(&self, place: Vec3, moved: Vec3) -> Option<usize> {
        let at = (place - self.low) * self.inverse + moved;
        let cell = at.as_uvec3();
        let inside = at.cmpge(Vec3::ZERO).all() && cell.cmplt(self.counts).all();
        inside.then(|| ((cell.z * self.counts.y + cell.y) * self.counts.x + cell.x) as usize)
    }
}

/// What blocks light in a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Blockers {
    /// Length times width, square millimeters.
    area: f32,
    /// The same times the products of the tangent's components: xx, yy, zz, xy, xz, yz.
    along: [f32; 6],
}

/// Blockers of the cells that have any.
pub(super) struct Fur {
    /// Cells in order.
    pub(super) cells: Vec<u32>,
    blockers: Vec<Blockers>,
    /// Paths across a cell per millimeter squared of area: side over volume.
    per_area: f32,
}

impl Fur {
    pub(super) fn new(grid: &Grid, strands: &Strands, surface: Option<&Surface>) -> Self {
        let mut all = vec![Blockers::default(); grid.cells()];
        let every = strands.count().div_ceil(STRANDS).max(1);
        for strand in (0..strands.count()).step_by(every) {
            let mut joints = strands.joints_of(strand as u32);
            let Some(mut root) = joints.next() else {
                continue;
            };
            for tip in joints {
                let axis = (tip - root).xyz();
                // Pieces no longer than a cell, each where its middle is.
                let pieces = (axis.length() / grid.step).ceil().max(1.0);
                let width = (root.w + tip.w) * every as f32;
                for piece in 0..pieces as u32 {
                    let middle = root.xyz() + axis * ((piece as f32 + 0.5) / pieces);
                    if let Some(cell) = grid.cell(middle, Vec3::ZERO) {
                        all[cell].add(axis / pieces, width);
                    }
                }
                root = tip;
            }
        }
        for corners in surface.iter().flat_map(|s| s.corners()) {
            spread(corners, 0.5 * grid.step, |place, area| {
                if let Some(cell) = grid.cell(place, Vec3::ZERO) {
                    all[cell].area += SKIN_LAYERS * area;
                }
            });
        }
        let is_there = |cell: &u32| all[*cell as usize].area > 0.0;
        let cells: Vec<u32> = (0..all.len() as u32).filter(is_there).collect();
        Self {
            blockers: cells.iter().map(|&c| all[c as usize]).collect(),
            cells,
            per_area: 1.0 / (grid.step * grid.step),
        }
    }

    /// Optical depth of each of its cells, from face to face.
    pub(super) fn depths(&self, dir: Vec3) -> impl Iterator<Item = f32> + '_ {
        let [x, y, z] = dir.to_array();
        let products = [x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z];
        // A path that goes at a slant from face to face is longer.
        let per_area = self.per_area / dir.abs().max_element();
        self.blockers.iter().map(move |b| {
            let along: f32 = b.along.iter().zip(&products).map(|(a, p)| a * p).sum();
            // The mean sine of the angle to the tangents, about.
            let sine = (1.0 - along / b.area).max(0.0).sqrt();
            per_area * b.area * sine
        })
    }
}

impl Blockers {
    /// * `axis`: of a segment, millimeters. * `width`: of it.
    fn add(&mut self, axis: Vec3, width: f32) {
        let length = axis.length();
        let area = length * width;
        let [x, y, z] = (axis / length.max(f32::MIN_POSITIVE)).to_array();
        self.area += area;
        for (sum, product) in
            (self.along.iter_mut()).zip([x * x, y * y, z * z, x * y, x * z, y * z])
        {
            *sum += area * product;
        }
    }
}

/// Points of a triangle not much farther from each other than `near`, at most 2^16, and the area of each.
fn spread([a, b, c]: &[Vec3; 3], near: f32, mut each: impl FnMut(Vec3, f32)) {
    let (u, v) = (*b - *a, *c - *a);
    let longest = u.length().max(v.length()).max((u - v).length());
    let n = (longest / near).ceil().clamp(1.0, 256.0) as u32;
    let area = 0.5 * u.cross(v).length() / (n * n) as f32;
    let at = |x: f32, y: f32| *a + (x * u + y * v) / n as f32;
    for i in 0..n {
        for j in 0..n - i {
            let (x, y) = (i as f32, j as f32);
            each(at(x + 1.0 / 3.0, y + 1.0 / 3.0), area);
            if i + j + 1 < n {
                each(at(x + 2.0 / 3.0, y + 2.0 / 3.0), area);
            }
        }
    }
}
