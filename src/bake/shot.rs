//! The photons of one node, flown and tallied.

use super::tally::{Rest, Tally};
use super::{End, Flight, Photon, Settings, fly, fly_forked};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::table::{Mode, Nodes, PHOTON};
use std::ops::Range;

/// The photons of one node.
pub(super) struct Shot<'a> {
    pub(super) fiber: &'a Fiber,
    pub(super) settings: &'a Settings,
    pub(super) nodes: &'a Nodes,
    pub(super) cube: &'a Unicube,
    pub(super) node: usize,
}

impl Shot<'_> {
    /// A tally for this node's photons.
    pub(super) fn empty_tally(&self) -> Tally {
        Tally::new(self.cube.texels(), self.settings.levels.len())
    }

    /// Flies a range of photon indices.
    pub(super) fn fly(&self, range: Range<u64>, tally: &mut Tally) {
        for index in range {
            self.fly_one(index, tally);
        }
    }

    fn fly_one(&self, index: u64, tally: &mut Tally) {
        let edges = &self.nodes.edges;
        let photon = Photon {
            seed: self.settings.seed_of_photons(),
            stream: ((self.node as u64) << 40) | index,
            sin_range: (edges[self.node].sin(), edges[self.node + 1].sin()),
        };
        tally.emit();
        let max_events = self.settings.max_events;
        if self.settings.fork {
            fly_forked(self.fiber, &photon, max_events, |part, flight| {
                self.book(part, &flight, tally);
            });
        } else {
            let flight = fly(self.fiber, &photon, max_events);
            self.book(PHOTON, &flight, tally);
        }
    }

    /// Books where a part of a photon went.
    fn book(&self, part: u64, flight: &Flight, tally: &mut Tally) {
        let levels = &self.settings.levels;
        let rest = Rest {
            part,
            share: flight.share,
            path: flight.path_um / (0.5 * self.fiber.structure().diameter_um),
        };
        match flight.end {
            End::Escaped(w) => {
                let w = match self.settings.mode {
                    Mode::Paper => w,
                    Mode::Cone => {
                        let (sin, cos) = (flight.theta - self.nodes.centers[self.node]).sin_cos();
                        crate::math::frame::shift_inclination(w, sin, cos)
                    }
                };
                tally.escape(self.cube.texel(w), rest, levels);
            }
            End::Absorbed => tally.absorb(rest, levels),
            End::Truncated => tally.truncate(rest, levels),
            End::Lost => tally.lose(rest, levels),
            End::Missed => tally.miss(),
        }
    }
}
