//! The triangles of a tile in a tree: nodes of eight boxes, leaves of four triangles. All of a node, and of a
//! leaf, is tested at once in single precision, with the room that its rounding needs: what a ray meets is
//! shown to the caller, who decides in double precision, and little else is.

mod layout;
mod leaf;
mod node;

use super::OVERLAP;
use super::solid::Bound;
use crate::accel::{AccelError, Effort, binary_tree};
use crate::fiber::{Part, Region};
use crate::pages::Table;
use glam::{DVec3, Vec3, Vec4};
use leaf::{Leaf, SIZE};
use node::Node;
use std::cell::RefCell;

/// Room for single precision, relative to the longest way of a ray: half a rounding for each of up to
/// 32 operations in a row.
const ROUNDINGS: f32 = 16.0 * f32::EPSILON;
/// Marks children that are leaves.
const LEAF: u32 = 1 << 31;
/// Boxes set aside by a ray; each level leaves seven at most. Deeper trees get a place of their own.
const STACK: usize = 256;

thread_local! {
    /// Boxes set aside and where the ray enters them: kept, as clearing it takes as long as a node.
    static ASIDE: RefCell<[(u32, f32); STACK]> = const { RefCell::new([(0, 0.0); STACK]) };
}

/// Number of kinds of triangles that can be asked for.
const KINDS: usize = Region::COUNT + 3;

/// Kinds of triangles that a ray is to be shown; others it may be shown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kinds([usize; 2]);

impl Kinds {
    pub(super) const ALL: Self = Self([KINDS - 1; 2]);

    /// What a ray in a region leaves it through.
    pub(super) fn around(region: Region) -> Self {
        Self([region as usize; 2])
    }

    /// Those of a bound, from either side.
    pub(super) fn of(bound: Bound) -> Self {
        Self([kind_of(bound); 2])
    }

    /// The kinds of both, each a single one.
    pub(super) fn and(self, other: Self) -> Self {
        Self([self.0[0], other.0[0]])
    }

    /// Of the marks for each kind those for these.
    #[inline(always)]
    fn held(self, holds: &[u8; KINDS]) -> u8 {
        holds[self.0[0]] | holds[self.0[1]]
    }
}

fn kind_of(bound: Bound) -> usize {
    match bound {
        Bound::Medulla => Region::COUNT,
        Bound::Void => Region::COUNT + 1,
        // Nobody counts those.
        Bound::Outer | Bound::Cortex => KINDS - 1,
    }
}

/// What is known of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    /// The triangle of the mesh that it is an image of.
    pub(super) source: u32,
    /// Regions outside and inside.
    pub(super) sides: [Region; 2],
    pub(super) bound: Bound,
    pub(super) part: Part,
}

impl Label {
    const NONE: Self = Self {
        source: u32::MAX,
        sides: [Region::Outside; 2],
        bound: Bound::Outer,
        part: Part::Scale,
    };
}

/// A tree over triangles that the caller keeps.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Table<Node>,
    leaves: Table<Leaf>,
    /// Places for boxes set aside that the deepest way needs.
    stack: usize,
    /// Corners are multiples of this, in radii.
    step: f64,
    /// Room around what is single precision, in radii.
    room: f32,
}

impl Tree {
    /// The tree, and for each place in it the triangle there: some are at several places, and those
    /// have the same label.
    ///
    /// * `corners`: of all triangles, in radii: multiples of `step`, a power of two, by no more than
    ///   2^31. * `period`: length of the tile, in radii.
    pub(super) fn new(
        corners: &[[DVec3; 3]],
        step: f64,
        period: f64,
    ) -> Result<(Self, Vec<u32>), AccelError> {
        let single: Vec<[Vec3; 3]> = corners.iter().map(|t| t.map(|p| p.as_vec3())).collect();
        let binary = binary_tree(&single, Effort::Best)?;
        // From a little outside of the fiber through all of a tile.
        let reach = (2.5 + period + 4.0 * OVERLAP) as f32;
        let room = ROUNDINGS * reach;
        let draft = layout::lay_out(&binary, corners, step, room);
        let tree = Self {
            nodes: Table::new(draft.nodes),
            leaves: Table::new(draft.leaves),
            stack: draft.stack,
            step,
            room,
        };
        Ok((tree, draft.places))
    }

    /// Turns some triangles inside out.
    pub(super) fn turn(&mut self, which: impl Fn(usize) -> bool) {
        for (index, leaf) in self.leaves.entries_mut().iter_mut().enumerate() {
            for k in (0..leaf.count()).filter(|k| which(SIZE * index + k)) {
                leaf.turn(k);
            }
        }
    }

