//! A double cylinder after Yan, Tseng, Jensen and Ramamoorthi 2015, "Physically-accurate fur reflectance", and
//! 2017: a cuticle of layers, a cortex with pigment, and a medulla that scatters.
//!
//! Six lobes. R, TT, TRT and the rest are those of [`Chiang`] with other energies: layers reflect more, and
//! crossings of the medulla take light off the straight path. That light leaves as two lobes, TTs about
//! straight through and TRTs about straight back, each a longitudinal lobe of d'Eon et al. 2011 of its own
//! width times a wrapped Cauchy in azimuth. The authors have tabulated profiles of simulated scattering in
//! their place. It is a near-field model, whose mean over the width is the far-field one that
//! [`Model::DoubleCylinder`](crate::table::Model) fits to tables.

use super::lobes::{Entry, Longitudinal, WrappedCauchy, longitudinal, near_zero, variance};
use super::{BsdfSample, Chiang, ChiangLobe, ChiangParameters};
use crate::color::Rgb;
use crate::math::quick::{exp, sin_cos_of_turns, turns};
use crate::math::{crossings, fresnel};
use glam::{Vec3, Vec4};
use std::f32::consts::{PI, TAU};

/// The greatest sine whose cosine is not zero.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// The numbers of the model, by the names that `vair table fit` has for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleCylinderParameters {
    /// Absorption of the cortex per radius of the strand, linear Rec.709, >= 0. The medulla absorbs nothing.
    pub sigma_a: Rgb,
    /// Longitudinal roughness of R, TT, TRT and the rest, 0..1.
    pub beta_m: f32,
    /// Azimuthal roughness of R, TT and TRT, 0..1.
    pub beta_n: f32,
    /// Tilt of the scales, degrees: above 0 it sends R toward the root, TT and TRT toward the tip.
    pub alpha_deg: f32,
    /// Refractive index of cuticle and cortex, > 1.
    pub eta: f32,
    /// Layers of the cuticle, > 0, fractions allowed; half a layer reflects as one surface does.
    pub layers: f32,
    /// Radius of the medulla over that of the strand, 0..1.
    pub kappa: f32,
    /// Scattering of the medulla per radius of the strand, >= 0.
    pub sigma_m_s: f32,
    /// Path of the scattered light in the cortex, radii of the strand, >= 0.
    pub path_s: f32,
    /// Longitudinal roughness of the light scattered on, TTs, 0..1.
    pub beta_m_s: f32,
    /// Mean cosine of its azimuth about straight through, 0..0.99: 0 is even.
    pub rho_s: f32,
    /// Share of the scattered light that goes back, TRTs, 0..1.
    pub back_s: f32,
    /// Longitudinal roughness of the light scattered back, 0..1.
    pub beta_m_b: f32,
    /// Mean cosine of its azimuth about straight back, 0..0.99: 0 is even.
    pub rho_b: f32,
}

impl Default for DoubleCylinderParameters {
    fn default() -> Self {
        let ChiangParameters {
            sigma_a,
            beta_m,
            beta_n,
            alpha_deg,
            eta,
        } = ChiangParameters::default();
        Self {
            sigma_a,
            beta_m,
            beta_n,
            alpha_deg,
            eta,
            layers: 0.5,
            kappa: 0.7,
            sigma_m_s: 2.0,
            path_s: 2.0,
            beta_m_s: 0.6,
            rho_s: 0.3,
            back_s: 0.5,
            beta_m_b: 0.6,
            rho_b: 0.3,
        }
    }
}

/// The model with all that does not depend on directions worked out.
#[derive(Clone, Copy, Debug)]
pub struct DoubleCylinder {
    straight: Chiang,
    sigma_a: Rgb,
    eta: f64,
    layers: f64,
    kappa: f32,
    sigma_m_s: f32,
    /// What the cortex leaves of scattered light.
    left: Rgb,
    scattered: Scattered,
}

/// Lobes of scattered light, TTs before TRTs.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    along: [Longitudinal; 2],
    /// Of the longitudinal lobes `1 / v` and their norm; half of the lanes are idle.
    sharpness: Vec4,
    norm: Vec4,
    around: [WrappedCauchy; 2],
    /// Of all scattered light.
    share: [f32; 2],
}

impl DoubleCylinder {
    /// Works out what the directions do not change. Roughness below 0.02 is taken as 0.02.
    pub fn new(p: &DoubleCylinderParameters) -> Self {
        let straight = Chiang::new(&ChiangParameters {
            sigma_a: p.sigma_a,
            beta_m: p.beta_m,
            beta_n: p.beta_n,
            alpha_deg: p.alpha_deg,
            eta: p.eta,
        });
        let along = [p.beta_m_s, p.beta_m_b].map(|beta| Longitudinal::new(variance(beta), 0.0));
        let lanes = |of: fn(&Longitudinal) -> f32| {
            let [s, b] = along.each_ref().map(of);
            Vec4::new(s, b, s, b)
        };
        let back = p.back_s.clamp(0.0, 1.0);
        Self {
            straight,
            sigma_a: p.sigma_a,
            eta: f64::from(p.eta),
            layers: f64::from(p.layers),
            kappa: p.kappa,
            sigma_m_s: p.sigma_m_s,
            left: exp((-p.sigma_a * p.path_s).extend(0.0)).truncate(),
            scattered: Scattered {
                along,
                sharpness: lanes(|lobe| 1.0 / lobe.variance),
                norm: lanes(Longitudinal::norm),
                around: [p.rho_s, p.rho_b].map(WrappedCauchy::new),
                share: [1.0 - back, back],
            },
        }
    }

