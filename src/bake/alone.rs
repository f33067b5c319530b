//! For tests of photons that fly together: they go where they go alone.

use super::entry::{Photon, Sides, fly, fly_forked};
use super::{End, Flight};
use crate::fiber::Fiber;
use crate::table::PHOTON;

/// Some photons from every direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flights {
    pub(super) seed: u64,
    pub(super) count: u64,
    pub(super) forked: bool,
    pub(super) max_events: u32,
}

impl Flights {
    pub(super) fn photons(self) -> impl Iterator<Item = Photon> {
        (0..self.count).map(move |stream| Photon {
            seed: self.seed,
            stream,
            sin_range: (-1.0, 1.0),
            sides: Sides::ALL,
        })
    }

    /// Fails unless flights together, with their parts of a photon, are those of photons one by one, in any order.
    pub(super) fn fly_as_alone(self, fiber: &Fiber, name: &str, mut together: Vec<(u64, Flight)>) {
        let mut alone = Vec::new();
        for photon in self.photons() {
            if self.forked {
                fly_forked(fiber, &photon, self.max_events, |part, flight| {
                    alone.push((part, flight));
                });
            } else {
                alone.push((PHOTON, fly(fiber, &photon, self.max_events)));
            }
        }
        assert_eq!(alone.len(), together.len(), "{name} {self:?}");
        let [alone, together] = [&mut alone, &mut together].map(|flights| {
            let mut all: Vec<_> = flights.iter().map(bits).collect();
            all.sort_unstable();
            all
        });
        let same = alone.iter().zip(&together).filter(|(a, b)| a == b);
        assert_eq!(same.count(), alone.len(), "{name} {self:?}");
    }
}

/// A flight as whole numbers, to be sorted.
fn bits((part, flight): &(u64, Flight)) -> [u64; 10] {
    let (end, dir) = match flight.end {
        End::Escaped(dir) => (0, dir.to_array().map(f64::to_bits)),
        End::Absorbed => (1, [0; 3]),
        End::Truncated => (2, [0; 3]),
        End::Lost => (3, [0; 3]),
        End::Missed => (4, [0; 3]),
    };
    let [x, y, z] = dir;
    let [cos, sin] = flight.query.to_array().map(f64::to_bits);
    let [path, share] = [flight.path_um, flight.share].map(f64::to_bits);
    let events = u64::from(flight.events);
    [*part, cos, sin, path, share, events, end, x, y, z]
}
