//! How a strand scatters light: baked tables behind one closed enum.
//!
//! Everything is in the strand frame of [`crate::math::frame::strand_frame`]: +Z is the tangent,
//! `wo` (toward the camera) lies in the half plane y = 0, x >= 0. `density` is the scattering
//! function times the cosine of the light's inclination, `S(wi, wo) cos(theta_i)`, per steradian:
//! what multiplies incoming radiance in the path integral. No other cosine appears.

mod material;

pub use material::{HairMaterial, TableSet, Zone};

use crate::color::Rgb;
use crate::table::ScatterTable;
use glam::Vec3;
use std::f32::consts::PI;

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
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'a> {
    /// Scatters evenly over the sphere with the given albedo: `density = albedo / 4 pi`. Closed
    /// form, for tests of the renderer.
    Isotropic(Rgb),
    /// Baked tables.
    Tables(Blend<'a>),
}

/// A weighted blend of up to four tables (two stations x two pigment zones); the weights sum to 1.
/// Unused places have weight 0.
#[derive(Clone, Copy, Debug)]
pub struct Blend<'a>([(&'a ScatterTable, f32); 4]);

impl Blend<'_> {
    fn used(&self) -> impl Iterator<Item = (&ScatterTable, f32)> {
        self.0
            .iter()
            .filter(|(_, weight)| *weight > 0.0)
            .map(|&(table, weight)| (table, weight))
    }
}

impl Bsdf<'_> {
    /// `S(wi, wo) cos(theta_i)` per steradian.
    pub fn density(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match self {
            Self::Isotropic(albedo) => *albedo / (4.0 * PI),
            Self::Tables(blend) => blend.used().map(|(t, w)| t.density(wo, wi) * w).sum(),
        }
    }

    /// Density per steradian with which [`Bsdf::sample`] draws `wi`.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Isotropic(_) => 1.0 / (4.0 * PI),
            Self::Tables(_) => {
                let albedo = self.albedo(wo).element_sum();
                if albedo > 0.0 {
                    self.density(wo, wi).element_sum() / albedo
                } else {
                    0.0
                }
            }
        }
    }

    /// Draws a direction from three numbers in `[0, 1)`: the first two place the direction (they may
    /// come from a low-discrepancy net), the third chooses table, node and face. `None` where the
    /// albedo is zero.
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample> {
        match self {
            Self::Isotropic(albedo) => {
                let z = 1.0 - 2.0 * u[0];
                let r = (1.0 - z * z).max(0.0).sqrt();
                let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
                let wi = Vec3::new(r * cos, r * sin, z);
                Some(BsdfSample {
                    wi,
                    weight: *albedo,
                    pdf: 1.0 / (4.0 * PI),
                })
            }
            Self::Tables(blend) => {
                let share = |t: &ScatterTable, w: f32| w * t.albedo(wo).element_sum();
                let total: f32 = blend.used().map(|(t, w)| share(t, w)).sum();
                let mut rest = u[2] * total;
                let mut chosen = None;
                for (table, weight) in blend.used() {
                    let share = share(table, weight);
                    if share > 0.0 {
                        chosen = Some((table, (rest / share).min(1.0 - f32::EPSILON)));
                        if rest < share {
                            break;
                        }
                    }
                    rest -= share;
                }
                let (table, pick) = chosen?;
                let wi = table.sample(wo, [u[0], u[1], pick])?;
                let density = self.density(wo, wi);
                let pdf = density.element_sum() / total;
                (pdf > 0.0).then(|| BsdfSample {
                    wi,
                    weight: density / pdf,
                    pdf,
                })
            }
        }
    }

    /// Share of light leaving along `wo` under even illumination: the integral of `density` over
    /// `wi`.
    pub fn albedo(&self, wo: Vec3) -> Rgb {
        match self {
            Self::Isotropic(albedo) => *albedo,
            Self::Tables(blend) => blend.used().map(|(t, w)| t.albedo(wo) * w).sum(),
        }
    }
}
