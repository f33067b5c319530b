//! Sixteen boxes with axes of their own.

use super::line::Line;
use crate::accel::lanes::{CHILDREN, Children, Lanes, Numbers};
use glam::{Mat3, Vec3, Vec4};

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
    planes: [[[u8; CHILDREN]; 2]; 3],
    /// First inner child and first leaf; both kinds follow one another.
    first: [u32; 2],
    /// Places of the children after the first of their kind.
    places: [u8; CHILDREN],
    /// Which children there are, and which of them are leaves, a bit each.
    used: u16,
    leaves: u16,
}

const _: () = assert!(size_of::<Node>() == 192);

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
    /// * `axes`: columns, a rotation. * `children`: at most 16. * `first`: of both kinds. * `blur`: how far rays
    ///   may be from where they are, as [`Ball::blur`](super::line::Ball::blur).
    pub(super) fn new(axes: &Mat3, children: &[Child], first: [u32; 2], blur: f32) -> Self {
        let lo = children.iter().fold(Vec3::INFINITY, |a, c| a.min(c.lo));
        let hi = children.iter().fold(Vec3::NEG_INFINITY, |a, c| a.max(c.hi));
        // The corner is rounded in the scene and again along the axes.
        let room = blur + 16.0 * f32::EPSILON * lo.abs().max(hi.abs()).max_element().max(1e-3);
        let corner = *axes * (lo - room);
        let lowest = axes.transpose() * corner;
        let step = (hi + 2.0 * room - lowest) / 254.0;
        let local = Mat3::from_diagonal(step.recip()) * axes.transpose();
        let mut node = Self {
            turn: [local.x_axis, local.y_axis, local.z_axis].map(|column| column.extend(0.0)),
            corner: corner.extend(0.0),
            planes: [[u8::MAX, 0].map(|plane| [plane; CHILDREN]); 3],
            first,
            places: [0; CHILDREN],
            used: ((1u32 << children.len()) - 1) as u16,
            leaves: 0,
        };
        let mut next = [0, 0];
        for (k, child) in children.iter().enumerate() {
            let is_leaf = child.leaves > 0;
            node.leaves |= u16::from(is_leaf) << k;
            let next = &mut next[usize::from(is_leaf)];
            node.places[k] = *next;
            *next += child.leaves.max(1) as u8;
            let (lo, hi) = (child.lo - room - lowest, child.hi + room - lowest);
            for axis in 0..3 {
                let [low, high] = &mut node.planes[axis];
                low[k] = (lo[axis] / step[axis]).floor() as u8;
                high[k] = (hi[axis] / step[axis]).ceil() as u8;
            }
        }
        node
    }

    /// Of `met` the inner children.
    #[inline(always)]
    pub(super) fn inner(&self, met: u16) -> (u16, Children<'_>) {
        let [first, _] = self.first;
        let places = &self.places;
        (met & !self.leaves, Children { first, places })
    }

    /// Of `met` the leaves.
    #[inline(always)]
    pub(super) fn leaves(&self, met: u16) -> (u16, Children<'_>) {
        let [_, first] = self.first;
        let places = &self.places;
        (met & self.leaves, Children { first, places })
    }

    /// Which of the boxes a ray meets, a bit each, and where it enters each.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, line: &Line, limit: f32) -> (u16, L::Sixteen) {
        let along = L::turn(&self.turn, line.dir);
        // Rays along a plane take this for it, and with its sign.
        let tiny = Vec4::splat(1e-18);
        let inverse = along.abs().max(tiny).copysign(along).recip();
        let start = L::turn(&self.turn, self.corner - line.origin) * inverse;
        let down = inverse.is_negative_bitmask() as usize;
        let x = self.slab::<L>(0, down, inverse.x, start.x);
        let y = self.slab::<L>(1, down, inverse.y, start.y);
        let z = self.slab::<L>(2, down, inverse.z, start.z);
        let (zero, limit) = (L::Sixteen::splat(0.0), L::Sixteen::splat(limit));
        let begin = x.0.max(y.0).max(z.0.max(zero));
        let end = x.1.min(y.1).min(z.1.min(limit));
        (begin.le(end) as u16 & self.used, begin)
    }

    /// Where a ray enters what lies between two planes of each box, and where it leaves it.
    #[inline(always)]
    fn slab<L: Lanes>(
        &self,
        axis: usize,
        down: usize,
        step: f32,
        start: f32,
    ) -> (L::Sixteen, L::Sixteen) {
        let near = down >> axis & 1;
        let (near, far) = (&self.planes[axis][near], &self.planes[axis][near ^ 1]);
        let (step, start) = (L::Sixteen::splat(step), L::Sixteen::splat(start));
        (
            L::bytes(near).mul_add(step, start),
            L::bytes(far).mul_add(step, start),
        )
    }
}
