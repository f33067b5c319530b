//! The S channel (fox, lynx): wedge discs, thick left and right by turns, with one channel of air
//! winding between them.
//!
//! A disc is `c/2 (1 + 0.8 s x / R)` thick, with the sign s changing from disc to disc and c their
//! distance. The gap between two discs is then a slab of thickness c/2, tilted one way or the other.
//! The thin end of a disc stops short of the wall; there the gaps before and behind it are one.

use super::Room;
use crate::fiber::convex::{Convex, Plane, Quadric};
use crate::sampling::Rng;
use glam::{DVec2, DVec3};

/// Thickness of a disc at its thick and thin ends: 1 plus and minus this.
const WEDGE: f64 = 0.8;
/// Where the thin end of a disc stops, in radii from the axis.
const THIN_END: f64 = 0.72;
/// Share of the medulla's radius that the channel takes; the rest is its tube's wall.
pub(super) const WIDTH: f64 = 0.95;

/// A gap between two discs: a slab about a tilted plane.
#[derive(Clone, Copy)]
struct Gap {
    z: f64,
    /// Rise of z along x and y.
    slope: DVec2,
    half: f64,
}

/// The gaps of one period and what joins them. They overlap.
pub(super) fn build(room: &Room<'_>, pitch_um: f64) -> Vec<Convex> {
    // An even number, or two discs of the same side meet where the period closes.
    let count = 2 * (0.5 * room.period / pitch_um).round().max(2.0) as usize;
    let pitch = room.period / count as f64;
    let semi = match room.edge {
        None => WIDTH * room.semi,
        Some(edge) => edge.half(),
    };
    let disc = Convex {
        quadrics: vec![Quadric::ellipsoid(DVec3::ZERO, semi.extend(f64::INFINITY))],
        ..Convex::default()
    };
    let discs: Vec<Convex> = match room.edge {
        None => vec![disc],
        Some(edge) => (edge.parts().iter())
            .map(|part| Convex {
                planes: part.planes(DVec2::ZERO),
                ..Convex::default()
            })
            .collect(),
    };
    let gaps: Vec<Gap> = (0..count)
        .map(|k| {
            let mut rng = Rng::new(room.seed ^ 0x5c4a_0000, k as u64);
            let mut even = || 2.0 * rng.uniform() - 1.0;
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            // The wedges turn a little about the axis.
            let toward = DVec2::from_angle(0.25 * even()) * side;
            Gap {
                z: pitch * (k as f64 + 0.5 + 0.04 * even()),
                slope: toward * (0.25 * WEDGE * pitch / semi.x) * (1.0 + 0.1 * even()),
                half: 0.25 * pitch * (1.0 + 0.12 * even()),
            }
        })
        .collect();
    let mut bodies = Vec::with_capacity(2 * count);
    for (k, &gap) in gaps.iter().enumerate() {
        let mut next = gaps[(k + 1) % count];
        if k + 1 == count {
            next.z += room.period;
        }
        let rise = (gap.slope * semi).length();
        let mut add = |z: f64, half: f64, planes: &[Plane]| {
            for disc in &discs {
                bodies.push(Convex {
                    center: DVec3::Z * z,
                    half: semi.extend(half),
                    planes: [planes, &disc.planes].concat(),
                    ..disc.clone()
                });
            }
        };
        let sides = [1.0, -1.0].map(|side| tilted(gap.slope, gap.half, side));
        add(gap.z, gap.half + rise, &sides);
        // The slab between the two middles, beyond the thin end of the disc between them: where the
        // gaps come nearest, which is where this one rises.
        let toward = gap.slope.normalize_or_zero();
        let (middle, between) = (0.5 * (gap.z + next.z), 0.5 * (next.z - gap.z));
        let sides = [
            tilted(next.slope, between, 1.0),
            tilted(gap.slope, between, -1.0),
            Plane {
                normal: (-toward).extend(0.0),
                offset: -THIN_END * (toward * semi).length(),
            },
        ];
        let rise = rise.max((next.slope * semi).length());
        add(middle, between + rise, &sides);
    }
    bodies
}

/// The half-space below (`side` 1) or above (-1) the plane `z = slope . xy + side * half`.
fn tilted(slope: DVec2, half: f64, side: f64) -> Plane {
    let normal = side * DVec3::new(-slope.x, -slope.y, 1.0);
    let length = normal.length();
    Plane {
        normal: normal / length,
        offset: half / length,
    }
}
