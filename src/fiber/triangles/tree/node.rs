//! Eight boxes.

use super::{KINDS, LEAF, Ray};
use glam::{Vec3, Vec4};

/// Boxes, four and four: their lower and upper planes along each axis. Inner children follow one
/// another, and so do leaves. (As bytes the planes would take half the room, and twice the time.)
#[derive(Clone, Debug)]
#[repr(align(32))]
pub(super) struct Node {
    planes: [[[Vec4; 2]; 2]; 3],
    first: [u32; 2],
    /// Which children are leaves, a bit each.
    leaves: u8,
    /// For each kind the children that hold some, a bit each.
    pub(super) holds: [u8; KINDS],
}

impl Node {
    /// One to be filled, of boxes that nothing meets.
    pub(super) const EMPTY: Self = Self {
        planes: [[[Vec4::INFINITY; 2], [Vec4::NEG_INFINITY; 2]]; 3],
        first: [0; 2],
        leaves: 0,
        holds: [0; KINDS],
    };

    /// * `boxes`: of the children, with all room that they need; at most 8.
    /// * `leaves`: which are leaves, a bit each. * `first`: the first of both kinds of children.
    pub(super) fn new(boxes: &[(Vec3, Vec3)], leaves: u8, first: [u32; 2]) -> Self {
        let mut node = Self {
            first,
            leaves,
            holds: [((1u32 << boxes.len()) - 1) as u8; KINDS],
            ..Self::EMPTY
        };
        for (k, (lo, hi)) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.planes[axis][0][k / 4][k % 4] = lo[axis];
                node.planes[axis][1][k / 4][k % 4] = hi[axis];
            }
        }
        node
    }

    /// How many children there are.
    pub(super) fn count(&self) -> usize {
        self.holds[KINDS - 1].trailing_ones() as usize
    }

    /// Number of a child.
    #[inline(always)]
    pub(super) fn child(&self, k: usize) -> u32 {
        let before = (1u32 << k) - 1;
        let leaves = u32::from(self.leaves);
        if leaves >> k & 1 == 0 {
            self.first[0] + (before & !leaves).count_ones()
        } else {
            (self.first[1] + (before & leaves).count_ones()) | LEAF
        }
    }

    /// Which of the boxes a ray meets, a bit each, and where it enters each.
    #[inline(always)]
    pub(super) fn meets(&self, ray: &Ray, room: f32, limit: f32) -> (u32, [Vec4; 2]) {
        let mut begin = [Vec4::splat(-room); 2];
        let mut end = [Vec4::splat(limit); 2];
        for k in 0..3 {
            let near = &self.planes[k][ray.down[k]];
            let far = &self.planes[k][1 - ray.down[k]];
            for half in 0..2 {
                begin[half] = begin[half].max(near[half] * ray.inverse[k] - ray.start[k]);
                end[half] = end[half].min(far[half] * ray.inverse[k] - ray.start[k]);
            }
        }
        let hit = [0, 1].map(|half| begin[half].cmple(end[half]).bitmask());
        (hit[0] | hit[1] << 4, begin)
    }
}
