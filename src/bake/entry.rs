//! Where photons start: evenly over inclination, width, length and rotation of the fiber.

use super::fork::{Fork, fork};
use super::microfacet::{Ratio, Turn};
use super::photon::follow_from;
use super::{End, Flight, follow};
use crate::fiber::{Fiber, Hit, Optics, Region};
use crate::math::symmetry::Symmetry;
use crate::math::turn::unit_vector;
use crate::sampling::{Rng, hash64};
use crate::table::PHOTON;
use glam::{DVec2, DVec3};

/// The identity of a photon and the range of directions it comes from.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Seed of the photons.
    pub seed: u64,
    /// Number of the photon; node in the high bits, index in the low 40.
    pub stream: u64,
    /// Range of sin(theta) of the query direction, uniform in solid angle over it.
    pub sin_range: (f64, f64),
    /// Range of its azimuth.
    pub sides: Sides,
}

/// The sides from which photons come: evenly from a range of query azimuths and all that the
/// fiber's symmetry makes the same.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    /// From and to, turns from the major axis of the section.
    pub turns: [f64; 2],
    /// What stands for what.
    pub symmetry: Symmetry,
}

impl Sides {
    /// All round.
    pub const ALL: Self = Self {
        turns: [0.0, 1.0],
        symmetry: Symmetry::None,
    };

    /// The azimuth of a random number in `[0, 1)`, in turns, and whether what leaves is to be mirrored.
    #[inline]
    fn pick(&self, u: f64) -> (f64, bool) {
        let [from, to] = self.turns;
        let u = u * self.symmetry.images() as f64;
        let image = u as usize;
        let turns = from + (to - from) * (u - image as f64);
        self.symmetry.image(turns, image)
    }
}

/// Entries tried before a photon counts as missed: its beam covers the bounding cylinder, most of
/// which is fiber, so one in thousands needs more than two.
pub(super) const ENTRY_TRIES: u32 = 64;

/// Flies a photon: enters uniformly over projected width, one period and all rotations of the fiber,
/// then reflects, refracts and scatters by chance until it leaves.
///
/// * `max_events`: given up inside after this many events.
pub fn fly(fiber: &Fiber, photon: &Photon, max_events: u32) -> Flight {
    let mut rng = Rng::new(photon.seed, photon.stream);
    let (entry, met) = Entry::find(fiber, photon, &mut rng);
    let Some((p, hit)) = met else {
        return entry.missed();
    };
    entry.seen(follow(fiber, p, entry.dir, hit, &mut rng, max_events))
}

/// Flies a photon as [`fly`] does, but where it first meets the fiber follows both what is reflected
/// and what goes in, if that boundary is a dielectric one. The same light in the mean.
///
/// * `book`: gets every branch and its part of the photon in units of 2^-32; the parts sum to one
///   photon exactly.
pub fn fly_forked(
    fiber: &Fiber,
    photon: &Photon,
    max_events: u32,
    mut book: impl FnMut(u64, Flight),
) {
    let mut rng = Rng::new(photon.seed, photon.stream);
    let (entry, met) = Entry::find(fiber, photon, &mut rng);
    let Some((p, hit)) = met else {
        return book(PHOTON, entry.missed());
    };
    let forked = entry.fork(fiber, &hit, &mut rng);
    let mut branch = |part: u64, turn: Option<Turn>| {
        if part > 0 {
            let way = follow_from(fiber, p, entry.dir, hit, turn, &mut rng, max_events);
            book(part, entry.seen(way));
        }
    };
    match forked {
        Some((part, fork)) => {
            branch(part, Some(fork.reflected));
            branch(PHOTON - part, Some(fork.transmitted));
        }
        None => branch(PHOTON, None),
    }
}

/// Where a photon meets the fiber.
pub(super) struct Entry {
    /// Cosine and sine of the inclination of the query direction.
    pub(super) query: DVec2,
    /// Direction of travel.
    pub(super) dir: DVec3,
    /// Cosine and sine of the fiber's rotation.
    turn: DVec2,
    /// Whether the fiber's mirror image is what the photon stands for.
    mirrored: bool,
}

impl Entry {
    /// A direction, and place and boundary where the fiber is met, unless it is missed.
    fn find(fiber: &Fiber, photon: &Photon, rng: &mut Rng) -> (Self, Option<(DVec3, Hit)>) {
        let (entry, mut across) = Self::aim(photon, rng);
        for _ in 0..ENTRY_TRIES {
            let origin = entry.origin(fiber, across, rng);
            if let Some(hit) = fiber.next_hit(origin, entry.dir, Region::Outside, None) {
                let met = origin + hit.t * entry.dir;
                return (entry, Some((met, hit)));
            }
            across = 2.0 * rng.uniform() - 1.0;
        }
        (entry, None)
    }

