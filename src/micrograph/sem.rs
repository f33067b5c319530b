//! A scanning electron micrograph: the gray of a point is how many secondary electrons leave it
//! and reach the detector.
//!
//! Secondary electrons come from the topmost nanometers. A slanted surface has more of the beam's
//! way within that depth, so that their yield goes as `1 / cos` of the angle of incidence (the
//! secant law), and near a free edge they leave through both of its sides (the edge effect): margins
//! of scales are bright lines (Goldstein et al., Scanning Electron Microscopy and X-Ray
//! Microanalysis, chapter 3). Electrons that run into a neighboring scale are lost: the corner below
//! a margin is dark.

use super::frame::{Drawn, fit};
use super::raster::{Raster, Sample};
use super::specimen::{Seen, Specimen};
use crate::fiber::{Fiber, Region};
use crate::sampling::concentric_disk;
use glam::DVec3;
use std::f64::consts::TAU;

/// Brightness of a surface seen straight on.
const GROUND: f64 = 0.2;
/// The secant law holds until the beam's way along the surface exceeds the range of its electrons.
const HIGHEST_YIELD: f64 = 6.0;
/// How far from an edge electrons still leave through its other side, micrometers. Coated hair at
/// 5 to 10 kV has a few tenths; below a tenth margins vanish between pixels, above one they merge.
const EDGE_UM: f64 = 0.5;
/// In pictures of low magnification a margin is at least so many pixels wide, as the beam is.
const EDGE_PIXELS: f64 = 1.4;
/// Gain of a point right at an edge.
const EDGE: f64 = 3.0;
/// The empty stage.
const STAGE: f64 = 0.006;
/// Toward the detector in the frame of the picture (right, up, toward the viewer), and how much
/// brighter a surface is that faces it.
const DETECTOR: DVec3 = DVec3::new(-0.35, 0.8, 0.49);
const DETECTOR_SHARE: f64 = 0.3;
/// Electrons that reach the detector from the bottom of a narrow gap all the same, drawn by its
/// field.
const FROM_GAPS: f64 = 0.15;

/// Micrometers a pixel: the whole fiber, but scales enough to know their pattern and few enough to
/// see them.
pub(super) fn scale(fiber: &Fiber, area: (usize, usize)) -> f64 {
    fit(fiber, area, 0.92, 7.0, Some(20.0))
}

pub(super) fn draw(
    fiber: &Fiber,
    tilt: f64,
    um_per_pixel: f64,
    area: (usize, usize),
    raster: &Raster,
) -> Option<Drawn> {
    let dir = DVec3::new(0.0, tilt.cos(), -tilt.sin());
    let far = 4.0 * fiber.bounding_radius_um();
    let half = 0.5 * area.1 as f64;
    let specimen = Specimen::whole(fiber);
    let edge_um = EDGE_UM.max(EDGE_PIXELS * um_per_pixel);
    let up = DVec3::X;
    let detector = DETECTOR.x * dir.cross(up) + DETECTOR.y * up - DETECTOR.z * dir;
    let canvas = raster.draw(area, |sample| {
        // Oblique: true to scale along the fiber.
        let at = DVec3::new(half - sample.y, 0.0, sample.x) * um_per_pixel;
        let signal = match specimen.look(at - far * dir, dir) {
            Some(seen) => electrons(&specimen, &seen, [dir, detector], edge_um, sample),
            None => STAGE,
        };
        // The photomultiplier saturates softly.
        DVec3::splat(1.0 - (-signal).exp())
    })?;
    Some(Drawn {
        canvas,
        um_per_pixel,
    })
}

fn electrons(
    specimen: &Specimen,
    seen: &Seen,
    [dir, detector]: [DVec3; 2],
    edge_um: f64,
    sample: &mut Sample,
) -> f64 {
    let cos = -seen.normal.dot(dir);
    let secant = (1.0 / cos.max(1e-6)).min(HIGHEST_YIELD);
    let edge = EDGE * edge_nearness(specimen.fiber, seen, edge_um, sample.rng.uniform());
    let [u, v] = sample.pair;
    let open = specimen.is_open(seen, u, v);
    let collected = FROM_GAPS + (1.0 - FROM_GAPS) * f64::from(u8::from(open));
    let turned = 1.0 - DETECTOR_SHARE + DETECTOR_SHARE * seen.normal.dot(detector);
    GROUND * (secant + edge) * collected * turned
}

/// 1 for a path just under the surface that comes out at once, 0 for one that does not within
/// `edge_um`. Round shafts have no edges in this sense.
fn edge_nearness(fiber: &Fiber, seen: &Seen, edge_um: f64, u: f64) -> f64 {
    let (x, y) = seen.normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * u).sin_cos();
    let along = cos * x + sin * y;
    let below = seen.point - 0.1 * EDGE_UM * seen.normal;
    let region = fiber.region_at(below);
    if region == Region::Outside {
        return 1.0;
    }
    match fiber.next_hit(below, along, region, None) {
        Some(hit) if hit.to == Region::Outside => (1.0 - hit.t / edge_um).max(0.0),
        _ => 0.0,
    }
}

impl Specimen<'_> {
    /// Whether a direction of the cosine law about a point's normal leads out.
    pub(super) fn is_open(&self, seen: &Seen, u: f64, v: f64) -> bool {
        let (u, v) = concentric_disk(u, v);
        let (a, b) = seen.normal.any_orthonormal_pair();
        let up = (1.0 - u * u - v * v).max(0.0).sqrt();
        let sky = (u * a + v * b + up * seen.normal).normalize();
        self.look_on(seen, sky).is_none()
    }
}
