//! One photon through one fiber: a function of (fiber, photon) and nothing else.

use super::{boundary, microfacet};
use crate::fiber::{Fiber, Hit, Medium, Optics, Region};
use crate::sampling::Rng;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// The identity of a photon and the range of directions it comes from.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Seed of the bake.
    pub seed: u64,
    /// Number of the photon; node in the high bits, index in the low 40.
    pub stream: u64,
    /// Range of sin(theta) of the query direction, uniform in solid angle over it.
    pub sin_range: (f64, f64),
}

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
    /// Inclination of the query direction, radians.
    pub theta: f64,
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

/// Entries tried before a photon counts as missed: its beam covers the bounding cylinder, most of
/// which is fiber, so one in thousands needs more than two.
const ENTRY_TRIES: u32 = 64;

/// Flies a photon: enters uniformly over projected width, one period and all rotations of the fiber,
/// then reflects, refracts and scatters by chance until it leaves.
///
/// * `max_events`: given up inside after this many events.
pub fn fly(fiber: &Fiber, photon: &Photon, max_events: u32) -> Flight {
    let mut rng = Rng::new(photon.seed, photon.stream);
    let (along, across) = stratified(photon);
    let (lo, hi) = photon.sin_range;
    let sin = lo + (hi - lo) * along;
    let cos = (1.0 - sin * sin).max(0.0).sqrt();
    let flight = Flight {
        theta: sin.atan2(cos),
        path_um: 0.0,
        share: 1.0,
        events: 0,
        end: End::Missed,
    };

    let turn = DVec2::from_angle(TAU * rng.uniform());
    let dir = rotate(DVec3::new(-cos, 0.0, -sin), turn);
    let radius = fiber.bounding_radius_um();
    let mut h = 2.0 * across - 1.0;
    let mut entry = None;
    for _ in 0..ENTRY_TRIES {
        // On the side of the bounding cylinder that the beam comes from, a little outside it.
        let x = (1.0 - h * h).max(0.0).sqrt() + 1e-3;
        let z = fiber.period_um() * rng.uniform();
        let origin = rotate(DVec3::new(radius * x, radius * h, z), turn);
        if let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) {
            entry = Some((origin + hit.t * dir, hit));
            break;
        }
        h = 2.0 * rng.uniform() - 1.0;
    }
    let Some((p, hit)) = entry else {
        return flight;
    };
    let way = follow(fiber, p, dir, hit, &mut rng, max_events);
    let back = DVec2::new(turn.x, -turn.y);
    Flight {
        theta: flight.theta,
        end: match way.end {
            End::Escaped(dir) => End::Escaped(rotate(dir, back)),
            other => other,
        },
        ..way
    }
}

/// Follows a photon that comes from outside and has just met the fiber, by chance, until it leaves.
///
/// * `p`, `dir`, `hit`: where it meets the fiber, its unit direction, and what it meets there.
/// * The directions of the result are in the fiber's frame; `theta` is that of the light's source.
#[inline]
pub fn follow(
    fiber: &Fiber,
    mut p: DVec3,
    mut dir: DVec3,
    mut hit: Hit,
    rng: &mut Rng,
    max_events: u32,
) -> Flight {
    let mut flight = Flight {
        theta: -dir.z.clamp(-1.0, 1.0).asin(),
        path_um: 0.0,
        share: 1.0,
        events: 0,
        end: End::Missed,
    };

    let mut region = Region::Outside;
    loop {
        // At a boundary: go through or turn back.
        let ratio = microfacet::Ratio {
            eta: fiber.eta(region, hit.to),
            inverse: fiber.eta(hit.to, region),
        };
        let mut from = Some(hit.state);
        let optics = fiber.optics(hit.part);
        if ratio.eta == 1.0 && matches!(optics, Optics::Dielectric { .. }) {
            region = hit.to;
        } else {
            flight.events += 1;
            let turned = match optics {
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
                flight.end = End::Lost;
                return flight;
            };
            dir = turned.dir;
            if turned.transmitted {
                region = hit.to;
            }
        }
        if flight.share < FAINT && is_taken(&mut flight.share, rng) {
            flight.end = End::Absorbed;
            return flight;
        }
        // To the next boundary, with scatterings on the way.
        let medium = fiber.medium(region);
        hit = loop {
            let next = fiber.next_hit(p, dir, region, from);
            if region == Region::Outside {
                match next {
                    None => flight.end = End::Escaped(dir),
                    Some(_) if flight.events >= max_events => flight.end = End::Truncated,
                    Some(hit) => break hit,
                }
                return flight;
            }
            if flight.events >= max_events {
                flight.end = End::Truncated;
                return flight;
            }
            let Some(next) = next else {
                flight.end = End::Lost;
                return flight;
            };
            if medium.scattering_per_um > 0.0 {
                let free = -(1.0 - rng.uniform()).ln() / medium.scattering_per_um;
                if free < next.t {
                    flight.events += 1;
                    flight.path_um += fiber.pigment_um(p, dir, region, free);
                    flight.share *= transmitted(medium, free);
                    p += free * dir;
                    dir = henyey_greenstein(dir, medium.asymmetry, rng);
                    from = None;
                    continue;
                }
            }
            flight.path_um += next.pigment_um;
            flight.share *= transmitted(medium, next.t);
            break next;
        };
        p += hit.t * dir;
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

/// Rotates about z by the angle whose cosine and sine are `turn`.
fn rotate(v: DVec3, turn: DVec2) -> DVec3 {
    let xy = turn.rotate(DVec2::new(v.x, v.y));
    DVec3::new(xy.x, xy.y, v.z)
}

/// Inclination and offset across the fiber as a rank-1 sequence with a random shift: evenly spread
/// at any count, a function of the index alone. (Steps: powers of the plastic number, Roberts 2018.)
fn stratified(photon: &Photon) -> (f64, f64) {
    const STEP: [u64; 2] = [0xc13f_a9a9_02a6_328f, 0x91e1_0da5_c79e_7b1d];
    const NODE_BITS: u32 = 40;
    let node = photon.stream >> NODE_BITS;
    let index = photon.stream & ((1 << NODE_BITS) - 1);
    let shift = crate::sampling::hash64(photon.seed ^ crate::sampling::hash64(node + 1));
    let point = |step: u64, shift: u64| {
        let bits = index.wrapping_mul(step).wrapping_add(shift);
        (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    };
    (
        point(STEP[0], shift),
        point(STEP[1], crate::sampling::hash64(shift)),
    )
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
    let (sin_phi, cos_phi) = (TAU * rng.uniform()).sin_cos();
    let (a, b) = dir.any_orthonormal_pair();
    (sin * cos_phi * a + sin * sin_phi * b + cos * dir).normalize()
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

    #[test]
    fn entries_are_even() {
        let n = 10_000u64;
        let mut counts = [[0u32; 10]; 10];
        for index in 0..n {
            let photon = Photon {
                seed: 3,
                stream: (5 << 40) | index,
                sin_range: (0.0, 1.0),
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
