//! How a strand scatters light: baked tables and models in closed form behind one closed enum.
//!
//! Everything is in the strand frame of [`crate::math::frame::strand_frame`]: +Z is the tangent,
//! `wo` (toward the camera) lies in the half plane y = 0, x >= 0. `density` is the scattering
//! function times the cosine of the light's inclination, `S(wi, wo) cos(theta_i)`, per steradian:
//! what multiplies incoming radiance in the path integral. No other cosine appears.

mod chiang;
mod double_cylinder;
mod lobes;
mod material;

pub use chiang::{Chiang, ChiangLobe, ChiangParameters};
pub use double_cylinder::{DoubleCylinder, DoubleCylinderLobe, DoubleCylinderParameters};
pub(crate) use material::bracket_zone;
pub use material::{AlongStrand, CoatPart, HairMaterial, Place, TableSet, Zone};

use crate::color::Rgb;
use crate::table::Lobe;
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

impl BsdfSample {
    /// `None` where nothing can be drawn.
    fn new(wi: Vec3, density: Rgb, pdf: f32) -> Option<Self> {
        (pdf > 0.0 && pdf.is_finite()).then(|| Self {
            wi,
            weight: density / pdf,
            pdf,
        })
    }
}

/// Scattering at one point of a strand toward one direction `wo`.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'a> {
    /// Scatters evenly over the sphere with the given albedo: `density = albedo / 4 pi`. Closed
    /// form, for tests of the renderer.
    Isotropic(Rgb),
    /// A baked table.
    Table(Lobe<'a>),
    /// The model of Chiang et al. 2016.
    Chiang(ChiangLobe<'a>),
    /// A double cylinder after Yan et al. 2015.
    DoubleCylinder(DoubleCylinderLobe<'a>),
}

impl Bsdf<'_> {
    /// `S(wi, wo) cos(theta_i)` per steradian.
    pub fn density(&self, wi: Vec3) -> Rgb {
        match self {
            Self::Isotropic(albedo) => *albedo / (4.0 * PI),
            Self::Table(lobe) => lobe.density(wi),
            Self::Chiang(lobe) => lobe.density_and_pdf(wi).0,
            Self::DoubleCylinder(lobe) => lobe.density_and_pdf(wi).0,
        }
    }

    /// Density per steradian with which [`Bsdf::sample`] draws `wi`.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        match self {
            Self::Isotropic(_) => 1.0 / (4.0 * PI),
            Self::Table(lobe) => self.table_pdf(lobe, lobe.density(wi)),
            Self::Chiang(lobe) => lobe.density_and_pdf(wi).1,
            Self::DoubleCylinder(lobe) => lobe.density_and_pdf(wi).1,
        }
    }

    /// [`Bsdf::density`] and [`Bsdf::pdf`] for the price of one look-up.
    pub fn density_and_pdf(&self, wi: Vec3) -> (Rgb, f32) {
        match self {
            Self::Isotropic(_) => (self.density(wi), self.pdf(wi)),
            Self::Table(lobe) => {
                let density = lobe.density(wi);
                (density, self.table_pdf(lobe, density))
            }
            Self::Chiang(lobe) => lobe.density_and_pdf(wi),
            Self::DoubleCylinder(lobe) => lobe.density_and_pdf(wi),
        }
    }

    fn table_pdf(&self, lobe: &Lobe<'_>, density: Rgb) -> f32 {
        let albedo = lobe.albedo().element_sum();
        if albedo > 0.0 {
            density.element_sum() / albedo
        } else {
            0.0
        }
    }

    /// Draws a direction from three numbers in `[0, 1)`: the first two place the direction (they may
    /// come from a low-discrepancy net), the third chooses node and face. `None` where the albedo is
    /// zero.
    pub fn sample(&self, u: [f32; 3]) -> Option<BsdfSample> {
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
            Self::Table(lobe) => {
                let wi = lobe.sample(u)?;
                let (density, pdf) = self.density_and_pdf(wi);
                (pdf > 0.0).then(|| BsdfSample {
                    wi,
                    weight: density / pdf,
                    pdf,
                })
            }
            Self::Chiang(lobe) => lobe.sample(u),
            Self::DoubleCylinder(lobe) => lobe.sample(u),
        }
    }

    /// Whether drawing a direction costs much more than evaluating one: a table is searched for it.
    pub fn is_dear_to_draw(&self) -> bool {
        matches!(self, Self::Table(_))
    }

    /// Share of light leaving along `wo` under even illumination: the integral of `density` over
    /// `wi`.
    pub fn albedo(&self) -> Rgb {
        match self {
            Self::Isotropic(albedo) => *albedo,
            Self::Table(lobe) => lobe.albedo(),
            Self::Chiang(lobe) => lobe.albedo(),
            Self::DoubleCylinder(lobe) => lobe.albedo(),
        }
    }
}
