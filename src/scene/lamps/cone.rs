//! Lamps that look round from everywhere: spheres, and the sun. Seen from a point they are a cone of directions.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Directions within an angle of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    /// Unit.
    axis: DVec3,
    /// Squared sine of half its opening; the cosine would say nothing of a small lamp.
    sin2: f64,
    /// One minus the cosine.
    versine: f64,
}

impl Cone {
    /// * `sin2`: squared sine of half the opening, 0..1, both excluded.
    pub(super) fn new(axis: DVec3, sin2: f64) -> Self {
        Self {
            axis,
            sin2,
            versine: sin2 / (1.0 + (1.0 - sin2).sqrt()),
        }
    }

    /// The direction of its middle.
    pub(super) fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Sine of half its opening.
    pub(super) fn sin(&self) -> f64 {
        self.sin2.sqrt()
    }

    /// Steradians.
    pub(super) fn solid_angle(&self) -> f64 {
        TAU * self.versine
    }

    /// A direction from two numbers in `[0, 1)`, evenly by solid angle.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let versine = self.versine * u[0];
        let sin = (versine * (2.0 - versine)).sqrt();
        let (x, y) = self.axis.any_orthonormal_pair();
        let (s, c) = (TAU * u[1]).sin_cos();
        (self.axis * (1.0 - versine) + (x * c + y * s) * sin).normalize()
    }

    /// Whether a unit direction is in it.
    pub(super) fn holds(&self, dir: DVec3) -> bool {
        // Half the squared chord is one minus the cosine, without loss.
        0.5 * (dir - self.axis).length_squared() < self.versine
    }

    /// Irradiance of radiance 1 on a plane, with what is below its horizon cut off: Snyder 1996, Snyder96 in
    /// REFERENCES.md.
    ///
    /// * `normal`: unit, of the plane.
    pub(super) fn irradiance(&self, normal: DVec3) -> f64 {
        let cos = normal.dot(self.axis).clamp(-1.0, 1.0);
        if cos * cos >= self.sin2 {
            return PI * self.sin2 * cos.max(0.0);
        }
        let sin = (1.0 - cos * cos).sqrt();
        let cot = (1.0 / self.sin2 - 1.0).sqrt();
        let y = (-cot * cos / sin).clamp(-1.0, 1.0);
        let s = sin * (1.0 - y * y).sqrt();
        (cos * y.acos() - cot * s) * self.sin2 + (s / cot).atan()
    }
}
