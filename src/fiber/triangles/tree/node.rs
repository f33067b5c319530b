//! Eight boxes.

use super::KINDS;
use super::ray::Line;
use crate::accel::lanes::{Lanes, Numbers, Siblings};
use glam::{DVec3, Vec3};

/// Children of a node at most.
pub(super) const CHILDREN: usize = 8;

/// Boxes of children, and of the normals in them, in three lines of a cache. Inner children come first.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// For each axis lower and upper planes, in steps of the [`Grid`].
    planes: [[[u16; CHILDREN]; 2]; 3],
    /// The least and the greatest that normals have, as [`Lanes::facing`].
    normals: [[[u8; 4]; CHILDREN]; 2],
    /// For each kind the children that hold some if entered, and if left, a bit each.
    holds: [[u8; 2]; KINDS],
    /// Inner children and leaves.
    pub(super) children: Siblings,
    count: u8,
}

const _: () = assert!(size_of::<Node>() == 192);

/// Where the planes of boxes are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) corner: Vec3,
    /// Length of a step along each axis, in radii.
    pub(super) step: Vec3,
}

impl Grid {
    /// * `lo`, `hi`: corners of a box around all boxes.
    pub(super) fn new(lo: Vec3, hi: Vec3) -> Self {
        // One step more than the size takes, for rounding.
        let step = ((hi - lo) / 65534.0).max(Vec3::splat(f32::MIN_POSITIVE));
        Self { corner: lo, step }
    }

    /// Planes of a box, not within it.
    fn planes(&self, (lo, hi): (Vec3, Vec3)) -> [[u16; 2]; 3] {
        [0, 1, 2].map(|axis| {
            let count = |x: f32| f64::from(x - self.corner[axis]) / f64::from(self.step[axis]);
            [
                count(lo[axis]).floor() as u16,
                count(hi[axis]).ceil() as u16,
            ]
        })
    }
}

/// For each axis the least and the greatest of some normals, as [`Lanes::facing`] has them.
pub(super) type Normals = [[u8; 4]; 2];

/// Those of all directions.
pub(super) const ANY: Normals = [[1, 1, 1, 0], [255, 255, 255, 0]];

/// Those between two.
pub(super) fn normals(lo: DVec3, hi: DVec3) -> Normals {
    let bytes = |x: DVec3| [x.x as u8, x.y as u8, x.z as u8, 0];
    [
        bytes((127.0 * lo).floor() + 128.0),
        bytes((127.0 * hi).ceil() + 128.0),
    ]
}

/// What a child holds: for each kind whether there are triangles of it if entered, and if left, and their normals.
pub(super) type Held = ([[bool; 2]; KINDS], Normals);

impl Node {
    /// One to be filled, without children.
    pub(super) const EMPTY: Self = Self {
        planes: [[[u16::MAX; CHILDREN], [0; CHILDREN]]; 3],
        normals: [[ANY[0]; CHILDREN], [ANY[1]; CHILDREN]],
        holds: [[0; 2]; KINDS],
        children: Siblings {
            first: [0; 2],
            split: 0,
        },
        count: 0,
    };

    /// One whose children hold all kinds.
    ///
    /// * `boxes`: of the children, with all room that they need; one to eight, inner ones first.
    /// * `inner`: how many are no leaves. * `first`: the first of both kinds of children.
    pub(super) fn new(grid: &Grid, boxes: &[(Vec3, Vec3)], inner: usize, first: [u32; 2]) -> Self {
        let mut node = Self {
            holds: [[((1u32 << boxes.len()) - 1) as u8; 2]; KINDS],
            children: Siblings {
                first: [first[0], first[1].wrapping_sub(inner as u32)],
                split: inner as u32,
            },
            count: boxes.len() as u8,
            ..Self::EMPTY
        };
        for (k, corners) in boxes.iter().enumerate() {
            for (own, [low, high]) in node.planes.iter_mut().zip(grid.planes(*corners)) {
                own[0][k] = low;
                own[1][k] = high;
            }
        }
        node
    }

    /// Says what the children hold.
    pub(super) fn label(&mut self, children: &[Held]) {
        self.holds = [[0; 2]; KINDS];
        for (k, (holds, [least, most])) in children.iter().enumerate() {
            for (own, [entered, left]) in self.holds.iter_mut().zip(holds) {
                own[0] |= u8::from(*entered) << k;
                own[1] |= u8::from(*left) << k;
            }
            self.normals[0][k] = *least;
            self.normals[1][k] = *most;
        }
    }

    /// What all children together hold.
    pub(super) fn held(&self) -> Held {
        let holds = self.holds.map(|holds| holds.map(|holds| holds != 0));
        let of = |side: usize, axis: usize| {
            let all = self.normals[side][..self.count()].iter();
            all.map(move |n| n[axis])
        };
        let normals = [
            std::array::from_fn(|axis| of(0, axis).min().unwrap_or(0)),
            std::array::from_fn(|axis| of(1, axis).max().unwrap_or(255)),
        ];
        (holds, normals)
    }

    /// How many children there are.
    pub(super) fn count(&self) -> usize {
        self.count.into()
    }

    /// Which of the boxes that hold something of a kind, seen from the side that is asked for, a ray meets, a bit each, and
    /// where it enters each.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, line: &Line, limit: f32, kind: usize) -> (u32, L::Eight) {
        let x = self.slab::<L>(0, line);
        let y = self.slab::<L>(1, line);
        let z = self.slab::<L>(2, line);
        let (zero, limit) = (L::Eight::splat(0.0), L::Eight::splat(limit));
        let begin = x.0.max(y.0).max(z.0.max(zero));
        let end = x.1.min(y.1).min(z.1.min(limit));
        let met = begin.le(end);
        let [against, along] = self.faces::<L>(line);
        let [entered, left] = self.holds[kind % KINDS].map(u32::from);
        (met & (against & entered | along & left), begin)
    }

    /// Which children may have triangles that a ray would enter, and some that it would leave, a bit each.
    #[inline(always)]
    pub(super) fn faces<L: Lanes>(&self, line: &Line) -> [u32; 2] {
        let [least, most] = &self.normals;
        L::facing(least, most, &line.way)
    }

    /// Where a ray enters what lies between two planes of each box, and where it leaves it.
    #[inline(always)]
    fn slab<L: Lanes>(&self, axis: usize, line: &Line) -> (L::Eight, L::Eight) {
        let down = line.down[axis] & 1;
        let (near, far) = (&self.planes[axis][down], &self.planes[axis][down ^ 1]);
        let step = L::Eight::splat(line.steps[axis]);
        let start = L::Eight::splat(line.start[axis]);
        (
            L::short(near).mul_add(step, start),
            L::short(far).mul_add(step, start),
        )
    }
}
