//! Whether points lie near a place: points hashed by the cube they lie in, four to a line of memory.

use glam::{UVec3, Vec3};

/// Cells are between two and three times as long as the usual radius.
const LEAST_CELL: f32 = 2.0;
const MOST_CELL: f32 = 3.0;

/// Cells along x whose heads stand together.
const RUN: u32 = 16;

const NONE: u32 = u32::MAX;

/// Four points of a cell. Places without a point are infinitely far.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Bucket {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    used: u32,
    /// The next bucket of the cell.
    next: u32,
}

impl Bucket {
    fn empty(next: u32) -> Self {
        let far = [f32::INFINITY; 4];
        Self {
            x: far,
            y: far,
            z: far,
            used: 0,
            next,
        }
    }

    /// Whether a point is nearer to a place than the root of `limit`.
    fn blocks(&self, p: Vec3, limit: f32) -> bool {
        let mut any = false;
        for i in 0..4 {
            let (x, y, z) = (self.x[i] - p.x, self.y[i] - p.y, self.z[i] - p.z);
            any |= x * x + y * y + z * z < limit;
        }
        any
    }
}

/// Points in space.
pub(super) struct Near {
    /// Below all points.
    corner: Vec3,
    cell: f32,
    /// First bucket of each cell; cells of the same hash share theirs.
    heads: Vec<u32>,
    buckets: Vec<Bucket>,
}

impl Near {
    /// * `corner`: below all points that will come.
    pub(super) fn new(corner: Vec3) -> Self {
        Self {
            corner,
            cell: 0.0,
            heads: Vec::new(),
            buckets: Vec::new(),
        }
    }

    /// Makes room for `count` points and cells that suit `radius`.
    pub(super) fn prepare(&mut self, count: usize, radius: f32) {
        if count <= self.heads.len() && self.cell <= MOST_CELL * radius {
            return;
        }
        let old = std::mem::take(&mut self.buckets);
        self.clear(2 * count, radius);
        for bucket in old {
            for i in 0..bucket.used as usize {
                self.insert(Vec3::new(bucket.x[i], bucket.y[i], bucket.z[i]));
            }
        }
    }

    /// Forgets all points; there will be some `count` of them.
    pub(super) fn clear(&mut self, count: usize, radius: f32) {
        self.cell = LEAST_CELL * radius;
        self.buckets.clear();
        self.heads.clear();
        self.heads.resize(count.next_power_of_two().max(1024), NONE);
    }

    pub(super) fn insert(&mut self, position: Vec3) {
        let cell = self.cell_of((position - self.corner) / self.cell);
        let slot = self.slot(cell);
        let mut head = self.heads[slot];
        if head == NONE || self.buckets[head as usize].used == 4 {
            self.buckets.push(Bucket::empty(head));
            head = self.buckets.len() as u32 - 1;
            self.heads[slot] = head;
        }
        let bucket = &mut self.buckets[head as usize];
        let i = bucket.used as usize;
        (bucket.x[i], bucket.y[i], bucket.z[i]) = position.into();
        bucket.used += 1;
    }

    /// The cell of a place given in cells; what is below the corner counts to the first.
    fn cell_of(&self, place: Vec3) -> UVec3 {
        // Casts round down and end at 0.
        UVec3::new(place.x as u32, place.y as u32, place.z as u32)
    }

    fn slot(&self, cell: UVec3) -> usize {
        let mixed = (cell.x / RUN).wrapping_mul(0x8da6_b343)
            ^ cell.y.wrapping_mul(0xd816_3841)
            ^ cell.z.wrapping_mul(0xcb1a_b31f);
        let run = (mixed ^ (mixed >> 15)).wrapping_mul(RUN) + cell.x % RUN;
        run as usize & (self.heads.len() - 1)
    }

    /// Whether no point lies closer than `radius`.
    pub(super) fn is_free(&self, position: Vec3, radius: f32) -> bool {
        let limit = radius * radius;
        let place = (position - self.corner) / self.cell;
        let reach = radius / self.cell;
        // What is in the way is most often in the same cell.
        let home = self.cell_of(place);
        if self.is_blocked(home, position, limit) {
            return false;
        }
        let (lo, hi) = (self.cell_of(place - reach), self.cell_of(place + reach));
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    let cell = UVec3::new(x, y, z);
                    if cell != home && self.is_blocked(cell, position, limit) {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn is_blocked(&self, cell: UVec3, position: Vec3, limit: f32) -> bool {
        let mut index = self.heads[self.slot(cell)];
        while index != NONE {
            let bucket = &self.buckets[index as usize];
            if bucket.blocks(position, limit) {
                return true;
            }
            index = bucket.next;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    /// Against a search of all points, with radii below and above the one that the cells are made for.
    #[test]
    fn free_is_where_no_point_is_near() {
        let mut rng = Rng::new(1, 2);
        let mut point = || Vec3::from_array([0; 3].map(|_| rng.uniform_f32() - 0.5));
        let mut near = Near::new(Vec3::splat(-0.5));
        let mut all: Vec<Vec3> = Vec::new();
        let mut free = 0;
        for (count, radius) in [(50, 0.2), (400, 0.1), (3000, 0.04)] {
            near.prepare(count, radius);
            for i in 0..count {
                let (p, radius) = (point(), radius * [0.5, 1.0, 3.0][i % 3]);
                let far = all.iter().all(|q| q.distance_squared(p) >= radius * radius);
                assert_eq!(near.is_free(p, radius), far, "{p} {radius}");
                free += usize::from(far);
                if all.len() < count {
                    near.insert(p);
                    all.push(p);
                }
            }
        }
        assert!((300..3100).contains(&free), "{free}: nothing to tell");
        near.clear(10, 0.04);
        assert!(all.iter().all(|&p| near.is_free(p, 0.1)));
    }
}