    /// A direction, and the first place across the beam, -1..1.
    #[inline(always)]
    pub(super) fn aim(photon: &Photon, rng: &mut Rng) -> (Self, f64) {
        let (along, across) = stratified(photon);
        let (lo, hi) = photon.sin_range;
        let sin = lo + (hi - lo) * along;
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        let (turns, mirrored) = photon.sides.pick(rng.uniform());
        let turn = unit_vector(turns);
        let entry = Self {
            query: DVec2::new(cos, sin),
            dir: rotate(DVec3::new(-cos, 0.0, -sin), turn),
            turn,
            mirrored,
        };
        (entry, 2.0 * across - 1.0)
    }

    /// Where a photon at a place across the beam comes from: on the side of the bounding cylinder that the beam
    /// comes from, a little outside it.
    #[inline(always)]
    pub(super) fn origin(&self, fiber: &Fiber, across: f64, rng: &mut Rng) -> DVec3 {
        let radius = fiber.bounding_radius_um();
        let x = (1.0 - across * across).max(0.0).sqrt() + 1e-3;
        let z = fiber.period_um() * rng.uniform();
        rotate(DVec3::new(radius * x, radius * across, z), self.turn)
    }

    /// Both ways at the first boundary, if it is a dielectric one, and the part of the photon, in units of
    /// 2^-32, that is reflected.
    pub(super) fn fork(&self, fiber: &Fiber, hit: &Hit, rng: &mut Rng) -> Option<(u64, Fork)> {
        let ratio = Ratio {
            eta: fiber.eta(Region::Outside, hit.to),
            inverse: fiber.eta(hit.to, Region::Outside),
        };
        match fiber.optics(hit.part) {
            Optics::Dielectric { roughness } if ratio.eta != 1.0 => {
                let fork = fork(self.dir, hit.normal, ratio, *roughness, rng)?;
                Some((fork.part(), fork))
            }
            _ => None,
        }
    }

    pub(super) fn missed(&self) -> Flight {
        Flight {
            query: self.query,
            path_um: 0.0,
            share: 1.0,
            events: 0,
            end: End::Missed,
        }
    }

    /// A flight through the turned fiber as the query direction sees it.
    pub(super) fn seen(&self, way: Flight) -> Flight {
        let back = DVec2::new(self.turn.x, -self.turn.y);
        Flight {
            query: self.query,
            end: match way.end {
                End::Escaped(dir) => {
                    let dir = rotate(dir, back);
                    End::Escaped(if self.mirrored {
                        dir.with_y(-dir.y)
                    } else {
                        dir
                    })
                }
                other => other,
            },
            ..way
        }
    }
}

/// Rotates about z by the angle whose cosine and sine are `turn`.
fn rotate(v: DVec3, turn: DVec2) -> DVec3 {
    let xy = turn.rotate(DVec2::new(v.x, v.y));
    DVec3::new(xy.x, xy.y, v.z)
}

fn stratified(photon: &Photon) -> (f64, f64) {
    let node = photon.stream >> NODE_BITS;
    let index = photon.stream & ((1 << NODE_BITS) - 1);
    Stratified::new(photon.seed, node).at(index)
}

/// Bits of a photon's stream below its node.
pub(super) const NODE_BITS: u32 = 40;

/// Inclination and offset across the fiber of a node's photons as a rank-1 sequence with a random
/// shift: evenly spread at any count, a function of the index alone. (Steps: powers of the plastic
/// number, Roberts 2018.)
#[derive(Clone, Copy, Debug)]
pub(super) struct Stratified {
    shift: [u64; 2],
}

impl Stratified {
    pub(super) fn new(seed: u64, node: u64) -> Self {
        let shift = hash64(seed ^ hash64(node + 1));
        Self {
            shift: [shift, hash64(shift)],
        }
    }

    /// The numbers of a photon, each in `[0, 1)`.
    #[inline]
    pub(super) fn at(&self, index: u64) -> (f64, f64) {
        const STEP: [u64; 2] = [0xc13f_a9a9_02a6_328f, 0x91e1_0da5_c79e_7b1d];
        let point = |k: usize| {
            let bits = index.wrapping_mul(STEP[k]).wrapping_add(self.shift[k]);
            (bits >> 11) as i64 as f64 * (1.0 / (1u64 << 53) as f64)
        };
        (point(0), point(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_even() {
        let n = 10_000u64;
        let mut counts = [[0u32; 10]; 10];
        for index in 0..n {
            let photon = Photon {
                seed: 3,
                stream: (5 << 40) | index,
                sin_range: (0.0, 1.0),
                sides: Sides::ALL,
            };
            let (a, b) = stratified(&photon);
            counts[(a * 10.0) as usize][(b * 10.0) as usize] += 1;
        }
        // Random points would scatter by 10 about 100.
        assert!(
            counts.iter().flatten().all(|c| c.abs_diff(100) < 6),
            "{counts:?}"
        );
    }
}
