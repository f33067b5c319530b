//! Level of detail: a medulla of many small cells as a homogeneous medium, and the measure of air.

use crate::fiber::bodies::Bodies;
use crate::species::{Medulla, MedullaKind};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A medium that stands for voids too many to build, or is given as such. Its index is the keratin's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fiber) struct Homogeneous {
    /// Scattering coefficient, per micrometer.
    pub(in crate::fiber) scattering_per_um: f64,
    /// Asymmetry of the Henyey-Greenstein function.
    pub(in crate::fiber) asymmetry: f64,
    /// Pigment relative to the cortex.
    pub(in crate::fiber) pigment: f64,
}

/// Cells across the medulla up to which they are built one by one.
const MOST_ACROSS: f64 = 24.0;
/// Voids in a period up to which they are built one by one. Packing that many bubbles takes a tenth of
/// a second, and beyond them a photon's time goes to waiting for memory.
const MOST_VOIDS: f64 = 4000.0;
/// Mean cosine of scattering by an air bubble in keratin without the diffracted part, which goes
/// straight on (geometric optics, index 1.55).
const BUBBLE_ASYMMETRY: f64 = 0.5;

/// Spread of cells through space.
struct Grain {
    /// Distance of cells, micrometers.
    cell_um: f64,
    /// Air's share of the volume, and its surface per volume, per micrometer.
    air: f64,
    surface: f64,
    /// Volume of a void with its share of the walls, cubic micrometers.
    volume: f64,
}

/// The medium of a medulla that is one, or that has too many cells.
///
/// * `radius_um`: geometric mean of the medulla's semi-axes.
pub(super) fn medium(medulla: &Medulla, radius_um: f64, period: f64) -> Option<Homogeneous> {
    if let MedullaKind::Medium {
        scattering_per_um,
        asymmetry,
    } = medulla.kind
    {
        return Some(Homogeneous {
            scattering_per_um,
            asymmetry,
            pigment: medulla.pigment,
        });
    }
    let grain = grain(&medulla.kind)?;
    let across = 2.0 * radius_um / grain.cell_um;
    let count = PI * radius_um * radius_um * period / grain.volume;
    (across > MOST_ACROSS || count > MOST_VOIDS).then(|| grain.medium(medulla.pigment))
}

/// What a medulla of many small cells is like as a medium; `None` for those with few large ones.
#[cfg(test)]
pub(in crate::fiber) fn equivalent(medulla: &Medulla) -> Option<Homogeneous> {
    grain(&medulla.kind).map(|grain| grain.medium(medulla.pigment))
}

impl Grain {
    /// Voids met per length along a line are a quarter of their surface per volume (Cauchy): that is
    /// the scattering coefficient. Absorption is that of the keratin between them: in a field that is
    /// the same in all directions, rays pass every medium in the proportion of its volume times its
    /// index squared, and the medium here has the keratin's index everywhere.
    ///
    /// Between flat walls the field is not: light that runs within a wall meets hardly any from outside.
    /// A lattice of black hair sends a fifth more back than its medium; no animal of the library has cells
    /// so many that the medium would stand for them.
    fn medium(&self, pigment: f64) -> Homogeneous {
        Homogeneous {
            scattering_per_um: 0.25 * self.surface,
            asymmetry: BUBBLE_ASYMMETRY,
            pigment: pigment * (1.0 - self.air),
        }
    }
}

fn grain(kind: &MedullaKind) -> Option<Grain> {
    Some(match *kind {
        MedullaKind::Froth {
            radius_um,
            radius_sigma,
            air_fraction,
        } => bubbles(radius_um, radius_sigma, air_fraction),
        MedullaKind::Amorphous {
            radius_um,
            air_fraction,
        } => bubbles(radius_um, super::AMORPHOUS_SIGMA, air_fraction),
        MedullaKind::Multiserial {
            cell_um,
            pitch_um,
            septum_um,
        }
        | MedullaKind::TireTread {
            pitch_um,
            cell_um,
            septum_um,
        } => {
            let (w, h) = (cell_um - septum_um, pitch_um - septum_um);
            let volume = cell_um * cell_um * pitch_um;
            Grain {
                cell_um,
                air: w * w * h / volume,
                surface: 2.0 * w * (w + 2.0 * h) / volume,
                volume,
            }
        }
        MedullaKind::Lattice { cell_um, wall_um } => {
            // A truncated octahedron of volume 1 has a surface of 5.315 (Kelvin's foam).
            let edge = (0.5f64).cbrt() * 1.1 * cell_um;
            let void = edge * (1.0 - wall_um / cell_um);
            Grain {
                cell_um,
                air: (void / edge).powi(3),
                surface: 5.315 * void * void / edge.powi(3),
                volume: edge.powi(3),
            }
        }
        MedullaKind::None
        | MedullaKind::Medium { .. }
        | MedullaKind::Ladder { .. }
        | MedullaKind::SChannel { .. }
        | MedullaKind::Cloisonne { .. }
        | MedullaKind::Globules { .. } => return None,
    })
}

/// Spheres with log-normal radii, whose means of powers are known.
fn bubbles(median_um: f64, sigma: f64, air: f64) -> Grain {
    let power = |k: f64| median_um.powf(k) * (0.5 * k * k * sigma * sigma).exp();
    let bubble = 4.0 / 3.0 * PI * power(3.0);
    let volume = bubble / air.max(1e-6);
    Grain {
        cell_um: volume.cbrt(),
        air,
        surface: air * 4.0 * PI * power(2.0) / bubble,
        volume,
    }
}

/// Share of the medulla that is air, by the chords of a bundle of lines across, evenly spread: bodies
/// overlap, so that their volumes do not add up.
///
/// * `semi`: of an ellipse that holds the bodies; `area`: the medulla's.
pub(super) fn measured_air(bodies: &Bodies, semi: DVec2, area: f64, period: f64) -> f64 {
    const LINES: u32 = 4000;
    // Steps of a rank-1 lattice: the plastic number's powers (Roberts 2018).
    let (mut sum, dir) = (0.0, DVec3::X);
    for i in 0..LINES {
        let i = f64::from(i) + 0.5;
        let (u, v) = ((i * 0.754_877_666).fract(), (i * 0.569_840_291).fract());
        let y = 2.0 * u - 1.0;
        let chord = semi.x * (1.0 - y * y).sqrt();
        let mut p = DVec3::new(-chord, y * semi.y, v * period);
        let mut from = None;
        while let Some((t, face)) = bodies.enter(p, dir, 0.0, chord - p.x, from) {
            p += t * dir;
            let Some((t, face)) = bodies.leave(p, dir, Some(face)) else {
                break;
            };
            sum += t;
            p += t * dir;
            from = Some(face);
        }
    }
    // Lines are dense in y by 2 b / LINES over the period.
    sum * 2.0 * semi.y / f64::from(LINES) / area
}
