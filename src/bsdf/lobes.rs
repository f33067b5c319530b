//! The parts that hair models in closed form are made of: where a ray goes in a strand, lobes along it and around it.

use crate::math::bessel;
use crate::math::quick::{exp, sin_cos_of_turns, turns};
use glam::{Vec3, Vec4};
use std::f32::consts::{FRAC_PI_8, PI, TAU};

/// Least roughness that is computed with: below it lobes are too narrow for single precision.
const LEAST_ROUGHNESS: f32 = 0.02;

/// Variance of the longitudinal lobe R (Chiang et al. 2016).
///
/// * `roughness`: 0..1; below 0.02 it is taken as 0.02.
pub(super) fn variance(roughness: f32) -> f32 {
    let m = roughness.clamp(LEAST_ROUGHNESS, 1.0);
    (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2)
}

/// Scale of the logistic around the strand (same source).
///
/// * `roughness`: 0..1; below 0.02 it is taken as 0.02.
pub(super) fn logistic_scale(roughness: f32) -> f32 {
    let n = roughness.clamp(LEAST_ROUGHNESS, 1.0);
    FRAC_PI_8.sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22))
}

/// The way of a line of sight through a strand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Sine and cosine of the viewer's inclination.
    pub(super) sin: f32,
    pub(super) cos: f32,
    /// Cosine between the line and the surface.
    pub(super) cosine: f32,
    /// Sine of the angle inside to the surface, seen along the strand: the least distance from the axis.
    pub(super) sin_gamma_t: f32,
    /// Cosine of the inclination inside.
    pub(super) cos_theta_t: f32,
    /// Length of a crossing, radii.
    pub(super) crossing: f32,
    /// Azimuths about which R, TT and TRT leave, at most half a turn either way.
    pub(super) exit: Vec4,
}

impl Entry {
    /// * `wo`: unit direction to the viewer in the strand frame, y = 0 and x >= 0.
    /// * `h`: where across the strand the line meets it, -1..1 in radii, positive toward +Y. * `eta`: index.
    #[inline(always)]
    pub(super) fn new(wo: Vec3, h: f32, eta: f32) -> Self {
        let sin = wo.z.clamp(-1.0, 1.0);
        let cos = (1.0 - sin * sin).sqrt().max(1e-4);
        // Positive h sees normals that lean to +Y, about which light turns to positive azimuths.
        let h = -h.clamp(-0.9999, 0.9999);
        let bravais = (eta * eta - sin * sin).sqrt() / cos;
        let sin_gamma_t = h / bravais;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let sin_t = sin / eta;
        let cos_theta_t = (1.0 - sin_t * sin_t).sqrt();
        let cos_gamma_i = (1.0 - h * h).sqrt();
        let gamma_i = TAU * turns(h, cos_gamma_i);
        let gamma_t = TAU * turns(sin_gamma_t, cos_gamma_t);
        let [r, tt, trt] =
            [0.0, 1.0, 2.0].map(|p| near_zero(2.0 * p * gamma_t - 2.0 * gamma_i + p * PI));
        Self {
            sin,
            cos,
            cosine: cos * cos_gamma_i,
            sin_gamma_t,
            cos_theta_t,
            crossing: 2.0 * cos_gamma_t / cos_theta_t,
            exit: Vec4::new(r, tt, trt, 0.0),
        }
    }
}

/// An angle of at most three half turns either way, less a full turn if there is one.
pub(super) fn near_zero(angle: f32) -> f32 {
    if angle.abs() > PI {
        angle - TAU.copysign(angle)
    } else {
        angle
    }
}

/// One longitudinal lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Longitudinal {
    pub(super) variance: f32,
    /// `exp(-2 / v)`.
    floor: f32,
    /// Sine and cosine of the angle by which scales tilt the query.
    tilt: [f32; 2],
}

impl Longitudinal {
    pub(super) fn new(variance: f32, tilt: f32) -> Self {
        let floor = (-2.0 / variance).exp();
        Self {
            variance,
            floor,
            tilt: tilt.sin_cos().into(),
        }
    }

    /// Sine and cosine of the query's inclination as the scales tilt it.
    pub(super) fn tilted(&self, sin: f32, cos: f32) -> [f32; 2] {
        let [s, c] = self.tilt;
        [sin * c + cos * s, (cos * c - sin * s).abs()]
    }

    /// `1 / (v (1 - exp(-2 / v)))`.
    pub(super) fn norm(&self) -> f32 {
        1.0 / (self.variance * (1.0 - self.floor))
    }

    /// Sine of an inclination drawn by [`longitudinal`].
    pub(super) fn sample(&self, [sin_q, cos_q]: [f32; 2], u: f32, v: f32) -> f32 {
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
pub(super) fn longitudinal(sharpness: Vec4, norm: Vec4, product: Vec4, along: Vec4) -> Vec4 {
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
pub(super) struct Logistic {
    scale: f32,
    /// Probability of the untrimmed one below -pi, and between -pi and pi.
    below: f32,
    between: f32,
    /// `1 / scale` and `1 / (scale between)`.
    inverse: f32,
    norm: f32,
}

impl Logistic {
    pub(super) fn new(scale: f32) -> Self {
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
    pub(super) fn density(&self, angle: Vec4) -> Vec4 {
        let off = angle.abs();
        let off = off.min(TAU - off);
        let e = exp(-off * self.inverse);
        let sum = 1.0 + e;
        self.norm * e / (sum * sum)
    }

    pub(super) fn sample(&self, u: f32) -> f32 {
        let p = (self.below + u * self.between).clamp(f32::MIN_POSITIVE, 1.0 - f32::EPSILON);
        (-self.scale * (1.0 / p - 1.0).ln()).clamp(-PI, PI)
    }
}

/// A Cauchy distribution wrapped around a strand.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrappedCauchy {
    /// Mean cosine of the angle from its center.
    rho: f32,
    /// `(1 - rho^2) / 2 pi`.
    norm: f32,
}

impl WrappedCauchy {
    /// * `rho`: mean cosine, 0 (even) to 0.99; beyond it single precision knows too little of its peak.
    pub(super) fn new(rho: f32) -> Self {
        let rho = rho.clamp(0.0, 0.99);
        Self {
            rho,
            norm: (1.0 - rho * rho) / TAU,
        }
    }

    /// Per radian.
    ///
    /// * `cosine`: of the angle from the center.
    #[inline(always)]
    pub(super) fn density(&self, cosine: f32) -> f32 {
        let off = 1.0 - self.rho;
        self.norm / (off * off + 2.0 * self.rho * (1.0 - cosine))
    }

    /// An angle from the center, at most half a turn either way.
    pub(super) fn sample(&self, u: f32) -> f32 {
        let narrow = (1.0 - self.rho) / (1.0 + self.rho);
        2.0 * (narrow * (PI * (u - 0.5)).tan()).atan()
    }
}
