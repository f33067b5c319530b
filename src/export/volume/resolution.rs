//! Which voxels suit a coat.

use super::VolumeError;
use super::curve::Curves;
use super::moments::Listing;
use crate::progress::{Cancel, Silent};

/// Strands that should pass through a voxel: with fewer, density is mostly chance; with many more,
/// tufts and the edge of the coat blur.
const CROSSINGS: f64 = 8.0;
/// Voxels along a strand of mean length at least.
const ALONG: f64 = 6.0;
/// Least voxel, units: OpenVDB takes smaller ones as singular, whatever the unit.
const LEAST: f64 = 2e-5;
/// Largest voxel, meters.
const MOST_METERS: f64 = 1.0;

/// Least and largest voxel, units, where a unit is so many meters.
pub(super) fn range(meters_per_unit: f64) -> [f64; 2] {
    [LEAST, MOST_METERS / meters_per_unit]
}

/// What is known of a coat before its voxels are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Mean length along control points, units.
    pub mean_length: f64,
    /// Mean diameter by length, units.
    pub mean_width: f64,
    /// Length of strands per volume of coat, units per cubic unit; the mean distance of neighbors is
    /// one over its root.
    pub length_density: f64,
}

/// Measures a coat.
///
/// * `range`: least and largest voxel, units.
///
/// # Errors
/// No strands, strands too far from the origin.
pub(super) fn statistics(
    curves: &Curves<'_>,
    [least, most]: [f64; 2],
    cancel: &Cancel,
) -> Result<Statistics, VolumeError> {
    let (mut length, mut area) = (0.0, 0.0);
    for curve in 0..curves.len() {
        for i in curves.spans(curve) {
            let [a, b] = [i, i + 1].map(|k| curves.points[k].as_dvec3());
            let way = a.distance(b);
            length += way;
            area += way * 0.5 * f64::from(curves.widths[i] + curves.widths[i + 1]);
        }
    }
    if let Some(&at) = curves.points.iter().find(|p| !p.is_finite()) {
        return Err(VolumeError::TooFar { at, voxel: 0.0 });
    }
    if length == 0.0 {
        return Err(VolumeError::Empty);
    }
    let mean_length = length / curves.len() as f64;
    // The space that strands take: voxels in which one is, of a size that neighbors do not leave empty
    // unless the coat is so thin that single hairs are what there is.
    let probe = (mean_length / ALONG).clamp(least, most);
    let taken = Listing::new(curves, probe, &Silent, cancel)?;
    let voxels: usize = taken
        .map(curves, &Silent, cancel, |_, moments| {
            moments.iter().filter(|m| m.length > 0.0).count()
        })?
        .iter()
        .sum();
    Ok(Statistics {
        mean_length,
        mean_width: area / length,
        length_density: length / (voxels as f64 * probe.powi(3)),
    })
}

impl Statistics {
    /// Edge of the voxel that eight strands pass through on average, at most a sixth of a strand's
    /// length and at least two diameters, rounded to two digits and within the range; units.
    pub(super) fn voxel(&self, [least, most]: [f64; 2]) -> f64 {
        // A line through a cube is two thirds of its edge long on average.
        let wanted = (CROSSINGS / (1.5 * self.length_density)).sqrt();
        let voxel = wanted
            .min(self.mean_length / ALONG)
            .max(2.0 * self.mean_width);
        let voxel = voxel.clamp(least, most);
        let digit = 10f64.powf(voxel.log10().floor() - 1.0);
        ((voxel / digit).round() * digit).max(least)
    }
}
