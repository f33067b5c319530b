//! Quasi-random sampling importance resampling: one direction drawn nearly by the product of
//! scattering and light.                                                 [Talbot05, Perez05]
//!
//! Half of M candidates comes from the scattering model, half from the environment. Each gets the
//! weight of the balance heuristic times a target, one is kept by chance in proportion, and
//!
//! ```text
//! m(x) = 1 / sum_k n_k p_k(x)      w_j = m(x_j) p^(x_j)      W = sum_j w_j / p^(Y)
//! ```
//!
//! makes `F(Y) W` an unbiased estimate of the integral of F wherever the target is positive where F
//! is. The kept ray also carries what other strands send, so the target must not vanish where the
//! environment is dark: the bare product of scattering and environment never sends a ray there and
//! loses that light.

use super::draws::{Draws, Purpose};
use super::scatter::{Direction, Scatter};
use crate::color::luminance;
use crate::scene::Environment;

/// Scattering that the rays which hit other strands are expected to meet there.
const TYPICAL_ALBEDO: f32 = 0.5;

/// The target's guess of the light along a direction: a blend of the environment and of the light
/// that other strands send.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Expected share of rays that escape.
    escape: f32,
    /// Radiance expected along the others.
    indirect: f32,
}

impl Target {
    /// * `depth`: scattering events before this one. The chance to escape falls as paths go deeper;
    ///   any value in (0, 1) is unbiased.
    pub(super) fn new(environment: &Environment, depth: u32) -> Self {
        Self {
            escape: 0.5 * 0.8f32.powi(depth.min(10) as i32),
            indirect: TYPICAL_ALBEDO * luminance(environment.mean()),
        }
    }

    /// The bare product, biased: kept so that the test of the bias can be seen to fail.
    #[cfg(test)]
    pub(super) fn bare() -> Self {
        Self {
            escape: 1.0,
            indirect: 0.0,
        }
    }

    fn value(&self, density: f32, light: f32) -> f32 {
        density * (self.escape * light + (1.0 - self.escape) * self.indirect)
    }
}

/// Candidates at a scattering depth. Eight pay off where the ray has a fair chance to escape;
/// deeper, occlusion rules the variance and candidates are wasted.
pub(super) fn candidates(depth: u32) -> u32 {
    match depth {
        0 => 8,
        1 | 2 => 4,
        3..=5 => 2,
        _ => 1,
    }
}

/// Draws one direction; the weight is scattering density times W.
///
/// * `count`: candidates, a power of two >= 2.
pub(super) fn resample(
    scatter: &Scatter<'_>,
    environment: &Environment,
    target: &Target,
    draws: &Draws,
    bounce: u32,
    count: u32,
) -> Option<Direction> {
    let half = count / 2;
    let (scattering, lights) = (
        draws.net(bounce, Purpose::Scatter),
        draws.net(bounce, Purpose::Light),
    );
    let first = draws.run(half);
    let mut choice = draws.point(bounce, Purpose::Choice)[0];
    let (mut sum, mut kept) = (0.0f32, None);
    for j in 0..count {
        let u = if j < half {
            scattering.point(first + j)
        } else {
            lights.point(first + j - half)
        };
        let dir = if j < half {
            scatter.sample([u[0], u[1], u[2]]).map(|s| s.dir)
        } else {
            environment.sample([u[0], u[1]]).map(|s| s.dir)
        };
        let Some(dir) = dir else { continue };
        let (density, scatter_pdf) = scatter.eval(dir);
        let (light, light_pdf) = environment.eval(dir);
        let value = target.value(luminance(density), luminance(light));
        let pdf = half as f32 * (scatter_pdf + light_pdf);
        let weight = value / pdf;
        // Also drops NaN.
        if !(weight > 0.0 && weight.is_finite()) {
            continue;
        }
        sum += weight;
        // Weighted reservoir with one random number: stretch what is left of it each time.
        let share = weight / sum;
        if choice < share {
            choice /= share;
            kept = Some((dir, density, value));
        } else {
            choice = (choice - share) / (1.0 - share);
        }
    }
    let (dir, density, value) = kept?;
    Some(Direction {
        dir,
        weight: density * (sum / value),
        pdf: value / sum,
    })
}
