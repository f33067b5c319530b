//! The S channel (fox, lynx): wedge discs, thick left and right by turns, with one channel of air
//! winding between them.
//!
//! A disc is `c/2 (1 + 0.8 s x / R)` thick, with the sign s changing from disc to disc and c their
//! distance. The gap between two discs is then a slab of thickness c/2, tilted one way or the other.
//! The thin end of a disc stops short of the wall; there the gaps before and behind it are one.

use super::Room;
use crate::fiber::cells::{Cell, Cells, Face, Neighbor};
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

/// What fills the medulla: the voids, and the same by cells between the middles of the gaps.
pub(super) struct Channel {
    pub(super) voids: Vec<Convex>,
    /// `None` where a disc is so thin that the gaps before and behind it meet, and in a section that
    /// is no ellipse.
    pub(super) cells: Option<Cells>,
}

/// The gaps of one period and what joins them. They overlap.
pub(super) fn build(room: &Room<'_>, pitch_um: f64) -> Channel {
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
        let (toward, thin) = gap.thin_end(semi);
        let (middle, between) = (0.5 * (gap.z + next.z), 0.5 * (next.z - gap.z));
        let sides = [
            tilted(next.slope, between, 1.0),
            tilted(gap.slope, between, -1.0),
            Plane {
                normal: -toward.extend(0.0),
                offset: -thin,
            },
        ];
        let rise = rise.max((next.slope * semi).length());
        add(middle, between + rise, &sides);
    }
    Channel {
        voids: bodies,
        cells: match room.edge {
            None => fill(&gaps, semi, room.period),
            Some(_) => None,
        },
    }
}

impl Gap {
    /// Direction of the thin end of the disc above the gap, and how far out it is.
    fn thin_end(&self, semi: DVec2) -> (DVec2, f64) {
        let toward = self.slope.normalize_or_zero().as_vec2().as_dvec2();
        // As single precision has it: see `Face::new`.
        let thin = THIN_END * (toward * semi).length();
        (toward, f64::from(thin as f32))
    }

    /// z of its lower end (-1), its middle (0) or its upper end (1) on the axis.
    fn level(&self, side: f64) -> f64 {
        self.z + side * self.half
    }
}

/// Between the middles of two gaps lie, on the disc's side of its thin end, half a gap, the disc and
/// half a gap, and beyond it the channel.
fn fill(gaps: &[Gap], semi: DVec2, period: f64) -> Option<Cells> {
    let n = gaps.len();
    let mut cells = Vec::with_capacity(4 * n);
    for (k, &gap) in gaps.iter().enumerate() {
        let mut next = gaps[(k + 1) % n];
        if k + 1 == n {
            next.z += period;
        }
        let (toward, thin) = gap.thin_end(semi);
        if !is_whole(gap, next, semi, (toward, thin)) {
            return None;
        }
        let middle = 0.5 * (gap.z + next.z);
        let here = |cells: &[usize]| -> Vec<Neighbor> {
            cells.iter().map(|c| Neighbor::new(4 * k + c, 0)).collect()
        };
        // Whichever of these two of the next gap is there.
        let others = |up: bool, cell: usize| -> Vec<Neighbor> {
            let (index, wrap) = match (up, k) {
                (true, _) if k + 1 == n => (0, 1),
                (true, _) => (k + 1, 0),
                (false, 0) => (n - 1, -1),
                (false, _) => (k - 1, 0),
            };
            [cell, BEYOND]
                .map(|c| Neighbor::new(4 * index + c, wrap))
                .to_vec()
        };
        let plane = |gap: &Gap, level: f64, side: f64, next: Vec<Neighbor>| {
            let Plane { normal, offset } =
                tilted(gap.slope, side * (gap.level(level) - middle), side);
            Face::new(normal, offset, offset, next)
        };
        let end =
            |side: f64, next| Face::new(side * toward.extend(0.0), side * thin, side * thin, next);
        let kinds = [
            (
                plane(&gap, 0.0, -1.0, others(false, UPPER)),
                plane(&gap, 1.0, 1.0, here(&[DISC])),
                end(1.0, here(&[BEYOND])),
            ),
            (
                plane(&gap, 1.0, -1.0, here(&[LOWER])),
                plane(&next, -1.0, 1.0, here(&[UPPER])),
                end(1.0, here(&[BEYOND])),
            ),
            (
                plane(&next, -1.0, -1.0, here(&[DISC])),
                plane(&next, 0.0, 1.0, others(true, LOWER)),
                end(1.0, here(&[BEYOND])),
            ),
            (
                plane(&gap, 0.0, -1.0, others(false, UPPER)),
                plane(&next, 0.0, 1.0, others(true, LOWER)),
                end(-1.0, here(&[LOWER, DISC, UPPER])),
            ),
        ];
        for (kind, (below, above, end)) in kinds.into_iter().enumerate() {
            cells.push(Cell {
                center: DVec3::Z * middle,
                faces: vec![below, above, end],
                air: kind != DISC,
                rim: true,
            });
        }
    }
    Some(Cells::new(&cells, semi, period, period / n as f64))
}

/// Cells between the middles of two gaps.
const LOWER: usize = 0;
const DISC: usize = 1;
const UPPER: usize = 2;
const BEYOND: usize = 3;

/// Whether the disc between two gaps has a thickness wherever it is, and the gaps' middles a distance.
fn is_whole(gap: Gap, next: Gap, semi: DVec2, (toward, thin): (DVec2, f64)) -> bool {
    let rise = next.slope - gap.slope;
    let apart = next.z - gap.z - (rise * semi).length();
    let thickness = |p: DVec2| next.level(-1.0) - gap.level(1.0) + rise.dot(p);
    // A linear function is least where the outline faces down, or, if the disc is not there, at the ends
    // of its edge.
    let lowest = -semi * (rise * semi).normalize_or_zero();
    let (along, reach) = (toward.perp(), (toward * semi).length());
    let across = (1.0 - THIN_END * THIN_END).sqrt();
    let foot = semi * semi * toward * (thin / (reach * reach));
    let chord = along * (across * semi.x * semi.y / reach);
    let points = [lowest, foot + chord, foot - chord];
    apart > 0.0
        && points
            .iter()
            .all(|&p| toward.dot(p) > thin * (1.0 + 1e-6) || thickness(p) > 0.0)
}

/// The half-space below (`side` 1) or above (-1) the plane `z = slope . xy + side * half`.
fn tilted(slope: DVec2, half: f64, side: f64) -> Plane {
    let normal = side * DVec3::new(-slope.x, -slope.y, 1.0);
    let length = normal.length();
    Plane {
        // As single precision has it: see `Face::new`.
        normal: (normal / length).as_vec3().as_dvec3(),
        offset: half / length,
    }
}
