//! Many photons through one fiber, in company where that is faster.

use super::Flight;
use super::entry::{Photon, fly, fly_forked};
#[cfg(target_arch = "x86_64")]
use super::packet::Company;
use super::turns;
use crate::fiber::Fiber;
use crate::table::PHOTON;

/// A fiber through which many photons are to fly.
pub(super) struct Many<'a> {
    fiber: &'a Fiber,
    #[cfg(target_arch = "x86_64")]
    company: Option<Company<'a>>,
}

impl<'a> Many<'a> {
    pub(super) fn new(fiber: &'a Fiber) -> Self {
        Self {
            fiber,
            #[cfg(target_arch = "x86_64")]
            company: Company::new(fiber),
        }
    }

    /// See [`fly_all`].
    pub(super) fn fly(
        &self,
        photons: impl Iterator<Item = Photon>,
        forked: bool,
        max_events: u32,
        mut book: impl FnMut(u64, Flight),
    ) {
        #[cfg(target_arch = "x86_64")]
        if let Some(company) = &self.company {
            return company.fly(photons, forked, max_events, book);
        }
        if let Some(searches) = self.fiber.turns() {
            return turns::fly(self.fiber, searches, photons, forked, max_events, book);
        }
        for photon in photons {
            if forked {
                fly_forked(self.fiber, &photon, max_events, &mut book);
            } else {
                book(PHOTON, fly(self.fiber, &photon, max_events));
            }
        }
    }
}

/// Flies many photons, each as [`fly`] does, or [`fly_forked`] if `forked`, to the bit; where the processor
/// has AVX-512 or AVX2 and the fiber is clear keratin and air, eight at a time and up to several times as fast; where
/// the fiber is a mesh, by turns.
///
/// * `book`: gets every flight and its part of a photon in units of 2^-32, in any order.
pub fn fly_all(
    fiber: &Fiber,
    photons: impl Iterator<Item = Photon>,
    forked: bool,
    max_events: u32,
    book: impl FnMut(u64, Flight),
) {
    Many::new(fiber).fly(photons, forked, max_events, book);
}
