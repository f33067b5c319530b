//! Faces four at a time.

use super::{Cells, Face, Room};
use glam::{DVec3, Vec3, Vec4};

/// Four faces; those that are missing have no normal and are never met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) x: Vec4,
    pub(super) y: Vec4,
    pub(super) z: Vec4,
    pub(super) void: Vec4,
    pub(super) cell: Vec4,
}

impl Block {
    pub(super) fn new(faces: &[Face]) -> Self {
        let of = |value: &dyn Fn(&Face) -> f64, none: f32| {
            let lane = |k: usize| faces.get(k).map_or(none, |f| value(f) as f32);
            Vec4::new(lane(0), lane(1), lane(2), lane(3))
        };
        Self {
            x: of(&|f| f.normal.x, 0.0),
            y: of(&|f| f.normal.y, 0.0),
            z: of(&|f| f.normal.z, 0.0),
            void: of(&|f| f.void, f32::INFINITY),
            cell: of(&|f| f.cell, f32::INFINITY),
        }
    }

    #[inline]
    pub(super) fn dot(&self, v: Vec3) -> Vec4 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    #[inline]
    pub(super) fn normal(&self, lane: usize) -> DVec3 {
        let [x, y, z] = [&self.x, &self.y, &self.z].map(|v| lane_of(v, lane));
        DVec3::new(x, y, z)
    }
}

/// Tests the faces of one cell after another.
pub(in crate::fiber) trait Tester: Copy {
    /// Where the void in a cell begins along a ray, and through which face. Zero or less if it holds the
    /// start. `None` if the chord is shorter than `least`.
    fn void(
        self,
        cells: &Cells,
        room: &Room,
        at: Vec3,
        dir: Vec3,
        least: f32,
    ) -> Option<(f32, usize)>;

    /// Where a ray leaves a cell (`whole`), or the void in it, and through which face. Infinite if nowhere.
    fn way_out(self, cells: &Cells, room: &Room, at: Vec3, dir: Vec3, whole: bool) -> (f32, usize);

    /// Distance from the nearest face of a cell, negative outside, and the slot of that face.
    fn room_left(self, cells: &Cells, room: &Room, at: Vec3) -> (f32, usize);
}

/// Four faces at a time.
#[derive(Clone, Copy)]
pub(super) struct Fours;

impl Tester for Fours {
    #[inline(always)]
    fn void(
        self,
        cells: &Cells,
        room: &Room,
        at: Vec3,
        dir: Vec3,
        least: f32,
    ) -> Option<(f32, usize)> {
        let (mut enter, mut leave) = (Least::NONE, f32::INFINITY * Vec4::ONE);
        for (k, block) in cells.blocks_of(room).iter().enumerate() {
            let rate = block.dot(dir);
            let t = (block.void - block.dot(at)) / rate;
            let ahead = rate.cmpgt(Vec4::ZERO);
            leave = leave.min(Vec4::select(ahead, t, Vec4::INFINITY));
            // The greatest is the least of the negative.
            enter.take(Vec4::select(rate.cmplt(Vec4::ZERO), -t, Vec4::INFINITY), k);
        }
        let (enter, slot) = enter.slot(room);
        (leave.min_element() + enter.min(0.0) > least).then_some((-enter, slot))
    }

    #[inline(always)]
    fn way_out(self, cells: &Cells, room: &Room, at: Vec3, dir: Vec3, whole: bool) -> (f32, usize) {
        let mut least = Least::NONE;
        for (k, block) in cells.blocks_of(room).iter().enumerate() {
            let rate = block.dot(dir);
            let offset = if whole { block.cell } else { block.void };
            let t = (offset - block.dot(at)) / rate;
            least.take(Vec4::select(rate.cmpgt(Vec4::ZERO), t, Vec4::INFINITY), k);
        }
        least.slot(room)
    }

    #[inline(always)]
    fn room_left(self, cells: &Cells, room: &Room, at: Vec3) -> (f32, usize) {
        let mut least = Least::NONE;
        for (k, block) in cells.blocks_of(room).iter().enumerate() {
            least.take(block.cell - block.dot(at), k);
        }
        least.slot(room)
    }
}

/// One of four numbers: by address, as an index of a vector is a jump by cases.
#[inline]
pub(super) fn lane_of(v: &Vec4, lane: usize) -> f64 {
    f64::from(v.as_ref()[lane])
}

/// The least value of each lane, and the block that had it.
pub(super) struct Least {
    value: Vec4,
    block: Vec4,
}

impl Least {
    pub(super) const NONE: Self = Self {
        value: Vec4::INFINITY,
        block: Vec4::ZERO,
    };

    #[inline]
    pub(super) fn take(&mut self, value: Vec4, block: usize) {
        let less = value.cmplt(self.value);
        self.value = Vec4::select(less, value, self.value);
        self.block = Vec4::select(less, Vec4::splat(block as f32), self.block);
    }

    /// The least of all and its slot.
    #[inline]
    pub(super) fn slot(&self, room: &Room) -> (f32, usize) {
        let (value, block) = (self.value.to_array(), self.block.to_array());
        let pick = |i: usize, j: usize| if value[j] < value[i] { j } else { i };
        let lane = pick(pick(0, 1), pick(2, 3));
        let slot = 4 * (room.first as usize + block[lane] as usize) + lane;
        (value[lane], slot)
    }
}
