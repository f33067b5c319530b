//! Faces four at a time.

use super::{Face, Room};
use glam::{DVec3, Vec3, Vec4};

/// Four faces; those that are missing have no normal and are never met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    x: Vec4,
    y: Vec4,
    z: Vec4,
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
