//! From the root of a tree down to what a ray meets.
//!
//! What a search does next depends on what it did last, for which it waits: for memory, for one operation after the
//! other, and where the processor guessed wrongly. So it looks at two nodes at a time, the two nearest; what it
//! will look at is asked for early; leaves are looked at a step later, when they have arrived; and nothing is decided
//! by a branch that can be reckoned instead.

use super::leaf::{Leaf, RUNS};
use super::line::Line;
use super::{DEPTH, Found, Ignored, Tree};
use crate::accel::Ray;
#[cfg(test)]
use crate::accel::lanes::Plain;
#[cfg(all(test, target_arch = "x86_64"))]
use crate::accel::lanes::on_avx2;
use crate::accel::lanes::{Aside, CHILDREN, Lanes, Task, on_this_processor, room_for};
use crate::pages::fetch;
use std::cell::RefCell;

/// What is set aside at most. From the bottom to the top nodes are deeper and deeper or as deep. Taking the two at
/// the top leaves none deeper than the second, and puts up to sixteen children below each.
const ASIDE: usize = 2 * CHILDREN * DEPTH;
/// Leaves found in a step at most.
const RIPE: usize = 2 * CHILDREN;

/// Room for what is set aside, with some for rows that are not full.
struct Room {
    nodes: [Aside; ASIDE + CHILDREN],
    leaves: [[Aside; RIPE + CHILDREN]; 2],
}

thread_local! {
    // Kept: to fill it anew would be five kilobytes of writing a ray.
    static ROOM: RefCell<Room> = const {
        RefCell::new(Room {
            nodes: [Aside::NONE; ASIDE + CHILDREN],
            leaves: [[Aside::NONE; RIPE + CHILDREN]; 2],
        })
    };
}

/// The nearest segment that a ray meets up to `limit`, of equal distances the first one, or, with `ANY`, some segment.
#[inline(always)]
pub(super) fn search<const ANY: bool>(
    tree: &Tree,
    ray: &Ray,
    limit: f32,
    ignored: Option<Ignored>,
) -> Option<Found> {
    if tree.nodes.is_empty() {
        return None;
    }
    let query = Query {
        tree,
        ray,
        limit,
        ignored: ignored.unwrap_or(Ignored::NOTHING),
    };
    ROOM.with_borrow_mut(|room| {
        on_this_processor(Search::<ANY> {
            query: &query,
            room,
        })
    })
}

/// What a search is asked.
struct Query<'a> {
    tree: &'a Tree,
    ray: &'a Ray,
    limit: f32,
    ignored: Ignored,
}

/// A search from beginning to end.
struct Search<'a, const ANY: bool> {
    query: &'a Query<'a>,
    room: &'a mut Room,
}

impl<const ANY: bool> Task for Search<'_, ANY> {
    type Output = Option<Found>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<Found> {
        self.query.walk::<L, ANY>(self.room)
    }
}

