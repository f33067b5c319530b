//! The photons of one node, flown and tallied.

use super::tally::{Rest, Tally};
use super::{End, Flight, Photon, Settings, fly, fly_forked};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::table::{Mode, Nodes, PHOTON};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Photons that one thread flies between two looks at the cancel flag.
const BATCH: u64 = 4096;

/// The photons of one node.
pub(super) struct Shot<'a> {
    pub(super) fiber: &'a Fiber,
    pub(super) settings: &'a Settings,
    pub(super) nodes: &'a Nodes,
    pub(super) cube: &'a Unicube,
    pub(super) node: usize,
}

impl Shot<'_> {
    /// Flies a range of photon indices on all threads. `None` if cancelled.
    pub(super) fn fly_range(
        &self,
        range: std::ops::Range<u64>,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Option<Tally> {
        let next = AtomicU64::new(range.start);
        let workers = rayon::current_num_threads();
        let tallies: Vec<Tally> = (0..workers)
            .into_par_iter()
            .map(|_| {
                let mut tally = Tally::new(self.cube.texels(), self.settings.levels.len());
                while !cancel.is_cancelled() {
                    let start = next.fetch_add(BATCH, Ordering::Relaxed);
                    if start >= range.end {
                        break;
                    }
                    let end = (start + BATCH).min(range.end);
                    for index in start..end {
                        self.fly_one(index, &mut tally);
                    }
                    progress.advance(end - start);
                }
                tally
            })
            .collect();
        if cancel.is_cancelled() {
            return None;
        }
        let mut tallies = tallies.into_iter();
        let mut sum = tallies.next()?;
        for tally in tallies {
            sum.add(&tally);
        }
        Some(sum)
    }

    fn fly_one(&self, index: u64, tally: &mut Tally) {
        let edges = &self.nodes.edges;
        let photon = Photon {
            seed: self.settings.seed,
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
