//! Cortical fusi: slender slits of air in the cortex.

use super::FiberError;
use super::bodies::Bodies;
use super::convex::{Convex, Quadric};
use super::section::Section;
use crate::sampling::Rng;
use glam::{DVec2, DVec3};

/// Length and width, micrometers (estimates: fusi are described as slender and below the size of
/// cells; longer ones would be taken for a fragmentary medulla).
const LENGTH_UM: f64 = 10.0;
const WIDTH_UM: f64 = 0.8;
/// Keratin that a fusus keeps from the medulla and from the cuticle's lowest point, micrometers.
const MARGIN_UM: f64 = 0.3;

/// The fusi of one period; they may overlap.
///
/// * `inner`, `outer`: where the cortex begins and ends, in units of the section's radius.
///
/// # Errors
/// When the cortex is thinner than a fusus.
pub(super) fn build(
    per_mm: f64,
    section: &Section,
    (inner, outer): (f64, f64),
    period: f64,
    seed: u64,
) -> Result<Option<Bodies>, FiberError> {
    let count = (per_mm * 1e-3 * period)
        .round()
        .max(f64::from(u8::from(per_mm > 0.0)));
    if count == 0.0 {
        return Ok(None);
    }
    let margin = (0.5 * WIDTH_UM + MARGIN_UM) / section.b;
    let (lo, hi) = (
        (inner + margin) * f64::from(u8::from(inner > 0.0)),
        outer - margin,
    );
    if lo >= hi {
        return Err(FiberError::NoRoomForFusi {
            needed_um: WIDTH_UM + 2.0 * MARGIN_UM,
            cortex_um: (outer - inner) * section.b,
        });
    }
    let semi = DVec3::new(0.5 * WIDTH_UM, 0.5 * WIDTH_UM, 0.5 * LENGTH_UM);
    let fusi = (0..count as u64).map(|k| {
        let mut rng = Rng::new(seed ^ 0xf051_0000, k);
        // Even over the area.
        let rho = (lo * lo + (hi * hi - lo * lo) * rng.uniform()).sqrt();
        let phi = std::f64::consts::TAU * rng.uniform();
        let across = DVec2::from_angle(phi) * rho * section.rho(phi);
        let size = 0.7 + 0.6 * rng.uniform();
        let semi = DVec3::new(semi.x, semi.y, size * semi.z);
        Convex {
            center: DVec3::new(
                across.x * section.a,
                across.y * section.b,
                period * rng.uniform(),
            ),
            half: semi,
            planes: Vec::new(),
            quadrics: vec![Quadric::ellipsoid(DVec3::ZERO, semi)],
            island: false,
        }
    });
    let widest = section.radii().into_iter().fold(0.0, f64::max);
    let half = [outer * widest * section.a, outer * widest * section.b];
    Ok(Some(Bodies::new(fusi.collect(), period, half, true)))
}