    /// Labels the triangles; before, every one is of all kinds.
    ///
    /// * `of`: by place.
    pub(super) fn label(&mut self, of: impl Fn(usize) -> Label) {
        for (index, leaf) in self.leaves.entries_mut().iter_mut().enumerate() {
            let count = leaf.count();
            leaf.holds = [0; KINDS];
            for k in 0..count {
                let label = of(SIZE * index + k);
                let [outside, inside] = label.sides;
                leaf.holds[outside as usize] |= 1 << k;
                leaf.holds[inside as usize] |= 0x10 << k;
                leaf.holds[kind_of(label.bound)] |= 0x11 << k;
                leaf.holds[KINDS - 1] |= 0x11 << k;
                leaf.labels[k] = label;
            }
        }
        // Children come after their parents.
        for index in (0..self.nodes.len()).rev() {
            let mut holds = [0; KINDS];
            for k in 0..self.nodes[index].count() {
                let child = self.nodes[index].child(k);
                let below = match child & LEAF {
                    0 => &self.nodes[child as usize].holds,
                    _ => &self.leaves[(child & !LEAF) as usize].holds,
                };
                for (holds, below) in holds.iter_mut().zip(below) {
                    *holds |= u8::from(*below != 0) << k;
                }
            }
            self.nodes[index].holds = holds;
        }
    }

    /// Shows the caller all triangles of some kinds that a ray may meet in front of a limit, near ones
    /// as a rule first, perhaps more than once.
    ///
    /// * `test`: the new limit if it is to be nearer.
    #[inline(always)]
    pub(super) fn visit<'a>(
        &'a self,
        origin: DVec3,
        dir: DVec3,
        limit: f64,
        kinds: Kinds,
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let ray = Ray::new(origin.as_vec3(), dir.as_vec3());
        if self.stack <= STACK {
            ASIDE.with_borrow_mut(|aside| self.walk(&ray, limit, kinds, aside, test));
        } else {
            self.walk(&ray, limit, kinds, &mut vec![(0, 0.0); self.stack], test);
        }
    }

    #[inline(always)]
    fn walk<'a>(
        &'a self,
        ray: &Ray,
        limit: f64,
        kinds: Kinds,
        aside: &mut [(u32, f32)],
        mut test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        let cut = |t: f64| t as f32 * (1.0 + 4.0 * f32::EPSILON) + self.room;
        let mut limit = cut(limit);
        let mut height = 0;
        let mut next = 0;
        loop {
            if next & LEAF == 0 {
                let node = &self.nodes[next as usize];
                let (mut hit, begin) = node.meets(ray, self.room, limit);
                hit &= u32::from(kinds.held(&node.holds));
                if hit != 0 {
                    let begin: [f32; 8] = {
                        let [a, b] = begin.map(|b| b.to_array());
                        [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]]
                    };
                    let first = hit.trailing_zeros() as usize;
                    hit &= hit - 1;
                    let mut least = (first, begin[first & 7]);
                    while hit != 0 {
                        let k = hit.trailing_zeros() as usize;
                        hit &= hit - 1;
                        let mut other = (k, begin[k & 7]);
                        if other.1 < least.1 {
                            std::mem::swap(&mut least, &mut other);
                        }
                        aside[height] = (node.child(other.0), other.1);
                        height += 1;
                    }
                    next = node.child(least.0);
                    continue;
                }
            } else {
                let number = (next & !LEAF) as usize;
                let leaf = &self.leaves[number];
                let mut met = leaf.meets(ray, self.step as f32, self.room, limit, kinds);
                while met != 0 {
                    let k = met.trailing_zeros() as usize;
                    met &= met - 1;
                    if let Some(t) = test(Candidate {
                        leaf,
                        number,
                        k: k & 3,
                        step: self.step,
                    }) {
                        limit = cut(t);
                    }
                }
            }
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                let (child, begin) = aside[height];
                if begin <= limit {
                    next = child;
                    break;
                }
            }
        }
    }
}

/// A triangle that a ray may meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<'a> {
    leaf: &'a Leaf,
    number: usize,
    k: usize,
    step: f64,
}

impl Candidate<'_> {
    /// Its place.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        SIZE * self.number + self.k
    }

    /// Its label, once it has one.
    #[inline(always)]
    pub(super) fn label(self) -> Label {
        self.leaf.labels[self.k]
    }

    #[inline(always)]
    pub(super) fn corners(self) -> [DVec3; 3] {
        self.leaf.corners(self.k, self.step)
    }

    /// Whether it is of some kind, entered or left.
    #[inline(always)]
    pub(super) fn is_of(self, kinds: Kinds, enters: bool) -> bool {
        let up = if enters { self.k } else { self.k + 4 };
        kinds.held(&self.leaf.holds) >> up & 1 != 0
    }
}

/// A ray in single precision, each number four times.
struct Ray {
    origin: [Vec4; 3],
    dir: [Vec4; 3],
    inverse: [Vec4; 3],
    /// Origin times inverse.
    start: [Vec4; 3],
    /// Which plane of a box is met last along each axis.
    down: [usize; 3],
}

impl Ray {
    fn new(origin: Vec3, dir: Vec3) -> Self {
        // So that nothing is infinite, and nothing times zero undefined.
        let slope = dir
            .to_array()
            .map(|d| if d.abs() < 1e-18 { 1e-18 } else { d });
        let inverse = slope.map(|d| 1.0 / d);
        let o = origin.to_array();
        Self {
            origin: o.map(Vec4::splat),
            dir: dir.to_array().map(Vec4::splat),
            inverse: inverse.map(Vec4::splat),
            start: [0, 1, 2].map(|k| Vec4::splat(o[k] * inverse[k])),
            down: slope.map(|d| usize::from(d < 0.0)),
        }
    }
}
