//! The floor under the subject.

use super::{Environment, Ray};
use crate::color::Rgb;
use glam::Vec3;

/// A level floor under the subject. The camera sees the backdrop on it, darkened where the subject
/// takes light away, so that floor and backdrop join without a seam; other rays see matte paint.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Reflectance toward the subject, 0..1.
    pub reflectance: f32,
    pub(super) height: f32,
    /// Middle of the subject, and the distance from it where the floor begins to be plain backdrop.
    pub(super) center: Vec3,
    pub(super) reach: f32,
    /// Radiance of white paint on the floor if there were no subject.
    pub(super) open: Rgb,
    /// The environment times cosine, to draw directions from.
    pub(super) light: Environment,
}

impl Ground {
    /// Draws a direction by the product of environment and cosine; gives it and the radiance that
    /// white paint sends on by it, nearly the same ([`Ground::open`]) for all. `None` in the dark.
    ///
    /// * `environment`: the one the scene was built with.
    pub fn sample(&self, environment: &Environment, u: [f32; 2]) -> Option<(Vec3, Rgb)> {
        let sample = self.light.sample(u)?;
        let cos = sample.dir.y.max(0.0) * std::f32::consts::FRAC_1_PI;
        Some((
            sample.dir,
            environment.eval(sample.dir).0 * (cos / sample.pdf),
        ))
    }

    /// Radiance of white paint that sees the whole upper half of the environment, and no lamps.
    pub fn open(&self) -> Rgb {
        self.open
    }

    /// How much of the subject's shadow is shown at a point of the floor: 1 near, 0 far away, where
    /// it is below a hundredth and only its noise would be seen.
    pub fn shadow_share(&self, point: Vec3) -> f32 {
        let t = (point.distance(self.center) / self.reach - 1.0).clamp(0.0, 1.0);
        1.0 - t * t * (3.0 - 2.0 * t)
    }

    pub(super) fn hit(&self, ray: &Ray, limit: f32) -> Option<f32> {
        let t = (self.height - ray.origin.y) / ray.dir.y;
        (ray.dir.y < 0.0 && ray.origin.y > self.height && t < limit).then_some(t)
    }
}
