//! What a ray has met, as something that scatters: one face for strands and matte surfaces.

use crate::bsdf::{Bsdf, Place};
use crate::color::Rgb;
use crate::math::frame::strand_frame;
use crate::sampling::concentric_disk;
use crate::scene::{Departure, Hit, Leaving, Ray, Scene};
use glam::{Mat3, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// A scattering point.
pub(super) struct Scatter<'a> {
    position: Vec3,
    kind: Kind<'a>,
}

enum Kind<'a> {
    Strand {
        bsdf: Bsdf<'a>,
        /// Strand frame to world.
        frame: Mat3,
        departure: Departure,
    },
    Matte {
        color: Rgb,
        /// Columns: two tangents and the shading normal.
        frame: Mat3,
        /// Geometric normal toward the viewer.
        facing: Vec3,
    },
}

/// A direction drawn from a scattering point.
#[derive(Clone, Copy)]
pub(super) struct Direction {
    /// Unit, world.
    pub(super) dir: Vec3,
    /// Density over pdf.
    pub(super) weight: Rgb,
    /// Per steradian, > 0.
    pub(super) pdf: f32,
}

impl<'a> Scatter<'a> {
    /// * `first`: whether the ray comes from the camera.
    /// * `u`: a number in `[0, 1)` that chooses where materials blend.
    pub(super) fn new(scene: &'a Scene, ray: &Ray, hit: &Hit, first: bool, u: f32) -> Self {
        let (t, kind) = match hit {
            Hit::Strand(hit) => {
                let frame = strand_frame(hit.tangent, -ray.dir);
                let wo = frame.transpose() * -ray.dir;
                // Exactly in the half plane y = 0 that models expect.
                let wo = Vec3::new(wo.x, 0.0, wo.z);
                let azimuth = || azimuth_of(frame.x_axis, hit.side, hit.tangent);
                let material = &scene.materials[hit.class as usize];
                let place = Place {
                    across: if material.is_near_field() {
                        hit.across(ray)
                    } else {
                        0.0
                    },
                    at: hit.at,
                    tip_mm: hit.tip_mm,
                    part: usize::from(hit.coat),
                };
                let kind = Kind::Strand {
                    bsdf: material.at(place, wo, azimuth, u),
                    frame,
                    departure: hit.departure(),
                };
                (hit.t, kind)
            }
            Hit::Surface(hit) => (hit.t, matte(hit.color, hit.normal, hit.facing)),
            Hit::Ground(t) => {
                // The camera compares white paint with and without the subject.
                let paint = scene.ground.as_ref().map_or(0.0, |g| g.reflectance);
                let color = Rgb::splat(if first { 1.0 } else { paint });
                (*t, matte(color, Vec3::Y, Vec3::Y))
            }
        };
        Self {
            position: ray.origin + t * ray.dir,
            kind,
        }
    }

    /// Scattered share per steradian (with any cosine) and the density of [`Scatter::sample`].
    pub(super) fn eval(&self, dir: Vec3) -> (Rgb, f32) {
        match &self.kind {
            Kind::Strand { bsdf, frame, .. } => {
                let wi = frame.transpose() * dir;
                bsdf.density_and_pdf(wi)
            }
            Kind::Matte {
                color,
                frame,
                facing,
            } => {
                let cos = frame.z_axis.dot(dir).max(0.0) * FRAC_1_PI;
                let seen = if facing.dot(dir) > 0.0 { cos } else { 0.0 };
                (*color * seen, cos)
            }
        }
    }

    /// Draws a direction from three numbers in `[0, 1)`; `None` where nothing is scattered.
    pub(super) fn sample(&self, u: [f32; 3]) -> Option<Direction> {
        match &self.kind {
            Kind::Strand { bsdf, frame, .. } => {
                let sample = bsdf.sample(u)?;
                Some(Direction {
                    dir: (*frame * sample.wi).normalize(),
                    weight: sample.weight,
                    pdf: sample.pdf,
                })
            }
            Kind::Matte {
                color,
                frame,
                facing,
            } => {
                let (x, y) = concentric_disk(f64::from(u[0]), f64::from(u[1]));
                let (x, y) = (x as f32, y as f32);
                let z = (1.0 - x * x - y * y).max(0.0).sqrt();
                let dir = *frame * Vec3::new(x, y, z);
                (z > 0.0 && facing.dot(dir) > 0.0).then_some(Direction {
                    dir,
                    weight: *color,
                    pdf: z / PI,
                })
            }
        }
    }

    /// Whether [`Self::sample`] costs much more than [`Self::eval`].
    pub(super) fn is_dear_to_draw(&self) -> bool {
        match &self.kind {
            Kind::Strand { bsdf, .. } => bsdf.is_dear_to_draw(),
            Kind::Matte { .. } => false,
        }
    }

    /// A ray from here, and the strand it has to leave.
    pub(super) fn leave(&self, dir: Vec3) -> (Ray, Option<Leaving>) {
        match &self.kind {
            Kind::Strand { departure, .. } => {
                let ray = Ray {
                    origin: self.position,
                    dir,
                };
                (ray, Some(departure.along(dir)))
            }
            Kind::Matte { facing, .. } => {
                // A few rounding steps of the position, at least a fifth of a micrometer.
                let reach = self.position.abs().max_element();
                let lift = (16.0 * f32::EPSILON * reach).max(2e-4);
                let origin = self.position + lift * *facing;
                (Ray { origin, dir }, None)
            }
        }
    }

    /// Where it is.
    pub(super) fn position(&self) -> Vec3 {
        self.position
    }

    /// Share of even light that is scattered toward the viewer.
    pub(super) fn albedo(&self) -> Rgb {
        match &self.kind {
            Kind::Strand { bsdf, .. } => bsdf.albedo(),
            Kind::Matte { color, .. } => *color,
        }
    }

    /// Direction across the strand toward the viewer, or the shading normal.
    pub(super) fn normal(&self) -> Vec3 {
        match &self.kind {
            Kind::Strand { frame, .. } => frame.x_axis,
            Kind::Matte { frame, .. } => frame.z_axis,
        }
    }
}

/// Azimuth of a direction around a tangent, radians from `side`; 0 where there is no side.
fn azimuth_of(dir: Vec3, side: Vec3, tangent: Vec3) -> f32 {
    if side == Vec3::ZERO {
        return 0.0;
    }
    dir.dot(tangent.cross(side)).atan2(dir.dot(side))
}

fn matte(color: Rgb, normal: Vec3, facing: Vec3) -> Kind<'static> {
    let (x, y) = normal.any_orthonormal_pair();
    Kind::Matte {
        color,
        frame: Mat3::from_cols(x, y, normal),
        facing,
    }
}
