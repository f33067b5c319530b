//! How a strand scatters light: baked tables behind one closed enum.
//!
//! Everything is in the strand frame of [`crate::math::frame::strand_frame`]: +Z is the tangent,
//! `wo` (toward the camera) lies in the half plane y = 0, x >= 0. `density` is the scattering
//! function times the cosine of the light's inclination, `S(wi, wo) cos(theta_i)`, per steradian:
//! what multiplies incoming radiance in the path integral. No other cosine appears.

use crate::color::Rgb;
use glam::Vec3;

/// A direction drawn from a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction to the light, strand frame.
    pub wi: Vec3,
    /// `density / pdf`.
    pub weight: Rgb,
    /// Probability density of `wi` per steradian over the whole sphere, > 0.
    pub pdf: f32,
}

/// A scattering model at one point of a strand.
#[derive(Clone, Debug)]
pub enum Bsdf<'a> {
    /// Scatters evenly over the sphere with the given albedo: `density = albedo / 4 pi`. Closed
    /// form, for tests of the renderer.
    Isotropic(Rgb),
    /// A weighted blend of up to four baked tables (two stations x two pigment zones); the weights
    /// sum to 1.
    Tables([Option<(&'a (), f32)>; 4]),
}

impl Bsdf<'_> {
    /// `S(wi, wo) cos(theta_i)` per steradian.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let _ = (wo, wi);
        match self {
            Self::Isotropic(albedo) => *albedo / (4.0 * std::f32::consts::PI),
            Self::Tables(_) => Rgb::ZERO,
        }
    }

    /// Density per steradian with which [`Bsdf::sample`] draws `wi`.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let _ = (wo, wi);
        1.0 / (4.0 * std::f32::consts::PI)
    }

    /// Draws a direction from three numbers in `[0, 1)`: the first two place the direction (they may
    /// come from a low-discrepancy net), the third chooses node and table. `None` where the albedo
    /// is zero.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample> {
        let _ = wo;
        let z = 1.0 - 2.0 * u[0];
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (std::f32::consts::TAU * u[1]).sin_cos();
        let wi = Vec3::new(r * cos, r * sin, z);
        let pdf = 1.0 / (4.0 * std::f32::consts::PI);
        Some(BsdfSample {
            wi,
            weight: self.density(wo, wi) / pdf,
            pdf,
        })
    }

    /// Share of light leaving along `wo` under even illumination: the integral of `density` over
    /// `wi`, for a direction of sine-of-inclination `wo.z`.
    pub fn albedo(&self, wo: Vec3) -> Rgb {
        let _ = wo;
        match self {
            Self::Isotropic(albedo) => *albedo,
            Self::Tables(_) => Rgb::ZERO,
        }
    }
}

/// The scattering of one hair class along its strands.
#[derive(Clone, Debug)]
pub enum HairMaterial {
    /// The same closed-form scattering everywhere.
    Isotropic(Rgb),
}

impl HairMaterial {
    /// The model at a point of a strand.
    ///
    /// * `at`: position along the strand, 0 root .. 1 tip.
    /// * `tip_mm`: distance from the tip along the strand, millimeters.
    pub fn at(&self, at: f32, tip_mm: f32) -> Bsdf<'_> {
        let _ = (at, tip_mm);
        match self {
            Self::Isotropic(albedo) => Bsdf::Isotropic(*albedo),
        }
    }
}
