//! The photons of one node, flown and tallied.

use super::cylinder::{Chance, Cylinder};
use super::deposit::{Deposit, Deposits, Rest};
use super::entry::{NODE_BITS, Stratified};
use super::many::Many;
use super::tally::Tally;
use super::{End, Flight, Photon, Settings, Sides};
use crate::fiber::Fiber;
use crate::math::frame::shift_inclination;
use crate::math::unicube::Unicube;
use crate::table::{Mode, Nodes, PHOTON};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Deposits that are collected before they are added to the sums: enough for the processor to
/// fetch many sums at once, few enough to stay in its nearest cache.
const COLLECTED: usize = 256;

/// The photons of one node.
pub(super) struct Shot<'a> {
    fiber: &'a Fiber,
    many: Many<'a>,
    settings: &'a Settings,
    cube: &'a Unicube,
    node: usize,
    sin_range: (f64, f64),
    sides: Sides,
    /// Cosine and sine of the node's inclination.
    center: DVec2,
    /// The fiber if it is a bare cylinder.
    cylinder: Option<Cylinder>,
}

impl<'a> Shot<'a> {
    pub(super) fn new(
        fiber: &'a Fiber,
        settings: &'a Settings,
        nodes: &Nodes,
        cube: &'a Unicube,
        node: usize,
    ) -> Self {
        let [from, to] = nodes.theta_range(node);
        Self {
            fiber,
            many: Many::new(fiber),
            settings,
            cube,
            node,
            sin_range: (from.sin(), to.sin()),
            sides: Sides {
                turns: nodes.azimuths.range_turns(nodes.azimuth_bin(node)),
                symmetry: nodes.azimuths.symmetry,
            },
            center: DVec2::from_angle(nodes.theta(node)),
            cylinder: Cylinder::of(fiber, settings),
        }
    }

    /// A tally for this node's photons.
    pub(super) fn empty_tally(&self) -> Tally {
        Tally::new(self.cube.texels(), self.settings.levels.len())
    }

    /// Flies ranges of photon indices, until there is none any more.
    ///
    /// One range follows another while photons of the one before are still under way: where they fly in company,
    /// that stays complete.
    pub(super) fn fly(&self, mut ranges: impl FnMut() -> Option<Range<u64>>, tally: &mut Tally) {
        let settings = self.settings;
        let mut deposits = Deposits::default();
        if let Some(cylinder) = &self.cylinder {
            while let Some(range) = ranges() {
                tally.emit(range.end - range.start);
                let mut start = range.start;
                while start < range.end {
                    let end = range.end.min(start + COLLECTED as u64);
                    self.cross(cylinder, start..end, &mut deposits, tally);
                    tally.escape(&mut deposits, &settings.levels);
                    start = end;
                }
            }
            return;
        }
        let (mut emitted, mut missed) = (0, 0);
        let ranges = std::iter::from_fn(|| {
            let range = ranges()?;
            emitted += range.end - range.start;
            Some(range)
        });
        let photons = ranges.flatten().map(|index| Photon {
            seed: settings.seed_of_photons(),
            stream: ((self.node as u64) << NODE_BITS) | index,
            sin_range: self.sin_range,
            sides: self.sides,
        });
        self.many.fly(
            photons,
            settings.fork,
            settings.max_events,
            |part, flight| {
                if let End::Missed = flight.end {
                    missed += 1;
                    return;
                }
                self.book(part, &flight, &mut deposits, tally);
                if deposits.count() >= COLLECTED {
                    tally.escape(&mut deposits, &settings.levels);
                }
            },
        );
        tally.escape(&mut deposits, &settings.levels);
        // A photon that never met the fiber does not count.
        tally.emit(emitted - missed);
    }

    /// Flies photons through a bare cylinder.
    fn cross(
        &self,
        cylinder: &Cylinder,
        range: Range<u64>,
        deposits: &mut Deposits,
        tally: &mut Tally,
    ) {
        let (seed, node) = (self.settings.seed_of_photons(), self.node as u64);
        let (start, chance) = (Stratified::new(seed, node), Chance::new(seed, node));
        let (lo, hi) = self.sin_range;
        for index in range {
            let (along, across) = start.at(index);
            let sin = lo + (hi - lo) * along;
            let ways = cylinder.ways(sin, 2.0 * across - 1.0, chance.at(index));
            // All light leaves along the specular cone, which the frame of a cone table holds still.
            let cone = match self.settings.mode {
                Mode::Paper => DVec2::new((1.0 - sin * sin).max(0.0).sqrt(), sin),
                Mode::Cone => self.center,
            };
            let texel = |azimuth: DVec2| {
                let w = DVec3::new(cone.x * azimuth.x, cone.x * azimuth.y, -cone.y);
                self.cube.texel(w) as u32
            };
            let rest = |part, path| Rest {
                part,
                share: 1.0,
                path,
            };
            if ways.part > 0 {
                deposits.bare.push(Deposit {
                    texel: texel(ways.reflected),
                    rest: rest(ways.part, 0.0),
                });
            }
            let rest = rest(PHOTON - ways.part, ways.path);
            match ways.transmitted {
                _ if rest.part == 0 => {}
                Some(azimuth) => deposits.colored.push(Deposit {
                    texel: texel(azimuth),
                    rest,
                }),
                None => tally.truncate(rest, &self.settings.levels),
            }
        }
    }

    /// Books where a part of a photon went.
    fn book(&self, part: u64, flight: &Flight, deposits: &mut Deposits, tally: &mut Tally) {
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
                        // By how much the query is beyond the node.
                        let shift = DVec2::new(self.center.x, -self.center.y).rotate(flight.query);
                        shift_inclination(w, shift.y, shift.x)
                    }
                };
                deposits.push(self.cube.texel(w), rest);
            }
            End::Absorbed => tally.absorb(rest, levels),
            End::Truncated => tally.truncate(rest, levels),
            End::Lost => tally.lose(rest, levels),
            End::Missed => {}
        }
    }
}
