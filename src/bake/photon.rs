//! One photon through one fiber: a function of (fiber, photon) and nothing else.

use super::boundary;
use super::microfacet::{self, Turn};
use crate::fiber::{Fiber, Hit, HitState, Medium, Optics, Region};
use crate::math::turn::unit_vector_of;
use crate::sampling::Rng;
use glam::{DVec2, DVec3};

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Left along this unit direction, in the frame where the query direction has azimuth 0.
    Escaped(DVec3),
    /// Nothing was left of it, in a medium or at an opaque boundary.
    Absorbed,
    /// Used up its events.
    Truncated,
    /// Found no boundary where there must be one.
    Lost,
    /// Never met the fiber.
    Missed,
}

/// A photon's flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Cosine and sine of the inclination of the query direction.
    pub query: DVec2,
    /// Length of path through pigment, weighted by its density, micrometers.
    pub path_um: f64,
    /// Share of the light that opaque boundaries and absorbing media have left, pigment aside: 1 in
    /// plain keratin.
    pub share: f64,
    /// Reflections, refractions and scatterings.
    pub events: u32,
    /// How it ended.
    pub end: End,
}

impl Flight {
    /// Inclination of the query direction, radians.
    pub fn theta(&self) -> f64 {
        self.query.y.atan2(self.query.x)
    }
}

/// Follows a photon that comes from outside and has just met the fiber, by chance, until it leaves.
///
/// * `p`, `dir`, `hit`: where it meets the fiber, its unit direction, and what it meets there.
/// * The directions of the result are in the fiber's frame; `query` is that of the light's source.
#[inline]
pub fn follow(
    fiber: &Fiber,
    p: DVec3,
    dir: DVec3,
    hit: Hit,
    rng: &mut Rng,
    max_events: u32,
) -> Flight {
    follow_from(fiber, p, dir, hit, None, rng, max_events)
}

/// [`follow`] with the decision at the first boundary already taken if `first` says so.
#[inline]
pub(super) fn follow_from(
    fiber: &Fiber,
    p: DVec3,
    dir: DVec3,
    mut hit: Hit,
    mut first: Option<Turn>,
    rng: &mut Rng,
    max_events: u32,
) -> Flight {
    let mut path = Path::new(p, dir);
    loop {
        if let Some(end) = path.decide(fiber, &hit, first.take(), rng) {
            return path.ended(end);
        }
        hit = loop {
            if path.is_spent(max_events) {
                return path.ended(End::Truncated);
            }
            let next = fiber.next_hit(path.p, path.dir, path.region, path.from);
            match path.go(fiber, next, rng, max_events) {
                Gone::Met(hit) => break hit,
                Gone::Scattered => {}
                Gone::Ended(end) => return path.ended(end),
            }
        };
    }
}

/// A photon on its way, with what has become of it so far.
pub(super) struct Path {
    pub(super) p: DVec3,
    pub(super) dir: DVec3,
    pub(super) region: Region,
    /// What it starts on.
    pub(super) from: Option<HitState>,
    flight: Flight,
}

/// What came of a way through a region.
pub(super) enum Gone {
    /// The photon is at a boundary.
    Met(Hit),
    /// It goes on in the same region elsewhere.
    Scattered,
    Ended(End),
}

impl Path {
    /// A photon that comes from outside to a place on a boundary.
    #[inline]
    pub(super) fn new(p: DVec3, dir: DVec3) -> Self {
        Self {
            p,
            dir,
            region: Region::Outside,
            from: None,
            flight: Flight {
                query: DVec2::new((1.0 - dir.z * dir.z).max(0.0).sqrt(), -dir.z),
                path_um: 0.0,
                share: 1.0,
                events: 0,
                end: End::Missed,
            },
        }
    }

