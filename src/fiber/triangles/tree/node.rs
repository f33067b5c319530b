//! Sixteen boxes.

use super::ray::Line;
use super::{KINDS, Kinds, LEAF};
use crate::accel::lanes::{CHILDREN, Children, Lanes, Numbers};
use glam::{Vec3, Vec4};

/// Boxes of children, and of the normals in them, in four lines of a cache: planes are counted in steps from a corner,
/// normals in parts of [`UNIT`]. Inner children come first.
#[derive(Clone, Debug)]
#[repr(C, align(128))]
pub(super) struct Node {
    corner: [f32; 3],
    /// Length of a step along each axis, in radii.
    step: [f32; 3],
    /// First inner child and first leaf, less the number of inner children; both kinds follow one another.
    first: [u32; 2],
    /// For each axis lower and upper planes.
    planes: [[[u8; CHILDREN]; 2]; 3],
    /// For each axis the least and the greatest that normals have.
    normals: [[[i8; CHILDREN]; 2]; 3],
    /// For each kind but the last, which all are of, the children that hold some if entered, and if left, a bit each.
    holds: [[u16; 2]; KINDS - 1],
    count: u8,
    /// Inner children.
    inner: u8,
}

const _: () = assert!(size_of::<Node>() == 256);

/// Length of a normal.
pub(super) const UNIT: f64 = 127.0;

/// For each axis the least and the greatest that some normals have, in parts of [`UNIT`].
pub(super) type Normals = [[i8; 2]; 3];

/// Those of all directions.
pub(super) const ANY: Normals = [[-127, 127]; 3];

/// A child's number is the first of its kind and its place in the node.
const PLACES: [u8; CHILDREN] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

impl Node {
    /// One to be filled, without children.
    pub(super) const EMPTY: Self = Self {
        corner: [0.0; 3],
        step: [1.0; 3],
        first: [0; 2],
        planes: [[[u8::MAX; CHILDREN], [0; CHILDREN]]; 3],
        normals: [[[-127; CHILDREN], [127; CHILDREN]]; 3],
        holds: [[0; 2]; KINDS - 1],
        count: 0,
        inner: 0,
    };

