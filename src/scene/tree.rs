//! A tree over strands: nodes of sixteen boxes, leaves of eight segments.
//!
//! A search waits for memory more than for anything else, so everything is small: a node is three lines of a
//! cache and a leaf two, and a leaf holds all that decides what a ray meets. The answer does not depend on the
//! shape of the tree, nor on the processor.

mod build;
mod lanes;
mod leaf;
mod node;

pub(super) use lanes::Lanes;

use super::ribbon::Segment;
use crate::accel::Ray;
use crate::pages::Table;
use glam::Vec4;
use lanes::Plain;
use leaf::Leaf;
use node::{CHILDREN, LEAF, Line, Node, PAIR};

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
/// No reference.
const NONE: u32 = u32::MAX;
/// References set aside at most.
const STACK: usize = DEPTH * (CHILDREN - 1) + 1;

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
pub(super) struct Found {
    pub(super) t: f32,
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
    /// Leaf of each run and its place there.
    places: Vec<u32>,
}

impl Tree {
    /// * `joints`: of the scene, half width in w; finite and at most a kilometer away.
    /// * `runs`: at most 2^27. * `copies`: those that are left out, in order, each with the one that it is like.
    pub(super) fn build(joints: &[Vec4], runs: &[Run], copies: &[(u32, u32)]) -> Self {
        let mut copied = copies.iter().map(|&(run, _)| run).peekable();
        let kept = (0..runs.len() as u32).filter(|run| copied.next_if_eq(run).is_none());
        let draft = build::build(joints, runs, kept.collect());
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
    ///
    /// * `met`: told of every run that was the nearest when it was met.
    pub(super) fn closest(
        &self,
        ray: &Ray,
        limit: f32,
        ignored: Option<Ignored>,
        met: impl Fn(u32),
    ) -> Option<Found> {
        self.search::<false>(ray, limit, ignored, met)
    }

    /// Whether any segment is met up to `limit`.
    pub(super) fn any(&self, ray: &Ray, limit: f32, ignored: Option<Ignored>) -> bool {
        self.search::<true>(ray, limit, ignored, |_| ()).is_some()
    }

    #[inline(always)]
    fn search<const ANY: bool>(
        &self,
        ray: &Ray,
        limit: f32,
        ignored: Option<Ignored>,
        met: impl Fn(u32),
    ) -> Option<Found> {
        let line = Line {
            origin: ray.origin,
            dir: ray.dir,
        };
        let ignored = ignored.unwrap_or(Ignored {
            first: 0,
            end: 0,
            clear: 0.0,
        });
        if self.nodes.is_empty() {
            return None;
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("lzcnt")
        {
            #[allow(unsafe_code, reason = "measured faster; the processor was asked")]
            // SAFETY: the processor has what the function enables.
            return unsafe { self.search_avx2::<ANY>(&line, limit, &ignored, met) };
        }
        self.walk::<Plain, ANY>(&line, limit, &ignored, met)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,popcnt,lzcnt")]
    fn search_avx2<const ANY: bool>(
        &self,
        ray: &Line,
        limit: f32,
        ignored: &Ignored,
        met: impl Fn(u32),
    ) -> Option<Found> {
        self.walk::<lanes::Avx2, ANY>(ray, limit, ignored, met)
    }

    #[inline(always)]
    fn walk<L: Lanes, const ANY: bool>(
        &self,
        ray: &Line,
        mut limit: f32,
        ignored: &Ignored,
        met_run: impl Fn(u32),
    ) -> Option<Found> {
        let mut found = None;
        // What is set aside, the nearest last, each with the distance of its box.
        let mut aside = [(0.0f32, 0u32); STACK];
        let mut count = 0;
        let mut next = 0u32;
        // Leaves that are looked at one step later, when they have come into the cache. The further search goes a
        // little too far for it, but hardly waits.
        let mut waiting = NONE;
        loop {
            if next & LEAF == 0 {
                let node = &self.nodes[next as usize];
                let (mut met, begin) = node.meets::<L>(ray, limit);
                if met != 0 {
                    let [low, high] = begin;
                    let begin = [L::array(low), L::array(high)];
                    let take = |met: &mut u32| {
                        let k = met.trailing_zeros();
                        *met &= *met - 1;
                        let child = node.child(k);
                        self.fetch(child);
                        (begin[(k as usize / 8) % 2][k as usize % 8], child)
                    };
                    let mut nearest = take(&mut met);
                    let bottom = count;
                    while met != 0 {
                        let mut other = take(&mut met);
                        if other.0 < nearest.0 {
                            std::mem::swap(&mut other, &mut nearest);
                        }
                        let mut at = count;
                        while at > bottom && aside[at - 1].0 < other.0 {
                            aside[at] = aside[at - 1];
                            at -= 1;
                        }
                        aside[at] = other;
                        count += 1;
                    }
                    next = nearest.1;
                    continue;
                }
            } else {
                std::mem::swap(&mut next, &mut waiting);
                if next != NONE && self.look::<L>(next, ray, ignored, &mut limit, &mut found) {
                    if ANY {
                        return found;
                    }
                    if let Some(found) = &found {
                        met_run(found.run);
                    }
                }
            }
            loop {
                if count == 0 {
                    if waiting != NONE
                        && self.look::<L>(waiting, ray, ignored, &mut limit, &mut found)
                        && let Some(found) = &found
                    {
                        met_run(found.run);
                    }
                    return found;
                }
                count -= 1;
                let (begin, other) = aside[count];
                if begin <= limit {
                    next = other;
                    break;
                }
            }
        }
    }

    /// Asks for what will be looked at next or soon.
    #[inline(always)]
    fn fetch(&self, child: u32) {
        match child & LEAF {
            0 => self.nodes.fetch(child as usize),
            _ => self.leaves.fetch((child & !(LEAF | PAIR)) as usize),
        }
    }

    /// Whether a segment of one or two leaves was met that is nearer than what was found before.
    #[inline(always)]
    fn look<L: Lanes>(
        &self,
        leaves: u32,
        ray: &Line,
        ignored: &Ignored,
        limit: &mut f32,
        found: &mut Option<Found>,
    ) -> bool {
        let first = leaves & !(LEAF | PAIR);
        let mut nearer = self.meet::<L>(first, ray, ignored, limit, found);
        if leaves & PAIR != 0 {
            nearer |= self.meet::<L>(first + 1, ray, ignored, limit, found);
        }
        nearer
    }

    /// Whether a segment of a leaf was met that is nearer than what was found before.
    #[inline(always)]
    fn meet<L: Lanes>(
        &self,
        number: u32,
        ray: &Line,
        ignored: &Ignored,
        limit: &mut f32,
        found: &mut Option<Found>,
    ) -> bool {
        let leaf = &self.leaves[number as usize];
        let (mut met, t) = leaf.meets::<L>(ray, *limit);
        if met == 0 {
            return false;
        }
        let mut nearer = false;
        let t = L::array(t);
        while met != 0 {
            let lane = met.trailing_zeros();
            met &= met - 1;
            let t = t[lane as usize & 7];
            let (run, half) = (leaf.run(lane), lane / 4);
            let is_first = match found {
                Some(old) => t < old.t || (t == old.t && (run, half) < (old.run, old.half)),
                None => true,
            };
            if is_first && !(t < ignored.clear && (ignored.first..ignored.end).contains(&run)) {
                *limit = t;
                nearer = true;
                let place = number * leaf::RUNS as u32 + lane % leaf::RUNS as u32;
                *found = Some(Found {
                    t,
                    run,
                    half,
                    place,
                });
            }
        }
        nearer
    }
}

#[cfg(test)]
mod tests;
