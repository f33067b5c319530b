//! The hair model of Chiang, Bitterli, Tappan and Burley 2016, "A practical and controllable hair and
//! fur model for production path tracing": what pbrt, Mitsuba and Cycles call (principled) hair.
//!
//! Four lobes: R, TT, TRT, and all light of more reflections inside. Each is its energy times a
//! longitudinal lobe of d'Eon et al. 2011 times a logistic in azimuth, even for the last. It is a
//! near-field model: it knows where across the strand it was met.

use super::BsdfSample;
use super::lobes::{
    Entry, Logistic, Longitudinal, logistic_scale, longitudinal, near_zero, variance,
};
use crate::color::Rgb;
use crate::math::quick::{exp, sin_cos_of_turns, turns};
use crate::math::{crossings, fresnel};
use glam::{Vec3, Vec4};
use std::f32::consts::TAU;

/// Lobes: R, TT, TRT, the rest.
const LOBES: usize = 4;

/// The numbers of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiangParameters {
    /// Absorption per radius of the strand, linear Rec.709, >= 0.
    pub sigma_a: Rgb,
    /// Longitudinal roughness, 0..1.
    pub beta_m: f32,
    /// Azimuthal roughness, 0..1.
    pub beta_n: f32,
    /// Tilt of the scales, degrees: above 0 it sends R toward the root, TT and TRT toward the tip.
    pub alpha_deg: f32,
    /// Refractive index, > 1.
    pub eta: f32,
}

impl Default for ChiangParameters {
    fn default() -> Self {
        Self {
            sigma_a: Rgb::new(0.06, 0.10, 0.20),
            beta_m: 0.3,
            beta_n: 0.3,
            alpha_deg: 2.0,
            eta: 1.55,
        }
    }
}

/// The model with all that does not depend on directions worked out.
#[derive(Clone, Copy, Debug)]
pub struct Chiang {
    sigma_a: Rgb,
    eta: f32,
    lobes: [Longitudinal; LOBES],
    /// Of each lobe `1 / v`.
    sharpness: Vec4,
    /// Of each lobe `1 / (v (1 - exp(-2 / v)))`.
    norm: Vec4,
    azimuthal: Logistic,
}

impl Chiang {
    /// Works out what the directions do not change. Roughness below 0.02 is taken as 0.02.
    pub fn new(p: &ChiangParameters) -> Self {
        let variance = variance(p.beta_m);
        let alpha = p.alpha_deg.to_radians();
        let lobes = [
            Longitudinal::new(variance, 2.0 * alpha),
            Longitudinal::new(0.25 * variance, -alpha),
            Longitudinal::new(4.0 * variance, -4.0 * alpha),
            Longitudinal::new(4.0 * variance, 0.0),
        ];
        Self {
            sigma_a: p.sigma_a,
            eta: p.eta,
            sharpness: lobes.map(|lobe| 1.0 / lobe.variance).into(),
            norm: lobes.map(|lobe| lobe.norm()).into(),
            lobes,
            azimuthal: Logistic::new(logistic_scale(p.beta_n)),
        }
    }

    /// The model as seen from one direction.
    ///
    /// * `wo`: unit direction to the viewer in the strand frame, y = 0 and x >= 0.
    /// * `h`: where across the strand the line of sight meets it, -1..1 in radii, positive toward +Y.
    pub fn lobe_at(&self, wo: Vec3, h: f32) -> ChiangLobe<'_> {
        let entry = Entry::new(wo, h, self.eta);
        let (f, _) = fresnel::dielectric(f64::from(entry.cosine), f64::from(self.eta));
        let crossing = exp((-self.sigma_a * entry.crossing).extend(0.0)).truncate();
        self.lobe_of(&entry, crossings::straight(Rgb::splat(f as f32), crossing))
    }

    /// The same lobes with other energies.
    #[inline(always)]
    pub(super) fn lobe_of(&self, entry: &Entry, energy: [Rgb; LOBES]) -> ChiangLobe<'_> {
        let sums = Vec4::from(energy.map(|e| e.element_sum()));
        let tilted = self.lobes.map(|lobe| lobe.tilted(entry.sin, entry.cos));
        ChiangLobe {
            model: self,
            energy,
            share: sums / sums.element_sum(),
            tilted: [0, 1].map(|i| tilted.map(|query| query[i]).into()),
            exit: entry.exit,
        }
    }
}