    /// * `boxes`: of the children, with all room that they need; one to sixteen, inner ones first.
    /// * `inner`: how many are no leaves. * `first`: the first of both kinds of children.
    pub(super) fn new(boxes: &[(Vec3, Vec3)], inner: usize, first: [u32; 2]) -> Self {
        let lo = boxes.iter().fold(Vec3::INFINITY, |a, b| a.min(b.0));
        let hi = boxes.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(b.1));
        // One step more than the size takes, for rounding.
        let step = ((hi - lo) / 254.0).max(Vec3::splat(f32::MIN_POSITIVE));
        let mut node = Self {
            corner: lo.to_array(),
            step: step.to_array(),
            first: [first[0], first[1].wrapping_sub(inner as u32)],
            holds: [[((1u32 << boxes.len()) - 1) as u16; 2]; KINDS - 1],
            count: boxes.len() as u8,
            inner: inner as u8,
            ..Self::EMPTY
        };
        for (k, (low, high)) in boxes.iter().enumerate() {
            for axis in 0..3 {
                let count = |x: f32| f64::from(x - lo[axis]) / f64::from(step[axis]);
                node.planes[axis][0][k] = count(low[axis]).floor() as u8;
                node.planes[axis][1][k] = count(high[axis]).ceil() as u8;
            }
        }
        node
    }

    /// Says what the children hold: for each kind whether some of it if entered, and if left, and normals.
    pub(super) fn label(&mut self, children: &[([[bool; 2]; KINDS], Normals)]) {
        self.holds = [[0; 2]; KINDS - 1];
        for (k, (holds, normals)) in children.iter().enumerate() {
            for (own, [entered, left]) in self.holds.iter_mut().zip(holds) {
                own[0] |= u16::from(*entered) << k;
                own[1] |= u16::from(*left) << k;
            }
            for (own, [least, most]) in self.normals.iter_mut().zip(normals) {
                own[0][k] = *least;
                own[1][k] = *most;
            }
        }
    }

    /// What all children together hold, as [`Self::label`] is told.
    pub(super) fn held(&self) -> ([[bool; 2]; KINDS], Normals) {
        let mut all = [[true; 2]; KINDS];
        for (all, holds) in all.iter_mut().zip(&self.holds) {
            *all = holds.map(|holds| holds != 0);
        }
        let normals = self.normals.map(|[least, most]| {
            let (least, most) = (&least[..self.count()], &most[..self.count()]);
            [
                least.iter().fold(i8::MAX, |a, b| a.min(*b)),
                most.iter().fold(i8::MIN, |a, b| a.max(*b)),
            ]
        });
        (all, normals)
    }

    /// How many children there are.
    pub(super) fn count(&self) -> usize {
        self.count.into()
    }

    /// Number of a child.
    pub(super) fn child(&self, k: usize) -> u32 {
        let is_leaf = k >= usize::from(self.inner);
        let number = self.first[usize::from(is_leaf)].wrapping_add(k as u32);
        number | if is_leaf { LEAF } else { 0 }
    }

    /// Of `met` the inner children.
    #[inline(always)]
    pub(super) fn inner(&self, met: u16) -> (u16, Children<'_>) {
        let [first, _] = self.first;
        let is_inner = ((1u32 << self.inner) - 1) as u16;
        (
            met & is_inner,
            Children {
                first,
                places: &PLACES,
            },
        )
    }

    /// Of `met` the leaves.
    #[inline(always)]
    pub(super) fn leaves(&self, met: u16) -> (u16, Children<'_>) {
        let [_, first] = self.first;
        let is_inner = ((1u32 << self.inner) - 1) as u16;
        (
            met & !is_inner,
            Children {
                first,
                places: &PLACES,
            },
        )
    }

    /// Which of the boxes that hold something of some kinds, seen from the side that is asked for, a ray meets, a bit each,
    /// and where it enters each.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(
        &self,
        line: &Line,
        limit: f32,
        kinds: Kinds,
    ) -> (u16, L::Sixteen) {
        let [x, y, z] = self.step;
        let step = Vec4::new(x, y, z, 0.0) * line.inverse;
        let [x, y, z] = self.corner;
        let start = (Vec4::new(x, y, z, 0.0) - line.origin) * line.inverse;
        let x = self.slab::<L>(0, line.down[0], step.x, start.x);
        let y = self.slab::<L>(1, line.down[1], step.y, start.y);
        let z = self.slab::<L>(2, line.down[2], step.z, start.z);
        let (zero, limit) = (L::Sixteen::splat(0.0), L::Sixteen::splat(limit));
        let begin = x.0.max(y.0).max(z.0.max(zero));
        let end = x.1.min(y.1).min(z.1.min(limit));
        let met = begin.le(end) as u16;

        let [x, y, z] = &self.normals;
        let [dx, dy, dz] = line.down.map(|down| down & 1);
        let [against, along] = L::facing(
            [&x[dx], &y[dy], &z[dz]],
            [&x[dx ^ 1], &y[dy ^ 1], &z[dz ^ 1]],
            line.steps,
            line.slack,
        );
        let [entered, left] = kinds.of_node(&self.holds, self.count);
        (met & (against & entered | along & left), begin)
    }

    /// Where a ray enters what lies between two planes of each box, and where it leaves it.
    #[inline(always)]
    fn slab<L: Lanes>(
        &self,
        axis: usize,
        near: usize,
        step: f32,
        start: f32,
    ) -> (L::Sixteen, L::Sixteen) {
        let (near, far) = (&self.planes[axis][near & 1], &self.planes[axis][!near & 1]);
        let (step, start) = (L::Sixteen::splat(step), L::Sixteen::splat(start));
        (
            L::bytes(near).mul_add(step, start),
            L::bytes(far).mul_add(step, start),
        )
    }
}
