//! From the root of a tree to the triangles that a ray may meet.
//!
//! A search waits for memory and for what the one step says of the next. So what it will look at is asked for early, and
//! leaves are looked at a step later, when they have arrived.

use super::leaf::Leaf;
use super::ray::Line;
use super::{Candidate, Kinds, SIZE, Tree};
use crate::accel::lanes::{Aside, CHILDREN, Lanes, Plain};
#[cfg(target_arch = "x86_64")]
use crate::accel::lanes::{Avx2, Avx512, has_avx2, has_avx512};
#[cfg(test)]
use crate::fiber::triangles::shear::{Meeting, Shear};
use crate::pages::fetch;
use std::cell::RefCell;

/// Nodes one below the other that the room that is kept is large enough for.
const DEPTH: usize = 20;
/// Children set aside for each node on the way from the root.
const EACH: usize = CHILDREN;

/// Room for what is set aside, with some for rows that are not full.
struct Room {
    nodes: [Aside; DEPTH * EACH + CHILDREN],
    leaves: Ripening,
}

/// Leaves found in the step before and in this one.
type Ripening = [[Aside; 2 * CHILDREN]; 2];

thread_local! {
    // Kept: to fill it anew would take longer than a search.
    static ROOM: RefCell<Room> = const {
        RefCell::new(Room {
            nodes: [Aside::NONE; DEPTH * EACH + CHILDREN],
            leaves: [[Aside::NONE; 2 * CHILDREN]; 2],
        })
    };
}

/// What a search is asked.
pub(super) struct Query<'a> {
    pub(super) tree: &'a Tree,
    pub(super) line: Line,
    pub(super) limit: f64,
    pub(super) kinds: Kinds,
}

