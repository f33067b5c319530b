//! A piece of the fiber with its front quarter taken out and its tip end cut across: scales outside,
//! medulla and pigment inside.

use super::frame::Drawn;
use super::pigment;
use super::raster::{Raster, Sample};
use super::section::{SLICE_UM, richest_plane};
use super::specimen::{HalfSpace, Seen, Specimen, What};
use super::{Subject, absorption_at};
use crate::fiber::Region;
use crate::sampling::concentric_disk;
use glam::{DMat3, DVec3};

/// Toward the viewer: over the flat side of the fiber, from its tip end.
const TOWARD_VIEWER: DVec3 = DVec3::new(0.36, -0.8, 0.48);
/// Toward the lamp in the frame of the picture (right, up, toward the viewer).
const LAMP: DVec3 = DVec3::new(-0.6, 0.62, 0.5);
/// Radius of the lamp, radians: margins throw shadows with soft edges.
const LAMP_SIZE: f64 = 0.3;
const BACKGROUND: DVec3 = DVec3::new(0.86, 0.87, 0.88);
/// The quarter begins this far along the piece.
const QUARTER_FROM: f64 = 0.36;
/// Rows of scales shown at least.
const ROWS: f64 = 8.0;
/// Outside, pigment shows through a little.
const SKIN_DEEP_UM: f64 = 2.0;
const VOID_WALL: DVec3 = DVec3::new(0.62, 0.72, 0.84);
const MEDIUM: DVec3 = DVec3::new(0.62, 0.58, 0.64);

pub(super) fn draw(subject: &Subject, area: (usize, usize), raster: &Raster) -> Option<Drawn> {
    let fiber = subject.fiber;
    let (width, height) = (area.0 as f64, area.1 as f64);
    let back = TOWARD_VIEWER.normalize();
    let right = (DVec3::Z - back.z * back).normalize();
    let up = back.cross(right);
    // What of its length the picture shows: it is seen at a slant.
    let along = right.z;
    let diameter = 2.0 * fiber.bounding_radius_um();
    let rows = ROWS * fiber.structure().cuticle.pitch_um * along;
    let scale = (diameter / (0.74 * height)).max(rows / (0.8 * width));
    let end_face = 0.5 * diameter * back.z;
    let length = (0.94 * width * scale - end_face) / along;
    // The end lies in a plane with voids to see; the piece begins off the picture.
    let end = richest_plane(fiber) + fiber.period_um() * (length / fiber.period_um()).ceil();
    let toward = DVec3::new(back.x, back.y, 0.0).normalize();
    let side = DVec3::new(-toward.y, toward.x, 0.0);
    let from = end - (1.0 - QUARTER_FROM) * length;
    let plane = |normal, offset| HalfSpace { normal, offset };
    let quarter = vec![
        plane((toward + side).normalize(), 0.0),
        plane((toward - side).normalize(), 0.0),
        plane(DVec3::Z, from),
    ];
    let lamp = DMat3::from_cols(right, up, back) * LAMP.normalize();
    let stage = Stage {
        specimen: Specimen::without(fiber, vec![quarter, vec![plane(DVec3::Z, end)]]),
        absorption: absorption_at(subject.class, subject.station),
        lamp,
    };
    let middle = DVec3::Z * end + end_face * right;
    let canvas = raster.draw(area, |sample| {
        let across = (sample.x - 0.97 * width) * scale;
        let at = middle + across * right + (0.5 * height - sample.y) * scale * up;
        let origin = at + (4.0 * length.max(diameter)) * back;
        match stage.specimen.look(origin, -back) {
            Some(seen) => stage.shade(&seen, sample),
            None => BACKGROUND,
        }
    })?;
    Some(Drawn {
        canvas,
        um_per_pixel: scale / along,
    })
}

/// A longitudinal cut, seen a little from the tip: all but the root end of the piece without its
/// front half.
pub(super) fn halved(
    subject: &Subject,
    area: (usize, usize),
    um_per_pixel: f64,
    raster: &Raster,
) -> Option<Drawn> {
    const TILT: f64 = 0.3;
    let fiber = subject.fiber;
    let length = area.0 as f64 * um_per_pixel;
    let dir = DVec3::new(0.0, TILT.cos(), -TILT.sin());
    let plane = |normal, offset| HalfSpace { normal, offset };
    let front = vec![plane(DVec3::NEG_Y, 0.0), plane(DVec3::Z, 0.2 * length)];
    let stage = Stage {
        specimen: Specimen::without(fiber, vec![front]),
        absorption: absorption_at(subject.class, subject.station),
        lamp: DVec3::new(0.5, -0.8, -0.25).normalize(),
    };
    let half = 0.5 * area.1 as f64;
    let far = 4.0 * fiber.bounding_radius_um();
    let canvas = raster.draw(area, |sample| {
        let at = DVec3::new(half - sample.y, 0.0, sample.x) * um_per_pixel;
        match stage.specimen.look(at - far * dir, dir) {
            Some(seen) => stage.shade(&seen, sample),
            None => BACKGROUND,
        }
    })?;
    Some(Drawn {
        canvas,
        um_per_pixel,
    })
}

struct Stage<'a> {
    specimen: Specimen<'a>,
    absorption: [f64; 3],
    lamp: DVec3,
}

impl Stage<'_> {
    fn shade(&self, seen: &Seen, sample: &mut Sample) -> DVec3 {
        let (u, v) = concentric_disk(sample.rng.uniform(), sample.rng.uniform());
        let (a, b) = self.lamp.any_orthonormal_pair();
        let lamp = (self.lamp + LAMP_SIZE * (u * a + v * b)).normalize();
        let cosine = seen.normal.dot(lamp).max(0.0);
        let lit = cosine > 0.0 && self.specimen.look_on(seen, lamp).is_none();
        let [u, v] = sample.pair;
        let open = self.specimen.is_open(seen, u, v);
        let share = |yes: bool| f64::from(u8::from(yes));
        let light = 0.08 + 0.62 * cosine * share(lit) + 0.42 * share(open);
        self.color(seen) * light
    }

    fn color(&self, seen: &Seen) -> DVec3 {
        let fiber = self.specimen.fiber;
        match seen.what {
            What::Face | What::Riser => pigment::keratin(self.absorption, SKIN_DEEP_UM),
            What::VoidWall => VOID_WALL,
            What::Cut(Region::Medulla) => {
                let density = fiber.medium(Region::Medulla).pigment;
                MEDIUM * pigment::keratin(self.absorption, SLICE_UM * density)
            }
            What::Cut(Region::Cuticle) => pigment::keratin(self.absorption, 0.0),
            What::Cut(_) => {
                let density = fiber.pigment_at(seen.point, Region::Cortex);
                pigment::keratin(self.absorption, SLICE_UM * density)
            }
        }
    }
}
