//! The searches of several rays by turns. A search waits most of its time: for lines of a node or a leaf to come, for
//! one operation to end before the next begins, for the processor to start anew after a wrong guess. By turns one
//! search works while others wait, and what each finds does not depend on the others.

use super::Triangles;
use super::nearest::{Nearest, Quest};
use super::tree::{Tree, Walk};
use super::way::{Stretch, Way};
use crate::accel::lanes::{Aside, Lanes, Task, on_this_processor};
use crate::fiber::trace::Ray;
use crate::fiber::{Fiber, Hit, Region};
use glam::DVec3;

/// Searches under way. With fewer some waiting is left; with more what they keep leaves the nearest cache.
pub(crate) const SEARCHES: usize = 16;
/// Searches that have ended before they are handed back, as long as others are under way.
const ENOUGH: u32 = 4;

/// Searches under way through one fiber.
pub(crate) struct Turns<'a> {
    fiber: &'a Fiber,
    triangles: &'a Triangles,
    searches: Vec<Search<'a>>,
    next: Next,
    ended: Few,
}

/// Some of the searches.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Few(u32);

const _: () = assert!(SEARCHES <= u32::BITS as usize);

/// Searches by what they do next.
#[derive(Clone, Copy, Default)]
struct Next {
    begun: Few,
    at_nodes: Few,
    at_leaves: Few,
    through: Few,
}

/// The search of one ray.
struct Search<'a> {
    ray: Ray,
    tour: Option<Tour<'a>>,
    /// Room for what is set aside.
    aside: Box<[Aside]>,
}

/// A ray in one of the tiles that it comes through.
struct Tour<'a> {
    quest: Quest,
    way: Way,
    stretch: Stretch,
    nearest: Nearest<'a>,
    walk: Walk,
}

impl<'a> Turns<'a> {
    pub(in crate::fiber) fn new(fiber: &'a Fiber, triangles: &'a Triangles) -> Self {
        let search = || Search {
            ray: Ray {
                origin: DVec3::ZERO,
                dir: DVec3::Z,
                region: Region::Outside,
                from: None,
            },
            tour: None,
            aside: vec![Aside::NONE; triangles.tree.room_aside()].into(),
        };
        Self {
            fiber,
            triangles,
            searches: std::iter::repeat_with(search).take(SEARCHES).collect(),
            next: Next::default(),
            ended: Few::default(),
        }
    }

    /// Begins a search with a number below [`SEARCHES`] that is free: not begun yet, or ended.
    pub(crate) fn begin(&mut self, number: usize, ray: &Ray) {
        let search = &mut self.searches[number];
        search.ray = *ray;
        self.next.begun.add(number);
    }

    /// Goes on until some searches have ended. None if none is under way.
    pub(crate) fn go_on(&mut self) -> Few {
        on_this_processor(Steps(self));
        std::mem::take(&mut self.ended)
    }

    /// What a search that has ended came to: [`Fiber::next_hit`], to the bit.
    pub(crate) fn found(&self, number: usize) -> Option<Hit> {
        let Search { ray, tour, .. } = &self.searches[number];
        let hit = self.triangles.hit(ray, |_| {
            let tour = tour.as_ref()?;
            tour.nearest.found(&tour.stretch)
        })?;
        Some(self.fiber.with_pigment(ray, hit))
    }
}

impl<'a> Tour<'a> {
    #[inline(always)]
    fn new(triangles: &'a Triangles, ray: &Ray, aside: &mut [Aside]) -> Option<Self> {
        let quest = Quest::new(triangles.layered, ray)?;
        let mut way = Way::new(triangles.screw, ray.origin / triangles.radius_um, ray.dir)?;
        let stretch = way.next()?;
        let (nearest, walk) = begin(&triangles.tree, &quest, &stretch, aside);
        Some(Self {
            quest,
            way,
            stretch,
            nearest,
            walk,
        })
    }

