//! A tree over strands: nodes of sixteen boxes, leaves of eight segments.
//!
//! A search waits for memory and for what the one step says of the next, so everything is small: a node is three lines of
//! a cache and a leaf two, and a leaf holds all that decides what a ray meets. The answer does not depend on the
//! shape of the tree, nor on the processor.

mod bounds;
mod build;
mod cut;
mod leaf;
mod line;
mod node;
mod search;

use super::ribbon::Segment;
use crate::accel::Ray;
use crate::pages::Table;
use glam::Vec4;
use leaf::Leaf;
use line::Ball;
use node::Node;

/// One or two segments of a strand, one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// The joint at which it begins.
    pub(super) joint: u32,
    pub(super) segments: u8,
    /// Whether the strand ends with it.
    pub(super) is_last: bool,
}

/// Nodes one below the other at most: in the lowest ones runs are halved evenly, whatever that costs.
const DEPTH: usize = 16;

/// Runs that are not there on the first bit of a ray: from `first` to before `end`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ignored {
    pub(super) first: u32,
    pub(super) end: u32,
    /// Distance along the ray.
    pub(super) clear: f32,
}

/// A segment met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Distance along the ray, millimeters.
    pub t: f32,
    pub(super) run: u32,
    /// First or second segment of the run.
    pub(super) half: u32,
    /// Where the run lies: its leaf and its place there.
    place: u32,
}

/// Runs behind boxes.
pub(super) struct Tree {
    nodes: Table<Node>,
    leaves: Table<Leaf>,
    ball: Ball,
    /// Leaf of each run and its place there.
    places: Vec<u32>,
}

impl Tree {
    /// * `joints`: of the scene, half width in w; finite and at most a kilometer away.
    /// * `runs`: at most 2^27. * `copies`: those that are left out, in order, each with the one that it is like.
    pub(super) fn build(joints: &[Vec4], runs: &[Run], copies: &[(u32, u32)]) -> Self {
        let mut copied = copies.iter().map(|&(run, _)| run).peekable();
        let kept = (0..runs.len() as u32).filter(|run| copied.next_if_eq(run).is_none());
        let ball = Ball::around(joints);
        let draft = build::build(joints, runs, kept.collect(), ball.blur());
        let mut places = vec![0; runs.len()];
        for l in 0..draft.leaves.len() {
            for (k, run) in draft.leaves[l].numbers() {
                places[run as usize] = (l * leaf::RUNS + k) as u32;
            }
        }
        for &(run, like) in copies {
            places[run as usize] = places[like as usize];
        }
        Self {
            nodes: draft.nodes,
            leaves: draft.leaves,
            ball,
            places,
        }
    }

    /// Number of leaves.
    pub(super) fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// All joints of the runs in some leaves, each joint of a strand once.
    pub(super) fn joints(&self, leaves: std::ops::Range<usize>) -> impl Iterator<Item = Vec4> + '_ {
        leaves.flat_map(|leaf| self.leaves[leaf].joints())
    }

    /// The joint of a run, `0..=2`.
    #[inline]
    pub(super) fn joint(&self, run: u32, joint: usize) -> Vec4 {
        self.joint_at(self.places[run as usize], joint)
    }

    #[inline]
    fn joint_at(&self, place: u32, joint: usize) -> Vec4 {
        let place = place as usize;
        self.leaves[place / leaf::RUNS].joint(place % leaf::RUNS, joint)
    }

    /// The segment that was met, to the bit as rays meet it: where two runs join, each has the joint rounded in its own
    /// way.
    #[inline]
    pub(super) fn segment(&self, found: &Found) -> Segment {
        let half = found.half as usize;
        Segment {
            root: self.joint_at(found.place, half),
            tip: self.joint_at(found.place, half + 1),
        }
    }

    /// The nearest segment up to `limit`; of equal distances the first segment.
    pub(super) fn closest(&self, ray: &Ray, limit: f32, ignored: Option<Ignored>) -> Option<Found> {
        search::search::<false>(self, ray, limit, ignored)
    }

    /// Whether any segment is met up to `limit`.
    pub(super) fn any(&self, ray: &Ray, limit: f32, ignored: Option<Ignored>) -> bool {
        search::search::<true>(self, ray, limit, ignored).is_some()
    }
}

#[cfg(test)]
mod tests;
