//! Photons that fly by turns: while one waits for its next boundary, others go on. Each has the path, to the bit, that
//! it has alone.

#[cfg(test)]
mod tests;

use super::entry::{ENTRY_TRIES, Entry, Photon};
use super::microfacet::Turn;
use super::photon::{Gone, Path};
use super::{End, Flight};
use crate::fiber::{Fiber, Hit, Ray, SEARCHES, Turns};
use crate::sampling::Rng;
use crate::table::PHOTON;
use glam::DVec3;

/// Flies photons as [`super::entry::fly`], or [`super::entry::fly_forked`], each.
///
/// * `searches`: of the fiber, none of them begun. * `book`: gets what becomes of each, or of each branch, and its part
///   of the photon, in any order.
pub(super) fn fly(
    fiber: &Fiber,
    mut searches: Turns<'_>,
    mut photons: impl Iterator<Item = Photon>,
    forked: bool,
    max_events: u32,
    mut book: impl FnMut(u64, Flight),
) {
    let mut start = |number: usize, searches: &mut Turns<'_>| {
        let flyer = Flyer::new(fiber, &photons.next()?);
        searches.begin(number, &flyer.ray());
        Some(flyer)
    };
    let mut flyers: [Option<Flyer>; SEARCHES] =
        std::array::from_fn(|number| start(number, &mut searches));
    loop {
        let ended = searches.go_on();
        if ended.is_empty() {
            return;
        }
        for number in ended.numbers() {
            let Some(flyer) = &mut flyers[number] else {
                continue;
            };
            let hit = searches.found(number);
            if flyer.go_on(fiber, hit, forked, max_events, &mut book) {
                searches.begin(number, &flyer.ray());
            } else {
                flyers[number] = start(number, &mut searches);
            }
        }
    }
}

/// A photon under way.
struct Flyer {
    entry: Entry,
    rng: Rng,
    /// That of the branch under way; before it has met the fiber, its way there.
    path: Path,
    /// The part of a photon that it is.
    part: u64,
    /// How often it has missed the fiber.
    tries: u32,
    /// Where it has met the fiber, and the boundary.
    first: Option<(DVec3, Hit)>,
    /// Parts that go other ways from there, and these.
    later: std::array::IntoIter<(u64, Option<Turn>), 2>,
}

impl Flyer {
    /// A photon on its way to the fiber.
    fn new(fiber: &Fiber, photon: &Photon) -> Self {
        let mut rng = Rng::new(photon.seed, photon.stream);
        let (entry, across) = Entry::aim(photon, &mut rng);
        let origin = entry.origin(fiber, across, &mut rng);
        Self {
            path: Path::new(origin, entry.dir),
            entry,
            rng,
            part: 0,
            tries: 0,
            first: None,
            later: [(0, None); 2].into_iter(),
        }
    }

    /// What is to be searched for next.
    fn ray(&self) -> Ray {
        let Path {
            p,
            dir,
            region,
            from,
            ..
        } = self.path;
        Ray {
            origin: p,
            dir,
            region,
            from,
        }
    }

    /// Goes on from what a search has found to the next search. Whether there is one.
    #[inline(always)]
    fn go_on(
        &mut self,
        fiber: &Fiber,
        hit: Option<Hit>,
        forked: bool,
        max_events: u32,
        book: &mut impl FnMut(u64, Flight),
    ) -> bool {
        let Self {
            entry, rng, path, ..
        } = self;
        let mut end = match (&self.first, hit) {
            (Some(_), hit) => match path.go(fiber, hit, rng, max_events) {
                Gone::Met(hit) => path.decide(fiber, &hit, None, rng),
                Gone::Scattered => None,
                Gone::Ended(end) => Some(end),
            },
            (None, Some(hit)) => {
                self.first = Some((path.p + hit.t * path.dir, hit));
                let fork = match forked {
                    true => entry.fork(fiber, &hit, rng),
                    false => None,
                };
                self.later = match fork {
                    Some((part, fork)) => [
                        (part, Some(fork.reflected)),
                        (PHOTON - part, Some(fork.transmitted)),
                    ],
                    None => [(PHOTON, None), (0, None)],
                }
                .into_iter();
                match self.begin(fiber) {
                    Some(end) => end,
                    None => return false,
                }
            }
            (None, None) => {
                self.tries += 1;
                if self.tries >= ENTRY_TRIES {
                    book(PHOTON, entry.missed());
                    return false;
                }
                let across = 2.0 * rng.uniform() - 1.0;
                path.p = entry.origin(fiber, across, rng);
                return true;
            }
        };
        loop {
            if end.is_none() && !self.path.is_spent(max_events) {
                return true;
            }
            let flight = self.path.ended(end.unwrap_or(End::Truncated));
            book(self.part, self.entry.seen(flight));
            end = match self.begin(fiber) {
                Some(end) => end,
                None => return false,
            };
        }
    }

    /// Begins the next branch, if there is one: its end, if the first boundary was that.
    fn begin(&mut self, fiber: &Fiber) -> Option<Option<End>> {
        let (part, turn) = self.later.find(|&(part, _)| part > 0)?;
        let (p, hit) = self.first?;
        self.part = part;
        self.path = Path::new(p, self.entry.dir);
        Some(self.path.decide(fiber, &hit, turn, &mut self.rng))
    }
}
