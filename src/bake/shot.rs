//! The photons of one node, flown and tallied.

use super::tally::Tally;
use super::{End, Photon, Settings, fly};
use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::table::{Mode, Nodes};
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
        let flight = fly(self.fiber, &photon, self.settings.max_events);
        let path = flight.path_um / (0.5 * self.fiber.structure().diameter_um);
        let (share, levels) = (flight.share, &self.settings.levels);
        match flight.end {
            End::Escaped(w) => {
                let w = match self.settings.mode {
                    Mode::Paper => w,
                    Mode::Cone => {
                        let (sin, cos) = (flight.theta - self.nodes.centers[self.node]).sin_cos();
                        crate::math::frame::shift_inclination(w, sin, cos)
                    }
                };
                tally.escape(self.cube.texel(w), share, path, levels);
            }
            End::Absorbed => tally.absorb(levels),
            End::Truncated => tally.truncate(share, path, levels),
            End::Lost => tally.lose(share, path, levels),
            End::Missed => {}
        }
    }
}