    /// Goes on to the next tile, if the ray comes to one.
    #[inline(always)]
    fn next_tile(&mut self, triangles: &'a Triangles, aside: &mut [Aside]) -> Option<()> {
        self.stretch = self.way.next()?;
        (self.nearest, self.walk) = begin(&triangles.tree, &self.quest, &self.stretch, aside);
        Some(())
    }
}

/// A search of a tile.
#[inline(always)]
fn begin<'a>(
    tree: &Tree,
    quest: &Quest,
    stretch: &Stretch,
    aside: &mut [Aside],
) -> (Nearest<'a>, Walk) {
    let nearest = Nearest::new(quest, stretch);
    let walk = Walk::new(tree, &stretch.ray, nearest.limit, quest.kind, aside);
    (nearest, walk)
}

/// Steps of all searches until enough have ended.
struct Steps<'t, 'a>(&'t mut Turns<'a>);

impl Task for Steps<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Turns {
            triangles,
            searches,
            next,
            ended,
            ..
        } = self.0;
        let tree = &triangles.tree;
        while ended.count() < ENOUGH && !next.is_empty() {
            let Next {
                begun,
                at_nodes,
                at_leaves,
                through,
            } = std::mem::take(next);
            for number in begun.numbers() {
                let Search { ray, tour, aside } = &mut searches[number];
                *tour = Tour::new(triangles, ray, aside);
                match tour {
                    Some(tour) => next.add(tree, &tour.walk, number),
                    None => ended.add(number),
                }
            }
            // All look before one goes on: what one waits for is then short, and the processor sees far ahead.
            for number in at_nodes.numbers() {
                if let Some(tour) = &mut searches[number].tour {
                    tour.walk.see_children::<L>(tree);
                }
            }
            for number in at_leaves.numbers() {
                if let Some(tour) = &mut searches[number].tour {
                    tour.walk.see_triangles::<L>(tree);
                }
            }
            for number in at_nodes.numbers() {
                let Search { tour, aside, .. } = &mut searches[number];
                if let Some(tour) = tour {
                    tour.walk.leave_node::<L>(tree, aside);
                    next.add(tree, &tour.walk, number);
                }
            }
            for number in at_leaves.numbers() {
                let Search { tour, aside, .. } = &mut searches[number];
                if let Some(tour) = tour {
                    let (ray, nearest) = (&tour.stretch.ray, &mut tour.nearest);
                    let test = |triangle| nearest.test(ray, triangle);
                    tour.walk.leave_leaf(tree, aside, test);
                    next.add(tree, &tour.walk, number);
                }
            }
            for number in through.numbers() {
                let Search { tour, aside, .. } = &mut searches[number];
                if let Some(tour) = tour {
                    let is_met = tour.nearest.best.is_some();
                    match is_met || tour.next_tile(triangles, aside).is_none() {
                        true => ended.add(number),
                        false => next.add(tree, &tour.walk, number),
                    }
                }
            }
        }
    }
}

impl Next {
    /// Without a branch: what comes next is chance.
    #[inline(always)]
    fn add(&mut self, tree: &Tree, walk: &Walk, number: usize) {
        walk.fetch(tree);
        let (at_node, through) = (walk.is_at_node(), walk.is_through());
        self.at_nodes.0 |= u32::from(at_node) << number;
        self.at_leaves.0 |= u32::from(!at_node & !through) << number;
        self.through.0 |= u32::from(through) << number;
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.begun.0 | self.at_nodes.0 | self.at_leaves.0 | self.through.0 == 0
    }
}

impl Few {
    fn add(&mut self, number: usize) {
        self.0 |= 1 << number;
    }

    #[inline(always)]
    fn count(self) -> u32 {
        self.0.count_ones()
    }

    pub(crate) fn is_empty(self) -> bool {
        self.0 == 0
    }

    #[inline(always)]
    pub(crate) fn numbers(mut self) -> impl Iterator<Item = usize> {
        std::iter::from_fn(move || {
            let number = self.0.trailing_zeros() as usize;
            self.0 &= self.0.wrapping_sub(1);
            (number < SEARCHES).then_some(number)
        })
    }
}
