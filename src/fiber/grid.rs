//! A uniform grid of cells over a box that repeats along z: which items a ray may meet, in order.

use super::section::floor;
use glam::{DVec3, IVec3};

/// Lists of items for each cell of one period.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Corner of cell (0, 0, 0) and size of a cell.
    corner: DVec3,
    cell: DVec3,
    count: IVec3,
    /// Where the items of a cell begin in `members`.
    first: Vec<u32>,
    members: Vec<u32>,
}

/// Cells along an axis at most: more would only cost memory.
const MOST_CELLS: f64 = 256.0;
/// Steps of a walk at most: only a ray along the axis that meets nothing goes as far.
const MOST_STEPS: u32 = 1_000_000;

impl Grid {
    /// * `half`: half-widths of the box across, which lies about the axis.
    /// * `size`: wanted edges of a cell, about the distances of items: smaller cells cost steps, larger
    ///   ones tests.
    /// * `items`: the box of each item, lower and upper corner, at any z.
    /// * `touches`: whether an item reaches into a box, given its lower and upper corner; saying yes
    ///   too often costs time, never a hit.
    pub(super) fn new(
        half: [f64; 2],
        period: f64,
        size: DVec3,
        items: &[(DVec3, DVec3)],
        touches: impl Fn(usize, DVec3, DVec3) -> bool,
    ) -> Self {
        let whole = DVec3::new(2.0 * half[0], 2.0 * half[1], period);
        let count = (whole / size).ceil();
        let count = count.max(DVec3::ONE).min(DVec3::splat(MOST_CELLS));
        let mut grid = Self {
            corner: DVec3::new(-half[0], -half[1], 0.0),
            cell: whole / count,
            count: count.as_ivec3(),
            first: Vec::new(),
            members: Vec::new(),
        };
        let cells = (grid.count.x * grid.count.y * grid.count.z) as usize;
        let mut lists = vec![Vec::new(); cells];
        for (index, &(lo, hi)) in items.iter().enumerate() {
            let (lo, hi) = (grid.cell_of(lo), grid.cell_of(hi));
            for z in lo.z..=hi.z {
                for y in lo.y.max(0)..=hi.y.min(grid.count.y - 1) {
                    for x in lo.x.max(0)..=hi.x.min(grid.count.x - 1) {
                        let cell = IVec3::new(x, y, z);
                        let corner = grid.corner + cell.as_dvec3() * grid.cell;
                        let list: &mut Vec<u32> = &mut lists[grid.slot(cell)];
                        if touches(index, corner, corner + grid.cell)
                            && list.last() != Some(&(index as u32))
                        {
                            list.push(index as u32);
                        }
                    }
                }
            }
        }
        grid.first.push(0);
        for list in lists {
            grid.members.extend(list);
            grid.first.push(grid.members.len() as u32);
        }
        grid
    }

    #[inline]
    fn cell_of(&self, p: DVec3) -> IVec3 {
        let at = (p - self.corner) / self.cell;
        DVec3::new(floor(at.x), floor(at.y), floor(at.z)).as_ivec3()
    }

    #[inline]
    fn slot(&self, cell: IVec3) -> usize {
        let z = cell.z.rem_euclid(self.count.z);
        ((z * self.count.y + cell.y) * self.count.x + cell.x) as usize
    }

    #[inline]
    fn list(&self, slot: usize) -> &[u32] {
        &self.members[self.first[slot] as usize..self.first[slot + 1] as usize]
    }

    /// Items that may hold a point.
    pub(super) fn around(&self, p: DVec3) -> &[u32] {
        let cell = self.cell_of(p);
        if cell.x < 0 || cell.y < 0 || cell.x >= self.count.x || cell.y >= self.count.y {
            return &[];
        }
        self.list(self.slot(cell))
    }

    /// The first hit of a ray in `t0..t1`, where it is within the box.
    ///
    /// * `nearest`: the first hit among items, wherever it is; it also gets a z in the middle of the
    ///   cell, so that the image of an item can be chosen.
    #[inline(always)]
    pub(super) fn walk<T>(
        &self,
        origin: DVec3,
        dir: DVec3,
        t0: f64,
        t1: f64,
        mut nearest: impl FnMut(&[u32], f64) -> Option<(f64, T)>,
    ) -> Option<(f64, T)> {
        let start = origin + t0 * dir;
        let inside = self.count - IVec3::ONE;
        let mut cell = self.cell_of(start);
        cell.x = cell.x.clamp(0, inside.x);
        cell.y = cell.y.clamp(0, inside.y);
        let forward = DVec3::select(dir.cmpge(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
        let step = (2.0 * forward - 1.0).as_ivec3();
        let inverse = 1.0 / dir;
        let delta = (self.cell * inverse).abs();
        let mut next = ((cell.as_dvec3() + forward) * self.cell + self.corner - origin) * inverse;
        // A component of zero never reaches its plane, whatever 0 * inf says.
        for (n, d) in next.as_mut().iter_mut().zip(dir.to_array()) {
            if d == 0.0 {
                *n = f64::INFINITY;
            }
        }
        for _ in 0..MOST_STEPS {
            let leave = next.min_element().min(t1);
            let z = self.corner.z + (f64::from(cell.z) + 0.5) * self.cell.z;
            // An item of this cell may be hit beyond it, behind one of a later cell.
            if let Some(hit) = nearest(self.list(self.slot(cell)), z)
                && (hit.0 <= leave || leave >= t1)
            {
                return Some(hit);
            }
            if leave >= t1 {
                return None;
            }
            if next.x <= next.y && next.x <= next.z {
                cell.x += step.x;
                next.x += delta.x;
            } else if next.y <= next.z {
                cell.y += step.y;
                next.y += delta.y;
            } else {
                cell.z += step.z;
                next.z += delta.z;
            }
            if cell.x < 0 || cell.x > inside.x || cell.y < 0 || cell.y > inside.y {
                return None;
            }
        }
        None
    }
}