    /// At a boundary: goes through or turns back. The end, if it is one.
    ///
    /// * `first`: what was decided before.
    #[inline]
    pub(super) fn decide(
        &mut self,
        fiber: &Fiber,
        hit: &Hit,
        first: Option<Turn>,
        rng: &mut Rng,
    ) -> Option<End> {
        let Self { dir, region, .. } = *self;
        let flight = &mut self.flight;
        let ratio = microfacet::Ratio {
            eta: fiber.eta(region, hit.to),
            inverse: fiber.eta(hit.to, region),
        };
        self.from = Some(hit.state);
        let optics = fiber.optics(hit.part);
        if ratio.eta == 1.0 && matches!(optics, Optics::Dielectric { .. }) {
            self.region = hit.to;
        } else {
            flight.events += 1;
            let turned = match optics {
                _ if first.is_some() => first,
                Optics::Dielectric { roughness } if *roughness > 0.0 => {
                    microfacet::rough(dir, hit.normal, ratio, *roughness, rng)
                }
                Optics::Dielectric { .. } => Some(microfacet::smooth(dir, hit.normal, ratio, rng)),
                _ => {
                    let near = fiber.medium(region).ior;
                    let met = boundary::meet(optics, dir, hit.normal, ratio, near, rng);
                    met.map(|(turned, share)| {
                        flight.share *= share;
                        turned
                    })
                }
            };
            let Some(turned) = turned else {
                return Some(End::Lost);
            };
            self.dir = turned.dir;
            if turned.transmitted {
                self.region = hit.to;
            }
        }
        (flight.share < FAINT && is_taken(&mut flight.share, rng)).then_some(End::Absorbed)
    }

    /// Whether it is inside with all its events used up.
    #[inline]
    pub(super) fn is_spent(&self, max_events: u32) -> bool {
        self.region != Region::Outside && self.flight.events >= max_events
    }

    /// Goes to the next boundary, unless it scatters on the way. Not for one that is spent.
    ///
    /// * `next`: the boundary, as [`Fiber::next_hit`] says.
    #[inline]
    pub(super) fn go(
        &mut self,
        fiber: &Fiber,
        next: Option<Hit>,
        rng: &mut Rng,
        max_events: u32,
    ) -> Gone {
        let Self { p, dir, region, .. } = *self;
        let flight = &mut self.flight;
        let next = match next {
            Some(next) => next,
            None if region == Region::Outside => return Gone::Ended(End::Escaped(dir)),
            None => return Gone::Ended(End::Lost),
        };
        if region == Region::Outside {
            if flight.events >= max_events {
                return Gone::Ended(End::Truncated);
            }
        } else {
            let medium = fiber.medium(region);
            if medium.scattering_per_um > 0.0 {
                let free = -(1.0 - rng.uniform()).ln() / medium.scattering_per_um;
                if free < next.t {
                    flight.events += 1;
                    flight.path_um += fiber.pigment_um(p, dir, region, free);
                    flight.share *= transmitted(medium, free);
                    self.p += free * dir;
                    self.dir = henyey_greenstein(dir, medium.asymmetry, rng);
                    self.from = None;
                    return Gone::Scattered;
                }
            }
            flight.path_um += next.pigment_um;
            flight.share *= transmitted(medium, next.t);
        }
        self.p += next.t * dir;
        Gone::Met(next)
    }

    /// The flight that it was.
    #[inline]
    pub(super) fn ended(&self, end: End) -> Flight {
        Flight { end, ..self.flight }
    }
}

/// Photons with less than this share live on by chance. Smaller: dark cavities are walked through for
/// ever; larger: the noise of roulette shows in dim lobes.
const FAINT: f64 = 1.0 / 64.0;

/// Roulette: whether a faint photon ends here; if not, it stands for those that did.
#[cold]
fn is_taken(share: &mut f64, rng: &mut Rng) -> bool {
    let survives = rng.uniform() * FAINT < *share;
    *share = if survives { FAINT } else { 0.0 };
    !survives
}

/// Share that a medium lets through, pigment and scattering aside.
#[inline]
fn transmitted(medium: &Medium, way_um: f64) -> f64 {
    if medium.absorption_per_um > 0.0 {
        (-medium.absorption_per_um * way_um).exp()
    } else {
        1.0
    }
}

/// A direction scattered by the Henyey-Greenstein function of asymmetry `g`.
fn henyey_greenstein(dir: DVec3, g: f64, rng: &mut Rng) -> DVec3 {
    let u = rng.uniform();
    let cos = if g.abs() < 1e-3 {
        1.0 - 2.0 * u
    } else {
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let around = unit_vector_of(rng.bits());
    let (a, b) = dir.any_orthonormal_pair();
    (sin * around.x * a + sin * around.y * b + cos * dir).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattering_has_its_mean_cosine() {
        let mut rng = Rng::new(5, 5);
        let dir = DVec3::new(0.3, -0.5, 0.8).normalize();
        for g in [-0.6, 0.0, 0.5, 0.95] {
            let n = 100_000;
            let sum: f64 = (0..n)
                .map(|_| henyey_greenstein(dir, g, &mut rng).dot(dir))
                .sum();
            assert!(
                (sum / f64::from(n) - g).abs() < 4.0 / f64::from(n).sqrt(),
                "{g}"
            );
        }
    }
}
