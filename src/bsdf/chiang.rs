//! The hair model of Chiang, Bitterli, Tappan and Burley 2016, "A practical and controllable hair and
//! fur model for production path tracing": what pbrt, Mitsuba and Cycles call (principled) hair.
//!
//! Four lobes: R, TT, TRT, and all light of more reflections inside. Each is its energy times a
//! longitudinal lobe of d'Eon et al. 2011 times a logistic in azimuth, even for the last. It is a
//! near-field model: it knows where across the strand it was met.

use super::BsdfSample;
use crate::color::Rgb;
use crate::math::quick::{exp, sin_cos_of_turns, turns};
use crate::math::{bessel, fresnel};
use glam::{Vec3, Vec4};
use std::f32::consts::{FRAC_PI_8, PI, TAU};

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

/// Least roughness that is computed with: below it lobes are too narrow for single precision.
const LEAST_ROUGHNESS: f32 = 0.02;

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

/// One longitudinal lobe.
#[derive(Clone, Copy, Debug)]
struct Longitudinal {
    variance: f32,
    /// `exp(-2 / v)`.
    floor: f32,
    /// Sine and cosine of the angle by which scales tilt the query.
    tilt: [f32; 2],
}

impl Longitudinal {
    fn new(variance: f32, tilt: f32) -> Self {
        let floor = (-2.0 / variance).exp();
        Self {
            variance,
            floor,
            tilt: tilt.sin_cos().into(),
        }
    }

    /// Sine and cosine of the query's inclination as the scales tilt it.
    fn tilted(&self, sin: f32, cos: f32) -> [f32; 2] {
        let [s, c] = self.tilt;
        [sin * c + cos * s, (cos * c - sin * s).abs()]
    }

    /// `1 / (v (1 - exp(-2 / v)))`.
    fn norm(&self) -> f32 {
        1.0 / (self.variance * (1.0 - self.floor))
    }

    /// Sine of an inclination drawn by [`longitudinal`].
    fn sample(&self, [sin_q, cos_q]: [f32; 2], u: f32, v: f32) -> f32 {
        let cos = 1.0 + self.variance * (u + (1.0 - u) * self.floor).ln();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        (-cos * sin_q + sin * sin_cos_of_turns(v).1 * cos_q).clamp(-1.0, 1.0)
    }
}

/// Lobes of d'Eon et al. 2011 per unit sine of the light's inclination; each integrates to 1.
///
/// * `product`: of the cosines of both inclinations. * `along`: cosine of the angle between them less 1.
///
/// The exponential of the lobe and that of the Bessel function, neither of which overflows, are one.
#[inline(always)]
fn longitudinal(sharpness: Vec4, norm: Vec4, product: Vec4, along: Vec4) -> Vec4 {
    const NEAR: [f32; 7] = bessel::single(bessel::NEAR);
    const FAR: [f32; 9] = bessel::single(bessel::FAR);
    const EDGE: f32 = bessel::EDGE as f32;
    let horner = |coefficients: &[f32], t: Vec4| {
        let zero = Vec4::ZERO;
        coefficients.iter().rfold(zero, |sum, &c| sum * t + c)
    };
    let x = (product * sharpness).max(Vec4::ZERO);
    let is_near = x.cmplt(Vec4::splat(EDGE));
    let near = x.min(Vec4::splat(EDGE)) * (1.0 / EDGE);
    let far = EDGE / x.max(Vec4::splat(EDGE));
    let root = far.map(f32::sqrt) * EDGE.sqrt().recip();
    let series = Vec4::select(
        is_near,
        horner(&NEAR, near * near),
        horner(&FAR, far) * root,
    );
    let less = Vec4::select(is_near, x, Vec4::ZERO);
    norm * series * exp(along * sharpness - less)
}

/// A logistic distribution trimmed to a full turn.
#[derive(Clone, Copy, Debug)]
struct Logistic {
    scale: f32,
    /// Probability of the untrimmed one below -pi, and between -pi and pi.
    below: f32,
    between: f32,
    /// `1 / scale` and `1 / (scale between)`.
    inverse: f32,
    norm: f32,
}

impl Logistic {
    fn new(scale: f32) -> Self {
        let below = 1.0 / (1.0 + (PI / scale).exp());
        let between = 1.0 - 2.0 * below;
        Self {
            scale,
            below,
            between,
            inverse: 1.0 / scale,
            norm: 1.0 / (scale * between),
        }
    }

