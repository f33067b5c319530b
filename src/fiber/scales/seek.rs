//! The cell that holds a point, and the cells about a cell.

use super::{Cell, Scales, Strip, at, distance};
use crate::fiber::section::{Line, floor};
use glam::DVec3;

/// Entries of the pseudo-angle table: a few per sector.
pub(in crate::fiber) const ANGLE_STEPS: usize = 1024;
/// Steps of z in a period: more than a sector has strips, as a rule, and still a small table.
pub(in crate::fiber) const Z_STEPS: usize = 32;

impl Scales {
    /// The cell above.
    #[inline]
    pub(in crate::fiber) fn above(&self, mut cell: Cell) -> Cell {
        if cell.strip + 1 == self.count(cell.sector) {
            cell.strip = 0;
            cell.shift += self.period;
        } else {
            cell.strip += 1;
        }
        cell
    }

    /// The cell below.
    #[inline]
    pub(in crate::fiber) fn below(&self, mut cell: Cell) -> Cell {
        if cell.strip == 0 {
            cell.strip = self.count(cell.sector) - 1;
            cell.shift -= self.period;
        } else {
            cell.strip -= 1;
        }
        cell
    }

    /// The cell beyond the half plane that ends (`plane` 1) or begins (0) a cell's sector, where it is
    /// met at height `z`.
    #[inline]
    pub(in crate::fiber) fn beyond(&self, cell: Cell, plane: usize, z: f64) -> Cell {
        let beside = self.beside[self.sectors[cell.sector].first as usize + cell.strip];
        let near = Cell {
            sector: self.neighbor(cell.sector, plane),
            strip: usize::from(beside[plane]),
            ..cell
        };
        self.settle(near, 1.0 - plane as f64, z)
    }

    /// The sector beyond the second half plane of a sector (`plane` 1) or beyond the first.
    #[inline]
    pub(in crate::fiber) fn neighbor(&self, sector: usize, plane: usize) -> usize {
        let count = self.sectors.len();
        let next = sector + 2 * plane;
        match next {
            0 => count - 1,
            _ if next > count => 0,
            _ => next - 1,
        }
    }

    /// The sector that holds a place of the unit-circle frame.
    #[inline(always)]
    pub(in crate::fiber) fn sector(&self, x: f64, y: f64) -> usize {
        let angle = pseudo_angle(x, y) * (ANGLE_STEPS as f64 / 4.0);
        let mut sector = usize::from(self.start_of_angle[(angle as usize).min(ANGLE_STEPS - 1)]);
        // The table gives the sector at the start of the step; the next may begin within it.
        loop {
            let [_, end] = self.sectors[sector].planes;
            let beyond = distance(end, x, y) >= 0.0 && end.cos * x + end.sin * y > 0.0;
            if !beyond || sector + 1 == self.sectors.len() {
                return sector;
            }
            sector += 1;
        }
    }

    /// The cell that holds a point of the unit-circle frame.
    #[inline]
    pub(in crate::fiber) fn locate(&self, p: DVec3) -> Cell {
        let sector = self.sector(p.x, p.y);
        let shift = self.period * floor(p.z * self.inverse_period);
        let step = ((p.z - shift) * self.inverse_period * Z_STEPS as f64) as usize;
        let near = Cell {
            sector,
            strip: usize::from(self.strip_at[sector * Z_STEPS + step.min(Z_STEPS - 1)]),
            shift,
        };
        self.settle(near, self.across(sector, p.x, p.y), p.z)
    }

    /// Position of a point between the half planes of a sector, 0..1.
    #[inline]
    pub(in crate::fiber) fn across(&self, sector: usize, x: f64, y: f64) -> f64 {
        let [begin, end] = self.sectors[sector].planes;
        let a = distance(begin, x, y);
        a / (a - distance(end, x, y))
    }

    /// Walks from a near strip of the right sector to the one that holds `z` at `u`.
    #[inline]
    pub(in crate::fiber) fn settle(&self, mut cell: Cell, u: f64, z: f64) -> Cell {
        if self.bare {
            return cell;
        }
        while z - cell.shift > at(self.strip(cell).end, u) {
            cell = self.above(cell);
        }
        while z - cell.shift <= at(self.strip(cell).begin, u) {
            cell = self.below(cell);
        }
        cell
    }
}

/// Monotone in the angle of a vector, 0..4, without trigonometry and without branches, which could
/// not be predicted.
#[inline]
fn pseudo_angle(x: f64, y: f64) -> f64 {
    let r = x / (x.abs() + y.abs());
    2.0 - (1.0 + r).copysign(y)
}

/// The sector that holds the start of each step of the pseudo-angle.
pub(super) fn starts_of_angles(lines: &[Line]) -> Vec<u16> {
    let mut starts = Vec::with_capacity(ANGLE_STEPS);
    let mut sector = 0;
    for step in 0..ANGLE_STEPS {
        let angle = 4.0 * step as f64 / ANGLE_STEPS as f64;
        while sector + 1 < lines.len()
            && pseudo_angle(lines[sector + 1].cos, lines[sector + 1].sin) <= angle
        {
            sector += 1;
        }
        starts.push(sector as u16);
    }
    starts
}

/// The strips beside each strip: the first of the neighbor that ends no lower on the common line.
pub(super) fn beside(stacks: &[&[Strip]]) -> Vec<[u16; 2]> {
    let last = stacks.len() - 1;
    let mut all = Vec::with_capacity(stacks.iter().map(|s| s.len()).sum());
    for (i, stack) in stacks.iter().enumerate() {
        let previous = stacks[i.checked_sub(1).unwrap_or(last)];
        let next = stacks[if i == last { 0 } else { i + 1 }];
        let first = |stack: &[Strip], side: usize, z: f64| {
            let below = stack.partition_point(|s| s.end[side] < z);
            below.min(stack.len() - 1) as u16
        };
        all.extend(stack.iter().map(|s| {
            let [begin, end] = s.end;
            [first(previous, 1, begin), first(next, 0, end)]
        }));
    }
    all
}

/// See [`Scales::strip_at`].
pub(super) fn strips_at(stacks: &[&[Strip]], period: f64) -> Vec<u16> {
    let step = period / Z_STEPS as f64;
    let steps = stacks.iter().flat_map(|stack| {
        (0..Z_STEPS).map(move |i| {
            let z = (i as f64 + 0.5) * step;
            let below = stack.partition_point(|s| at(s.end, 0.5) < z);
            below.min(stack.len() - 1) as u16
        })
    });
    steps.collect()
}