impl Query<'_> {
    #[inline(always)]
    fn walk<L: Lanes, const ANY: bool>(&self, room: &mut Room) -> Option<Found> {
        let (nodes, leaves) = (self.tree.nodes.entries(), self.tree.leaves.entries());
        let line = Line::new(self.ray, &self.tree.ball);
        let mut nearest = Nearest {
            limit: self.limit,
            reach: line.along(self.limit),
            found: None,
        };
        let aside = &mut room.nodes;
        let [ripe, found] = &mut room.leaves;
        // Leaves found a step ago, and those found now.
        let (mut ripe, mut found) = (ripe, found);

        // Most rays of a camera end here.
        let root = &nodes[0];
        let (met, begins) = root.meets::<L>(&line, nearest.reach);
        if met == 0 {
            return None;
        }
        let (chosen, children) = root.inner(met);
        let mut count = L::line_up(chosen, begins, children, room_for(aside, 0));
        let (chosen, children) = root.leaves(met);
        let mut ripe_count = L::line_up(chosen, begins, children, room_for(ripe, 0));
        loop {
            while count > 0 && aside[count - 1].distance() > nearest.reach {
                count -= 1;
            }
            if count == 0 {
                self.look::<L, ANY>(leaves, &ripe[..ripe_count], &line, &mut nearest);
                return nearest.found;
            }
            let near = &nodes[aside[count - 1].number()];
            // The same again if there is no other.
            let two = usize::from(count > 1);
            let far = &nodes[aside[count - 1 - two].number()];
            count -= 1 + two;
            let (near_met, near_begins) = near.meets::<L>(&line, nearest.reach);
            let (far_met, far_begins) = far.meets::<L>(&line, nearest.reach);
            let far_met = far_met & (two as u16).wrapping_neg();

            let (chosen, children) = far.inner(far_met);
            count += L::line_up(chosen, far_begins, children, room_for(aside, count));
            let (chosen, children) = near.inner(near_met);
            count += L::line_up(chosen, near_begins, children, room_for(aside, count));
            let (chosen, children) = far.leaves(far_met);
            let mut found_count = L::line_up(chosen, far_begins, children, room_for(found, 0));
            let (chosen, children) = near.leaves(near_met);
            found_count += L::line_up(chosen, near_begins, children, room_for(found, found_count));
            for leaf in &found[..found_count] {
                fetch(&leaves[leaf.number()]);
            }
            for k in 1..=4 {
                // Where nothing is set aside, what an earlier search left there.
                if let Some(node) = nodes.get(aside[count.saturating_sub(k)].number()) {
                    fetch(node);
                }
            }

            if self.look::<L, ANY>(leaves, &ripe[..ripe_count], &line, &mut nearest) {
                return nearest.found;
            }
            std::mem::swap(&mut ripe, &mut found);
            ripe_count = found_count;
        }
    }

    /// Looks at leaves, the last first. With `ANY`, says whether a segment was met and stops there.
    #[inline(always)]
    fn look<L: Lanes, const ANY: bool>(
        &self,
        leaves: &[Leaf],
        ripe: &[Aside],
        line: &Line,
        nearest: &mut Nearest,
    ) -> bool {
        for one in ripe.iter().rev() {
            if one.distance() > nearest.reach {
                continue;
            }
            let mut number = one.number();
            let mut is_nearer = self.meet::<L>(leaves, number, line, nearest);
            while leaves[number].is_followed() {
                number += 1;
                is_nearer |= self.meet::<L>(leaves, number, line, nearest);
            }
            if is_nearer {
                if ANY {
                    return true;
                }
                nearest.reach = line.along(nearest.limit);
            }
        }
        false
    }

    /// Whether a segment of a leaf was met that is nearer than what was found before.
    #[inline(always)]
    fn meet<L: Lanes>(
        &self,
        leaves: &[Leaf],
        number: usize,
        line: &Line,
        nearest: &mut Nearest,
    ) -> bool {
        let leaf = &leaves[number];
        let (mut met, t) = leaf.meets::<L>(line, nearest.limit);
        if met == 0 {
            return false;
        }
        let mut is_nearer = false;
        let t = L::eight(t);
        while met != 0 {
            let lane = met.trailing_zeros() as usize % 8;
            met &= met - 1;
            let found = Found {
                t: t[lane],
                run: leaf.run(lane),
                half: lane as u32 / 4,
                place: (number * RUNS + lane % RUNS) as u32,
            };
            if found.is_before(nearest.found.as_ref()) && !self.ignored.covers(&found) {
                nearest.limit = found.t;
                nearest.found = Some(found);
                is_nearer = true;
            }
        }
        is_nearer
    }
}

/// What was found so far.
struct Nearest {
    /// Distance along the ray up to which something else would be nearer, and the same along the line.
    limit: f32,
    reach: f32,
    found: Option<Found>,
}

impl Found {
    #[inline(always)]
    fn is_before(&self, other: Option<&Self>) -> bool {
        let rank = |found: &Self| (found.run, found.half);
        match other {
            Some(old) => self.t < old.t || (self.t == old.t && rank(self) < rank(old)),
            None => true,
        }
    }
}

impl Ignored {
    const NOTHING: Self = Self {
        first: 0,
        end: 0,
        clear: 0.0,
    };

    #[inline(always)]
    fn covers(&self, found: &Found) -> bool {
        found.t < self.clear && (self.first..self.end).contains(&found.run)
    }
}

/// The nearest segment with what each processor does that this one can be.
#[cfg(test)]
pub(super) fn on_each_processor(
    tree: &Tree,
    ray: &Ray,
    limit: f32,
    ignored: Option<Ignored>,
) -> Vec<(&'static str, Option<Found>)> {
    let query = Query {
        tree,
        ray,
        limit,
        ignored: ignored.unwrap_or(Ignored::NOTHING),
    };
    ROOM.with_borrow_mut(|room| {
        let mut all = vec![("any processor", query.walk::<Plain, false>(room))];
        all.push((
            "this processor",
            on_this_processor(Search::<false> {
                query: &query,
                room,
            }),
        ));
        #[cfg(target_arch = "x86_64")]
        all.extend(
            on_avx2(Search::<false> {
                query: &query,
                room,
            })
            .map(|found| ("AVX2", found)),
        );
        all
    })
}
