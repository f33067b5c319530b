//! One search after the other, or several by turns: what a search does at a node and at a leaf.

use super::leaf::Leaf;
use super::node::CHILDREN;
use super::ray::Line;
use super::{Candidate, Kind, LEAF, SIZE, Shear, Tree};
use crate::accel::lanes::{Aside, Lanes, room_for};

/// Lines of a cache that a node takes; a leaf takes one less.
const LINES: usize = 3;
/// In the place of a node or a leaf: nothing is left.
const END: u32 = u32::MAX;

/// A search on its way through a tree.
#[derive(Clone, Debug)]
pub(in super::super) struct Walk {
    line: Line,
    limit: f32,
    kind: usize,
    /// A node, a leaf or [`END`].
    next: u32,
    /// How many are set aside; the first is [`END`].
    count: usize,
    /// Children or triangles that the ray meets there, a bit each, and where it comes to the children.
    met: u32,
    begins: [f32; CHILDREN],
}

impl Walk {
    /// * `limit`: in radii. * `aside`: room for [`Tree::room_aside`], to be handed on to each step.
    #[inline(always)]
    pub(in super::super) fn new(
        tree: &Tree,
        ray: &Shear,
        limit: f64,
        kind: Kind,
        aside: &mut [Aside],
    ) -> Self {
        aside[0] = Aside::new(0.0, END);
        Self {
            line: Line::new(ray, &tree.grid, tree.step, tree.room),
            limit: tree.cut(limit),
            kind: kind.0,
            next: if tree.nodes.is_empty() { END } else { 0 },
            count: 1,
            met: 0,
            begins: [0.0; CHILDREN],
        }
    }

    #[inline(always)]
    pub(in super::super) fn is_at_node(&self) -> bool {
        self.next & LEAF == 0
    }

    #[inline(always)]
    pub(in super::super) fn is_through(&self) -> bool {
        self.next == END
    }

    /// Has what is looked at next brought near, without waiting for it; for [`END`] asks for what is not there, which
    /// does no harm.
    #[inline(always)]
    pub(in super::super) fn fetch(&self, tree: &Tree) {
        let tables = [tree.nodes.place(), tree.leaves.place()];
        tables[usize::from(!self.is_at_node())].fetch::<LINES>(self.leaf());
    }

    /// At a node: which children the ray meets.
    #[inline(always)]
    pub(in super::super) fn see_children<L: Lanes>(&mut self, tree: &Tree) {
        let node = &tree.nodes[self.next as usize];
        let (met, begins) = node.meets::<L>(&self.line, self.limit, self.kind);
        self.met = met;
        self.begins = L::eight(begins);
    }

    /// Goes on from there, without a branch: which children a ray meets is chance.
    #[inline(always)]
    pub(in super::super) fn leave_node<L: Lanes>(&mut self, tree: &Tree, aside: &mut [Aside]) {
        let node = &tree.nodes[self.next as usize];
        let row = room_for(aside, self.count);
        self.count += L::row(self.met, &self.begins, &node.children, row);
        self.next_aside(aside);
    }

    #[inline(always)]
    fn leaf(&self) -> usize {
        (self.next & !LEAF) as usize
    }

    /// Goes on with what was set aside last.
    #[inline(always)]
    fn next_aside(&mut self, aside: &[Aside]) {
        self.count -= 1;
        self.next = aside[self.count].number() as u32;
    }

    /// At a leaf: which triangles the ray may meet.
    #[inline(always)]
    pub(in super::super) fn see_triangles<L: Lanes>(&mut self, tree: &Tree) {
        // As a rule one is met, and its label is read.
        tree.labels.fetch(self.leaf());
        self.met = tree.leaves[self.leaf()].meets::<L>(&self.line, self.kind);
    }

    /// Goes on from there when `test` has seen these.
    ///
    /// * `test`: the new limit if it is to be nearer.
    #[inline(always)]
    pub(in super::super) fn leave_leaf<'a>(
        &mut self,
        tree: &'a Tree,
        aside: &mut [Aside],
        mut test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        let number = self.leaf();
        let leaf: &Leaf = &tree.leaves[number];
        let mut met = self.met;
        if met != 0 {
            let mut limit = None;
            while met != 0 {
                let k = met.trailing_zeros() as usize % SIZE;
                met &= met - 1;
                limit = test(Candidate {
                    leaf,
                    label: &tree.labels[number].0[k],
                    place: SIZE * number + k,
                    step: tree.step,
                })
                .or(limit);
            }
            if let Some(limit) = limit {
                self.limit = tree.cut(limit);
                self.leave_far(aside);
            }
        }
        self.next_aside(aside);
    }

    /// Forgets what is beyond the limit.
    #[inline(always)]
    fn leave_far(&mut self, aside: &mut [Aside]) {
        let mut kept = 1;
        for k in 1..self.count {
            let other = aside[k];
            aside[kept] = other;
            kept += usize::from(other.distance() <= self.limit);
        }
        self.count = kept;
    }
}

impl Tree {
    /// The most that a search sets aside: the children of each node on the way from the root, and the end.
    pub(in super::super) fn room_aside(&self) -> usize {
        CHILDREN * self.depth + 1
    }

    /// A limit in single precision, with room for rounding.
    #[inline(always)]
    fn cut(&self, t: f64) -> f32 {
        t as f32 * (1.0 + 4.0 * f32::EPSILON) + self.room
    }
}
