//! Where photons start: evenly over inclination, width, length and rotation of the fiber.

use super::{End, Flight, follow};
use crate::fiber::{Fiber, Region};
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