/// The model at one point of a strand toward one direction.
#[derive(Clone, Copy, Debug)]
pub struct ChiangLobe<'a> {
    model: &'a Chiang,
    energy: [Rgb; LOBES],
    /// Probabilities of the lobes.
    share: Vec4,
    /// Sine and cosine of the query's inclination for each lobe.
    tilted: [Vec4; 2],
    /// Azimuths about which R, TT and TRT leave, at most half a turn either way.
    exit: Vec4,
}

impl ChiangLobe<'_> {
    /// `S(wi, wo) cos(theta_i)` per steradian and the density of [`Self::sample`].
    pub fn density_and_pdf(&self, wi: Vec3) -> (Rgb, f32) {
        let sin = wi.z.clamp(-1.0, 1.0);
        let cos = (1.0 - sin * sin).sqrt();
        self.toward(sin, cos, TAU * turns(wi.y, wi.x))
    }

    /// * `sin`, `cos`: of the inclination. * `azimuth`: at most half a turn either way.
    #[inline(always)]
    pub(super) fn toward(&self, sin: f32, cos: f32, azimuth: f32) -> (Rgb, f32) {
        let Chiang {
            sharpness,
            norm,
            azimuthal,
            ..
        } = self.model;
        let [sin_q, cos_q] = self.tilted;
        let product = cos * cos_q;
        let along = longitudinal(*sharpness, *norm, product, product - sin * sin_q - 1.0);
        let mut around = azimuthal.density(azimuth - self.exit);
        around.w = 1.0 / TAU;
        let all = along * around;
        let [r, tt, trt, rest] = self.energy;
        let density = r * all.x + tt * all.y + (trt * all.z + rest * all.w);
        (density, all.dot(self.share))
    }

    /// Draws a direction from three numbers in `[0, 1)`.
    pub fn sample(&self, u: [f32; 3]) -> Option<BsdfSample> {
        let (sin, azimuth) = self.draw(u);
        let cos = (1.0 - sin * sin).sqrt();
        let (s, c) = sin_cos_of_turns(azimuth * (1.0 / TAU));
        let (density, pdf) = self.toward(sin, cos, azimuth);
        BsdfSample::new(Vec3::new(cos * c, cos * s, sin), density, pdf)
    }

    /// Sine of the inclination and azimuth, at most half a turn either way, of a direction drawn.
    #[inline(always)]
    pub(super) fn draw(&self, [around, along, mut choice]: [f32; 3]) -> (f32, f32) {
        let mut lobe = 0;
        while lobe < LOBES - 1 && choice >= self.share[lobe] {
            choice -= self.share[lobe];
            lobe += 1;
        }
        // What is left of the choice is as good as new.
        let rest = (choice / self.share[lobe]).clamp(0.0, 1.0);
        let query = self.tilted.map(|all| all[lobe]);
        // 1 - u, never 0, for a logarithm.
        let sin = self.model.lobes[lobe].sample(query, 1.0 - along, rest);
        let azimuth = match lobe {
            3 => near_zero(TAU * around),
            _ => near_zero(self.exit[lobe] + self.model.azimuthal.sample(around)),
        };
        (sin, azimuth)
    }

    /// Energies of R, TT, TRT and the rest.
    #[cfg(test)]
    pub(super) fn energies(&self) -> [Rgb; LOBES] {
        self.energy
    }

    /// The same with other energies, drawn from as before.
    #[cfg(test)]
    pub(super) fn with_energies(&self, energy: [Rgb; LOBES]) -> Self {
        Self { energy, ..*self }
    }

    /// Share of even light that is sent toward the viewer: all lobes are normalized.
    pub fn albedo(&self) -> Rgb {
        self.energy.iter().sum()
    }
}

#[cfg(test)]
#[path = "chiang_tests.rs"]
mod tests;
