//! A thin section across the fiber in transmitted light, drawn: what lies in the plane of the cut,
//! keratin as dark as its pigment makes it.

use super::frame::Drawn;
use super::raster::Raster;
use super::{Subject, absorption_at, pigment};
use crate::fiber::{Fiber, Region};
use glam::DVec3;
use std::f64::consts::TAU;

/// Thickness of the slice, micrometers: as microtomes cut hair.
pub(super) const SLICE_UM: f64 = 8.0;
const PAPER: DVec3 = DVec3::new(0.93, 0.93, 0.93);
const VOID: DVec3 = DVec3::new(0.50, 0.66, 0.82);
/// A medulla without cells, lighter and grayer than the keratin about it.
const MEDIUM: DVec3 = DVec3::new(0.48, 0.45, 0.50);
const OUTLINE: DVec3 = DVec3::new(0.03, 0.025, 0.02);
/// Half the width of an outline, pixels.
const LINE: f64 = 0.6;

pub(super) fn draw(subject: &Subject, area: (usize, usize), raster: &Raster) -> Option<Drawn> {
    let fiber = subject.fiber;
    let (width, height) = (area.0 as f64, area.1 as f64);
    // The major axis lies along the picture.
    let [a, b] = fiber.semi_axes_um();
    let grown = fiber.bounding_radius_um() / a;
    let um_per_pixel = (2.0 * a * grown / (0.94 * width)).max(2.0 * b * grown / (0.92 * height));
    let z = richest_plane(fiber);
    let absorption = absorption_at(subject.class, subject.station);
    let canvas = raster.draw(area, |sample| {
        let place = |dx: f64, dy: f64| {
            let x = (sample.x + dx - 0.5 * width) * um_per_pixel;
            let y = (0.5 * height - sample.y - dy) * um_per_pixel;
            DVec3::new(x, y, z)
        };
        let point = place(0.0, 0.0);
        let region = fiber.region_at(point);
        let around = [(LINE, 0.0), (-LINE, 0.0), (0.0, LINE), (0.0, -LINE)];
        let border = |(dx, dy): (f64, f64)| {
            let other = fiber.region_at(place(dx, dy));
            other != region && (other == Region::Outside || region == Region::Outside)
        };
        if around.into_iter().any(border) {
            return OUTLINE;
        }
        match region {
            Region::Outside => PAPER,
            Region::Void => VOID,
            Region::Medulla => {
                let density = fiber.medium(Region::Medulla).pigment;
                MEDIUM * pigment::keratin(absorption, SLICE_UM * density)
            }
            Region::Cuticle => pigment::keratin(absorption, 0.0),
            Region::Cortex => {
                let density = fiber.pigment_at(point, Region::Cortex);
                pigment::keratin(absorption, SLICE_UM * density)
            }
        }
    })?;
    Some(Drawn {
        canvas,
        um_per_pixel,
    })
}

/// The plane of one period that cuts most of the medulla's voids or medium.
pub(super) fn richest_plane(fiber: &Fiber) -> f64 {
    let medulla = |z: f64| {
        let probes = (0..64).map(|i| {
            let r = 0.9 * f64::from(i / 8) / 8.0;
            let phi = TAU * f64::from(i % 8) / 8.0;
            let (sin, cos) = phi.sin_cos();
            DVec3::new(cos, sin, 0.0) * (fiber.bounding_radius_um() * r) + z * DVec3::Z
        });
        probes
            .filter(|&p| matches!(fiber.region_at(p), Region::Void | Region::Medulla))
            .count()
    };
    let period = fiber.period_um();
    (0..256)
        .map(|i| period * f64::from(i) / 256.0)
        .max_by_key(|&z| medulla(z))
        .unwrap_or(0.0)
}
