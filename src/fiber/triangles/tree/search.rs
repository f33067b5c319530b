//! From the root of a tree to the triangles that a ray may meet, one ray after the other.

use super::node::CHILDREN;
use super::walk::Walk;
use super::{Candidate, Kind, Shear, Tree};
#[cfg(all(test, target_arch = "x86_64"))]
use crate::accel::lanes::on_avx2;
use crate::accel::lanes::{Aside, Lanes, Task, on_this_processor};
use std::cell::RefCell;
#[cfg(test)]
use {crate::accel::lanes::Plain, crate::fiber::triangles::shear::Meeting};

/// Nodes one below the other for which there is room that is kept.
const DEPTH: usize = 24;
/// Room for what is set aside in a tree of that depth.
const ROOM: usize = CHILDREN * DEPTH + 1;

thread_local! {
    // Kept: to fill it anew would take longer than a search.
    static ASIDE: RefCell<[Aside; ROOM]> = const { RefCell::new([Aside::NONE; ROOM]) };
}

/// What a search is asked.
#[derive(Clone, Copy)]
pub(super) struct Query<'a, 'r> {
    pub(super) tree: &'a Tree,
    pub(super) ray: &'r Shear,
    pub(super) limit: f64,
    pub(super) kind: Kind,
}

impl<'a> Query<'a, '_> {
    /// Shows all triangles that the ray may meet to `test`, which gives the new limit if that is to be nearer.
    #[inline(always)]
    pub(super) fn answer(self, test: impl FnMut(Candidate<'a>) -> Option<f64>) {
        let search = |aside: &mut [Aside], test| {
            on_this_processor(Search {
                query: self,
                aside,
                test,
            });
        };
        if self.tree.depth <= DEPTH {
            ASIDE.with_borrow_mut(|aside| search(aside, test));
        } else {
            search(&mut vec![Aside::NONE; self.tree.room_aside()], test);
        }
    }
}

/// A search from beginning to end.
struct Search<'a, 'r, 's, F> {
    query: Query<'a, 'r>,
    aside: &'s mut [Aside],
    test: F,
}

impl<'a, F: FnMut(Candidate<'a>) -> Option<f64>> Task for Search<'a, '_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        let Query {
            tree,
            ray,
            limit,
            kind,
        } = self.query;
        let mut walk = Walk::new(tree, ray, limit, kind, self.aside);
        while !walk.is_through() {
            if walk.is_at_node() {
                walk.see_children::<L>(tree);
                walk.leave_node::<L>(tree, self.aside);
            } else {
                walk.see_triangles::<L>(tree);
                walk.leave_leaf(tree, self.aside, &mut self.test);
            }
        }
    }
}

/// What a ray meets: the bits of the distance, triangle and side, in order.
#[cfg(test)]
pub(super) type Met = Vec<(u64, u32, bool)>;

/// What a ray meets of a kind up to a limit, or what of it is nearest, by the search that each processor does that this
/// one can be.
#[cfg(test)]
pub(super) fn on_each_processor(
    tree: &Tree,
    ray: &Shear,
    limit: f64,
    kind: Kind,
    nearest: bool,
) -> Vec<(&'static str, Met)> {
    let query = Query {
        tree,
        ray,
        limit,
        kind,
    };
    let run = |processor: &str| {
        let mut best = f64::INFINITY;
        let mut met = Vec::new();
        let search = Search {
            query,
            aside: &mut vec![Aside::NONE; tree.room_aside()],
            test: |triangle: Candidate<'_>| {
                let Meeting { t, enters } = ray.meet(&triangle.corners())?;
                if !(t >= 0.0 && t <= limit && triangle.is_of(kind, enters)) {
                    return None;
                }
                met.push(((t + 0.0).to_bits(), triangle.label().source, enters));
                best = best.min(t);
                nearest.then_some(best)
            },
        };
        match processor {
            #[cfg(target_arch = "x86_64")]
            "AVX2" => on_avx2(search)?,
            "any processor" => search.run::<Plain>(),
            _ => on_this_processor(search),
        }
        met.retain(|m| !nearest || f64::from_bits(m.0) <= best);
        met.sort_unstable();
        // A triangle may be in several leaves.
        met.dedup();
        Some(met)
    };
    ["this processor", "any processor", "AVX2"]
        .into_iter()
        .filter_map(|processor| Some((processor, run(processor)?)))
        .collect()
}
