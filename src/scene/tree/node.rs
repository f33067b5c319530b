//! Sixteen boxes with axes of their own.

use super::lanes::Lanes;
use glam::{Mat3, Vec3, Vec4};

/// Children of a node at most.
pub(super) const CHILDREN: usize = 16;
/// Of which so many are looked at together.
const TOGETHER: usize = 8;

/// A reference to leaves rather than to a node; two leaves one after the other.
pub(super) const LEAF: u32 = 1 << 31;
pub(super) const PAIR: u32 = 1 << 30;

/// A ray as the search has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) origin: Vec3,
    pub(super) dir: Vec3,
}

/// Boxes of children, whose edges lie along the fur in them where it is long in one direction. Planes are counted in
/// steps from a corner, so that all is in three lines of a cache.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Columns: from directions in the scene to steps along the axes of the boxes.
    turn: [Vec4; 3],
    /// Corner, in the scene.
    corner: Vec4,
    /// For each axis lower and upper planes.
    planes: [[[[u8; TOGETHER]; CHILDREN / TOGETHER]; 2]; 3],
    /// First inner child and first leaf; both kinds follow one another.
    first: [u32; 2],
    /// Which children there are, which of them are leaves, which of these are two, a bit each.
    used: u16,
    leaves: u16,
    pairs: u16,
}

/// A child of a node that is to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child {
    /// Corners of its box along the axes of the node, with all room that it needs.
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
    /// Leaves; 0 for an inner child.
    pub(super) leaves: usize,
}

impl Node {
    /// * `axes`: columns, a rotation. * `children`: at most 16. * `first`: of both kinds.
    pub(super) fn new(axes: &Mat3, children: &[Child], first: [u32; 2]) -> Self {
        let lo = children.iter().fold(Vec3::INFINITY, |a, c| a.min(c.lo));
        let hi = children.iter().fold(Vec3::NEG_INFINITY, |a, c| a.max(c.hi));
        // Corner and ray are rounded in the scene and again along the axes.
        let room = 16.0 * f32::EPSILON * lo.abs().max(hi.abs()).max_element().max(1e-3);
        let corner = *axes * (lo - room);
        let lowest = axes.transpose() * corner;
        let step = (hi + 2.0 * room - lowest) / 254.0;
        let local = Mat3::from_diagonal(step.recip()) * axes.transpose();
        let mut node = Self {
            turn: [local.x_axis, local.y_axis, local.z_axis].map(|column| column.extend(0.0)),
            corner: corner.extend(0.0),
            first,
            planes: [[u8::MAX, 0].map(|plane| [[plane; TOGETHER]; CHILDREN / TOGETHER]); 3],
            used: ((1u32 << children.len()) - 1) as u16,
            leaves: 0,
            pairs: 0,
        };
        for (k, child) in children.iter().enumerate() {
            node.leaves |= u16::from(child.leaves > 0) << k;
            node.pairs |= u16::from(child.leaves == 2) << k;
            let (lo, hi) = (child.lo - room - lowest, child.hi + room - lowest);
            for axis in 0..3 {
                let [low, high] = &mut node.planes[axis];
                low[k / TOGETHER][k % TOGETHER] = (lo[axis] / step[axis]).floor() as u8;
                high[k / TOGETHER][k % TOGETHER] = (hi[axis] / step[axis]).ceil() as u8;
            }
        }
        node
    }

    /// Reference to a child.
    #[inline(always)]
    pub(super) fn child(&self, k: u32) -> u32 {
        let before = (1u32 << k) - 1;
        let (leaves, pairs) = (u32::from(self.leaves), u32::from(self.pairs));
        if leaves >> k & 1 == 0 {
            self.first[0] + (before & !leaves).count_ones()
        } else {
            let at = self.first[1] + (before & leaves).count_ones() + (before & pairs).count_ones();
            at | LEAF | ((pairs >> k & 1) * PAIR)
        }
    }

    /// Which of the boxes a ray meets, a bit each, and where it enters each.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, ray: &Line, limit: f32) -> (u32, [L::F; 2]) {
        let from = self.corner - ray.origin.extend(0.0);
        let [x, y, z] = self.turn;
        let along = x * ray.dir.x + y * ray.dir.y + z * ray.dir.z;
        let [x, y, z] = [x * from.x, y * from.y, z * from.z];
        // Rays along a plane take this for it, and with its sign.
        let tiny = Vec4::splat(1e-18);
        let inverse = along.abs().max(tiny).copysign(along).recip();
        let start = (x + y + z) * inverse;
        // From far away both boxes and strands are seen less sharply.
        let reach = x.abs() + y.abs() + z.abs();
        let blur = (8.0 * f32::EPSILON) * reach * inverse.abs();
        let (enter, leave) = (start - blur, start + blur);
        let down = inverse.is_negative_bitmask() as usize;
        let (mut met, mut begins) = (0, [L::splat(0.0); CHILDREN / TOGETHER]);
        for (part, begins) in begins.iter_mut().enumerate() {
            let x = self.slab::<L>(0, part, down, inverse.x, [enter.x, leave.x]);
            let y = self.slab::<L>(1, part, down, inverse.y, [enter.y, leave.y]);
            let z = self.slab::<L>(2, part, down, inverse.z, [enter.z, leave.z]);
            let begin = L::max(L::max(L::splat(0.0), x.0), L::max(y.0, z.0));
            let end = L::min(L::min(L::splat(limit), x.1), L::min(y.1, z.1));
            met |= L::le(begin, end) << (part * TOGETHER);
            *begins = begin;
        }
        (met & u32::from(self.used), begins)
    }

    /// Where a ray enters what lies between two planes of each box of a part, and where it leaves it.
    #[inline(always)]
    fn slab<L: Lanes>(
        &self,
        axis: usize,
        part: usize,
        down: usize,
        step: f32,
        [enter, leave]: [f32; 2],
    ) -> (L::F, L::F) {
        let near = down >> axis & 1;
        let [near, far] = [near, near ^ 1];
        let (near, far) = (
            &self.planes[axis][near][part],
            &self.planes[axis][far][part],
        );
        let step = L::splat(step);
        (
            L::mul_add(L::bytes(near), step, L::splat(enter)),
            L::mul_add(L::bytes(far), step, L::splat(leave)),
        )
    }
}