    /// Per radian, at angles of less than two half turns either way.
    #[inline(always)]
    fn density(&self, angle: Vec4) -> Vec4 {
        let off = angle.abs();
        let off = off.min(TAU - off);
        let e = exp(-off * self.inverse);
        let sum = 1.0 + e;
        self.norm * e / (sum * sum)
    }

    fn sample(&self, u: f32) -> f32 {
        let p = (self.below + u * self.between).clamp(f32::MIN_POSITIVE, 1.0 - f32::EPSILON);
        (-self.scale * (1.0 / p - 1.0).ln()).clamp(-PI, PI)
    }
}

impl Chiang {
    /// Works out what the directions do not change. Roughness below 0.02 is taken as 0.02.
    pub fn new(p: &ChiangParameters) -> Self {
        let m = p.beta_m.clamp(LEAST_ROUGHNESS, 1.0);
        let n = p.beta_n.clamp(LEAST_ROUGHNESS, 1.0);
        let variance = (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2);
        let scale = FRAC_PI_8.sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22));
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
            azimuthal: Logistic::new(scale),
        }
    }

    /// The model as seen from one direction.
    ///
    /// * `wo`: unit direction to the viewer in the strand frame, y = 0 and x >= 0.
    /// * `h`: where across the strand the line of sight meets it, -1..1 in radii, positive toward +Y.
    pub fn lobe_at(&self, wo: Vec3, h: f32) -> ChiangLobe<'_> {
        let sin = wo.z.clamp(-1.0, 1.0);
        let cos = (1.0 - sin * sin).sqrt().max(1e-4);
        // Positive h sees normals that lean to +Y, about which light turns to positive azimuths.
        let h = -h.clamp(-0.9999, 0.9999);
        let bravais = (self.eta * self.eta - sin * sin).sqrt() / cos;
        let sin_gamma_t = h / bravais;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let sin_t = sin / self.eta;
        let crossing = 2.0 * cos_gamma_t / (1.0 - sin_t * sin_t).sqrt();
        let cos_gamma_i = (1.0 - h * h).sqrt();
        let gamma_i = TAU * turns(h, cos_gamma_i);
        let gamma_t = TAU * turns(sin_gamma_t, cos_gamma_t);
        let energy = energies(
            fresnel(cos * cos_gamma_i, self.eta),
            exp((-self.sigma_a * crossing).extend(0.0)).truncate(),
        );
        let sums = Vec4::from(energy.map(|e| e.element_sum()));
        let tilted = self.lobes.map(|lobe| lobe.tilted(sin, cos));
        let exit = [0.0, 1.0, 2.0].map(|p| near_zero(2.0 * p * gamma_t - 2.0 * gamma_i + p * PI));
        let [r, tt, trt] = exit;
        ChiangLobe {
            model: self,
            energy,
            share: sums / sums.element_sum(),
            tilted: [0, 1].map(|i| tilted.map(|query| query[i]).into()),
            exit: Vec4::new(r, tt, trt, 0.0),
        }
    }
}

/// An angle of at most three half turns either way, less a full turn if there is one.
fn near_zero(angle: f32) -> f32 {
    if angle.abs() > PI {
        angle - TAU.copysign(angle)
    } else {
        angle
    }
}

fn fresnel(cosine: f32, eta: f32) -> f32 {
    fresnel::dielectric(f64::from(cosine), f64::from(eta)).0 as f32
}

/// Energies of the lobes for reflectance `f` at the surface and transmittance `t` of a crossing.
fn energies(f: f32, t: Rgb) -> [Rgb; LOBES] {
    let tt = (1.0 - f) * (1.0 - f) * t;
    let trt = tt * t * f;
    [Rgb::splat(f), tt, trt, trt * t * f / (1.0 - f * t)]
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
    fn toward(&self, sin: f32, cos: f32, azimuth: f32) -> (Rgb, f32) {
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
    pub fn sample(&self, [around, along, mut choice]: [f32; 3]) -> Option<BsdfSample> {
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
        let cos = (1.0 - sin * sin).sqrt();
        let azimuth = match lobe {
            3 => near_zero(TAU * around),
            _ => near_zero(self.exit[lobe] + self.model.azimuthal.sample(around)),
        };
        let (s, c) = sin_cos_of_turns(azimuth * (1.0 / TAU));
        let (density, pdf) = self.toward(sin, cos, azimuth);
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample {
            wi: Vec3::new(cos * c, cos * s, sin),
            weight: density / pdf,
            pdf,
        })
    }

    /// Share of even light that is sent toward the viewer: all lobes are normalized.
    pub fn albedo(&self) -> Rgb {
        self.energy.iter().sum()
    }
}

#[cfg(test)]
#[path = "chiang_tests.rs"]
mod tests;