impl<'a> Query<'a> {
    /// Shows all triangles that the ray may meet to `test`, which gives the new limit if that is to be nearer.
    #[inline(always)]
    pub(super) fn answer(&self, test: impl FnMut(Candidate<'a>) -> Option<f64>) {
        ROOM.with_borrow_mut(|room| {
            let Room { nodes, leaves } = room;
            if self.tree.depth <= DEPTH {
                self.on_this_processor(nodes, leaves, test);
            } else {
                let mut nodes = vec![Aside::NONE; self.tree.depth * EACH + CHILDREN];
                self.on_this_processor(&mut nodes, leaves, test);
            }
        });
    }

    #[inline(always)]
    fn on_this_processor(
        &self,
        nodes: &mut [Aside],
        leaves: &mut Ripening,
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            #[allow(unsafe_code, reason = "measured faster; the processor was asked")]
            // SAFETY: the processor has what the functions enable.
            return unsafe {
                match has_avx512() {
                    true => self.avx512(nodes, leaves, test),
                    false => self.avx2(nodes, leaves, test),
                }
            };
        }
        self.walk::<Plain>(nodes, leaves, test);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,popcnt,lzcnt")]
    fn avx2(
        &self,
        nodes: &mut [Aside],
        leaves: &mut Ripening,
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        self.walk::<Avx2>(nodes, leaves, test);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,popcnt,lzcnt")]
    fn avx512(
        &self,
        nodes: &mut [Aside],
        leaves: &mut Ripening,
        test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        self.walk::<Avx512>(nodes, leaves, test);
    }

    #[inline(always)]
    fn walk<L: Lanes>(
        &self,
        aside: &mut [Aside],
        leaves: &mut Ripening,
        mut test: impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        let tree = self.tree;
        let nodes = tree.nodes.entries();
        let mut limit = self.cut(self.limit);
        let [ripe, found] = leaves;
        let (mut ripe, mut found) = (ripe, found);
        let mut ripe_count = 0;
        let mut count = 1;
        aside[0] = Aside::NONE;
        loop {
            while count > 0 && aside[count - 1].distance() > limit {
                count -= 1;
            }
            if count == 0 {
                self.look::<L>(&ripe[..ripe_count], &mut limit, &mut test);
                return;
            }
            count -= 1;
            let node = &nodes[aside[count].number()];
            let (met, begins) = node.meets::<L>(&self.line, limit, self.kinds);
            let (chosen, children) = node.inner(met);
            count += L::line_up(chosen, begins, children, row(aside, count));
            let (chosen, children) = node.leaves(met);
            let found_count = L::line_up(chosen, begins, children, row(found, 0));
            for leaf in &found[..found_count] {
                fetch(&tree.leaves[leaf.number()]);
            }
            for k in 1..=2 {
                // Where nothing is set aside, what an earlier search left there.
                if let Some(node) = nodes.get(aside[count.saturating_sub(k)].number()) {
                    fetch(node);
                }
            }
            self.look::<L>(&ripe[..ripe_count], &mut limit, &mut test);
            std::mem::swap(&mut ripe, &mut found);
            ripe_count = found_count;
        }
    }

    /// Looks at leaves, the last first.
    #[inline(always)]
    fn look<L: Lanes>(
        &self,
        ripe: &[Aside],
        limit: &mut f32,
        test: &mut impl FnMut(Candidate<'a>) -> Option<f64>,
    ) {
        for one in ripe.iter().rev() {
            if one.distance() > *limit {
                continue;
            }
            let number = one.number();
            let leaf: &Leaf = &self.tree.leaves[number];
            let mut met = leaf.meets::<L>(&self.line, self.kinds);
            if met == 0 {
                continue;
            }
            let labels = &self.tree.labels[number];
            fetch(labels);
            while met != 0 {
                let k = met.trailing_zeros() as usize % SIZE;
                met &= met - 1;
                if let Some(t) = test(Candidate {
                    leaf,
                    label: &labels.0[k],
                    place: SIZE * number + k,
                    step: self.tree.step,
                }) {
                    *limit = self.cut(t);
                }
            }
        }
    }

    /// A distance with room for rounding.
    #[inline(always)]
    fn cut(&self, t: f64) -> f32 {
        t as f32 * (1.0 + 4.0 * f32::EPSILON) + self.line.room
    }
}

/// Room for a row from a place on.
#[inline(always)]
fn row(all: &mut [Aside], from: usize) -> &mut [Aside; CHILDREN] {
    all[from..]
        .first_chunk_mut()
        .expect("room for a row beyond the last")
}

/// What a ray meets of some kinds up to a limit, or what of it is nearest, by the search that each processor does that
/// this one can be: the bits of the distance, triangle and side, in order.
#[cfg(test)]
pub(super) fn on_each_processor<'a>(
    tree: &'a Tree,
    ray: &Shear,
    limit: f64,
    kinds: Kinds,
    nearest: bool,
) -> Vec<(&'static str, Vec<(u64, u32, bool)>)> {
    let query = Query {
        tree,
        line: Line::new(ray, tree.step, tree.room),
        limit,
        kinds,
    };
    let mut all = Vec::new();
    let mut run = |processor, search: &Search<'_, 'a>| {
        let mut best = f64::INFINITY;
        let mut met = Vec::new();
        let mut test = |triangle: Candidate<'a>| {
            let Meeting { t, enters } = ray.meet(&triangle.corners())?;
            if !(t >= 0.0 && t <= limit && triangle.is_of(kinds, enters)) {
                return None;
            }
            met.push(((t + 0.0).to_bits(), triangle.label().source, enters));
            best = best.min(t);
            nearest.then_some(best)
        };
        ROOM.with_borrow_mut(|Room { nodes, leaves }| search(nodes, leaves, &mut test));
        met.retain(|m| !nearest || f64::from_bits(m.0) <= best);
        met.sort_unstable();
        // A triangle may be in several leaves.
        met.dedup();
        all.push((processor, met));
    };
    run("this processor", &|nodes, leaves, test| {
        query.on_this_processor(nodes, leaves, test)
    });
    run("any processor", &|nodes, leaves, test| {
        query.walk::<Plain>(nodes, leaves, test)
    });
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        run("AVX2", &|nodes, leaves, test| {
            #[allow(unsafe_code, reason = "the processor was asked")]
            // SAFETY: the processor has what the function enables.
            unsafe {
                query.avx2(nodes, leaves, test);
            }
        });
    }
    all
}

/// A search of [`on_each_processor`].
#[cfg(test)]
type Search<'s, 'a> =
    dyn Fn(&mut [Aside], &mut Ripening, &mut dyn FnMut(Candidate<'a>) -> Option<f64>) + 's;
