//! From the root of a tree to the triangles that a ray may meet.
//!
//! Most rays meet one child of a node: then there is nothing to set aside.

use super::leaf::Leaf;
use super::node::{CHILDREN, Node};
use super::ray::Line;
use super::{Candidate, LEAF, SIZE, Shear, Tree};
use crate::accel::lanes::{Aside, Lanes, Plain};
#[cfg(target_arch = "x86_64")]
use crate::accel::lanes::{Avx2, Avx512, has_avx2, has_avx512};
#[cfg(test)]
use crate::fiber::triangles::shear::Meeting;
use std::cell::RefCell;

/// Nodes one below the other for which there is room that is kept.
const DEPTH: usize = 24;
/// Room for what is set aside: the children of each node on the way from the root.
const ROOM: usize = CHILDREN * DEPTH;

thread_local! {
    // Kept: to fill it anew would take longer than a search.
    static ASIDE: RefCell<[Aside; ROOM]> = const { RefCell::new([Aside::NONE; ROOM]) };
}

/// What a search is asked.
pub(super) struct Query<'a, 'r> {
    pub(super) tree: &'a Tree,
    pub(super) ray: &'r Shear,
    pub(super) limit: f64,
    pub(super) kind: usize,
}

impl<'a> Query<'a, '_> {
    /// Shows all triangles that the ray may meet to `test`, which gives the new limit if that is to be nearer.
    #[inline(always)]
    pub(super) fn answer(&self, test: impl FnMut(Candidate<'a>) -> Option<f64>) {
        if self.tree.depth <= DEPTH {
            ASIDE.with_borrow_mut(|aside| self.on_this_processor(aside, test));
        } else {
            let mut aside = vec![Aside::NONE; CHILDREN * self.tree.depth];
            self.on_this_processor(&mut aside, test);
        }
    }

    #[inline(always)]
    fn on_this_processor(
        &self,
        aside: &mut [Aside],
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            #[allow(unsafe_code, reason = "measured faster; the processor was asked")]
            // SAFETY: the processor has what the functions enable.
            return unsafe {
                match has_avx512() {
                    true => self.avx512(aside, test),
                    false => self.avx2(aside, test),
                }
            };
        }
        self.walk::<Plain>(aside, test);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,popcnt,lzcnt")]
    fn avx2(&self, aside: &mut [Aside], test: impl FnMut(Candidate<'a>) -> Option<f64>) {
        self.walk::<Avx2>(aside, test);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,popcnt,lzcnt")]
    fn avx512(&self, aside: &mut [Aside], test: impl FnMut(Candidate<'a>) -> Option<f64>) {
        self.walk::<Avx512>(aside, test);
    }

    #[inline(always)]
    fn walk<L: Lanes>(
        &self,
        aside: &mut [Aside],
        mut test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        let tree = self.tree;
        let nodes = tree.nodes.entries();
        let line = Line::new(self.ray, &tree.grid, tree.step, tree.room);
        let cut = |t: f64| t as f32 * (1.0 + 4.0 * f32::EPSILON) + tree.room;
        let mut limit = cut(self.limit);
        let mut count = 0;
        let mut next = 0;
        loop {
            if next & LEAF == 0 {
                let node = &nodes[next as usize];
                let (met, begins) = node.meets::<L>(&line, limit, self.kind);
                // Most often one.
                if met.is_power_of_two() {
                    next = node.child(met.trailing_zeros());
                    continue;
                }
                if met != 0 {
                    count += line_up(met, &L::eight(begins), node, row(aside, count));
                }
            } else {
                let number = (next & !LEAF) as usize;
                let leaf: &Leaf = &tree.leaves[number];
                let mut met = leaf.meets::<L>(&line, self.kind);
                if met != 0 {
                    tree.labels.fetch(number);
                }
                while met != 0 {
                    let k = met.trailing_zeros() as usize % SIZE;
                    met &= met - 1;
                    if let Some(t) = test(Candidate {
                        leaf,
                        label: &tree.labels[number].0[k],
                        place: SIZE * number + k,
                        step: tree.step,
                    }) {
                        limit = cut(t);
                    }
                }
            }
            loop {
                if count == 0 {
                    return;
                }
                count -= 1;
                if aside[count].distance() <= limit {
                    break;
                }
            }
            next = aside[count].number() as u32;
        }
    }
}

/// Puts the chosen of a node's children in a row, the nearest last, and says how many.
///
/// * `begins`: where the ray enters their boxes, not negative.
#[inline(always)]
fn line_up(
    mut chosen: u32,
    begins: &[f32; CHILDREN],
    node: &Node,
    row: &mut [Aside; CHILDREN],
) -> usize {
    let mut count = 0;
    while chosen != 0 {
        let k = chosen.trailing_zeros();
        chosen &= chosen - 1;
        let other = Aside::new(begins[k as usize % CHILDREN], node.child(k));
        let mut at = count;
        while at > 0 && row[at - 1] < other {
            row[at] = row[at - 1];
            at -= 1;
        }
        row[at] = other;
        count += 1;
    }
    count
}

/// Room for a row from a place on.
#[inline(always)]
fn row(all: &mut [Aside], from: usize) -> &mut [Aside; CHILDREN] {
    all[from..]
        .first_chunk_mut()
        .expect("room for a row beyond the last")
}

/// What a ray meets: the bits of the distance, triangle and side, in order.
#[cfg(test)]
pub(super) type Met = Vec<(u64, u32, bool)>;

/// What a ray meets of a kind up to a limit, or what of it is nearest, by the search that each processor does that this
/// one can be.
#[cfg(test)]
pub(super) fn on_each_processor<'a>(
    tree: &'a Tree,
    ray: &Shear,
    limit: f64,
    kind: super::Kind,
    nearest: bool,
) -> Vec<(&'static str, Met)> {
    let query = Query {
        tree,
        ray,
        limit,
        kind: kind.0,
    };
    let mut all = Vec::new();
    let mut run = |processor, search: &Search<'_, 'a>| {
        let mut best = f64::INFINITY;
        let mut met = Vec::new();
        let mut test = |triangle: Candidate<'a>| {
            let Meeting { t, enters } = ray.meet(&triangle.corners())?;
            if !(t >= 0.0 && t <= limit && triangle.is_of(kind, enters)) {
                return None;
            }
            met.push(((t + 0.0).to_bits(), triangle.label().source, enters));
            best = best.min(t);
            nearest.then_some(best)
        };
        ASIDE.with_borrow_mut(|aside| search(aside, &mut test));
        met.retain(|m| !nearest || f64::from_bits(m.0) <= best);
        met.sort_unstable();
        // A triangle may be in several leaves.
        met.dedup();
        all.push((processor, met));
    };
    run("this processor", &|aside, test| {
        query.on_this_processor(aside, test)
    });
    run("any processor", &|aside, test| {
        query.walk::<Plain>(aside, test)
    });
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        run("AVX2", &|aside, test| {
            #[allow(unsafe_code, reason = "the processor was asked")]
            // SAFETY: the processor has what the function enables.
            unsafe {
                query.avx2(aside, test);
            }
        });
    }
    all
}

/// A search of [`on_each_processor`].
#[cfg(test)]
type Search<'s, 'a> = dyn Fn(&mut [Aside], &mut dyn FnMut(Candidate<'a>) -> Option<f64>) + 's;