    /// The model as seen from one direction.
    ///
    /// * `wo`: unit direction to the viewer in the strand frame, y = 0 and x >= 0.
    /// * `h`: where across the strand the line of sight meets it, -1..1 in radii, positive toward +Y.
    pub fn lobe_at(&self, wo: Vec3, h: f32) -> DoubleCylinderLobe<'_> {
        let entry = Entry::new(wo, h, self.eta as f32);
        let (f, _) = fresnel::layered(f64::from(entry.cosine), self.eta, self.layers);
        let f = Rgb::splat(f as f32);
        let inside = self.kappa * self.kappa - entry.sin_gamma_t * entry.sin_gamma_t;
        let in_medulla = 2.0 * inside.max(0.0).sqrt() / entry.cos_theta_t;
        // Absorption of a crossing, a channel a lane, and what scattering alone takes in the last.
        let absorption = (self.sigma_a * (entry.crossing - in_medulla)).extend(0.0);
        let left = exp(-absorption - Vec4::splat(self.sigma_m_s * in_medulla));
        let t = left.truncate();
        let scattered = crossings::scattered(f, t, Rgb::splat(1.0 - left.w)) * self.left;
        let straight = (self.straight).lobe_of(&entry, crossings::straight(f, t));
        let all = straight.albedo().element_sum();
        DoubleCylinderLobe {
            scattering: &self.scattered,
            straight,
            scattered,
            share: all / (all + scattered.element_sum()),
            query: [entry.sin, entry.cos],
        }
    }
}

/// The model at one point of a strand toward one direction.
#[derive(Clone, Copy, Debug)]
pub struct DoubleCylinderLobe<'a> {
    scattering: &'a Scattered,
    straight: ChiangLobe<'a>,
    /// Energy of TTs and TRTs together.
    scattered: Rgb,
    /// Probability of the lobes that are not scattered.
    share: f32,
    /// Sine and cosine of the viewer's inclination.
    query: [f32; 2],
}

impl DoubleCylinderLobe<'_> {
    /// `S(wi, wo) cos(theta_i)` per steradian and the density of [`Self::sample`].
    pub fn density_and_pdf(&self, wi: Vec3) -> (Rgb, f32) {
        let sin = wi.z.clamp(-1.0, 1.0);
        let cos = (1.0 - sin * sin).sqrt();
        let level = (wi.x * wi.x + wi.y * wi.y).sqrt().max(f32::MIN_POSITIVE);
        self.toward(sin, cos, TAU * turns(wi.y, wi.x), wi.x / level)
    }

    /// * `sin`, `cos`: of the inclination. * `azimuth`: at most half a turn either way. * `cos_azimuth`: its
    ///   cosine, 1 straight back.
    #[inline(always)]
    fn toward(&self, sin: f32, cos: f32, azimuth: f32, cos_azimuth: f32) -> (Rgb, f32) {
        let (density, pdf) = self.straight.toward(sin, cos, azimuth);
        let Scattered {
            sharpness,
            norm,
            around: [on, back],
            share,
            ..
        } = self.scattering;
        let [sin_q, cos_q] = self.query;
        let product = cos * cos_q;
        let off = product - sin * sin_q - 1.0;
        let along = longitudinal(*sharpness, *norm, Vec4::splat(product), Vec4::splat(off));
        let scattered = share[0] * along.x * on.density(-cos_azimuth)
            + share[1] * along.y * back.density(cos_azimuth);
        (
            density + self.scattered * scattered,
            self.share * pdf + (1.0 - self.share) * scattered,
        )
    }

    /// Draws a direction from three numbers in `[0, 1)`.
    pub fn sample(&self, [around, along, choice]: [f32; 3]) -> Option<BsdfSample> {
        let (sin, azimuth) = if choice < self.share {
            self.straight.draw([around, along, choice / self.share])
        } else {
            self.draw_scattered([around, along, (choice - self.share) / (1.0 - self.share)])
        };
        // At the very pole a direction would forget its azimuth.
        let sin = sin.clamp(-BELOW_ONE, BELOW_ONE);
        let cos = (1.0 - sin * sin).sqrt();
        let (s, c) = sin_cos_of_turns(azimuth * (1.0 / TAU));
        let (density, pdf) = self.toward(sin, cos, azimuth, c);
        BsdfSample::new(Vec3::new(cos * c, cos * s, sin), density, pdf)
    }

    /// Sine of the inclination and azimuth of a direction drawn from TTs and TRTs.
    fn draw_scattered(&self, [around, along, choice]: [f32; 3]) -> (f32, f32) {
        let [on, back] = self.scattering.share;
        let (lobe, center, rest) = if choice < on {
            (0, PI, choice / on)
        } else {
            (1, 0.0, (choice - on) / back)
        };
        let sin = self.scattering.along[lobe].sample(self.query, 1.0 - along, rest.min(1.0));
        let off = self.scattering.around[lobe].sample(around);
        (sin, near_zero(center + off))
    }

    /// Share of even light that is sent toward the viewer: all lobes are normalized.
    pub fn albedo(&self) -> Rgb {
        self.straight.albedo() + self.scattered
    }
}

#[cfg(test)]
#[path = "double_cylinder_tests.rs"]
mod tests;
