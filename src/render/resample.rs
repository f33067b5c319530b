//! Quasi-random sampling importance resampling: directions drawn nearly by the product of
//! scattering and light.                                                 [Talbot05, Perez05]
//!
//! Half of M candidates comes from the scattering model, half from the environment. Each gets the
//! weight of the balance heuristic, `m(x) = 1 / sum_k n_k p_k(x)`. Two uses:
//!
//! * Light straight from the environment: every candidate brings `m F` if nothing is in front of it, F
//!   scattering times environment, and is asked with a probability in proportion to that
//!   ([`chance_of_asking`]). Rays go where the light would come from, and all that are left to chance bring as much.
//!   The ray that continues the path counts as one more technique, so that its escapes are not wasted.
//! * One ray for everything, as in the paper: one candidate is kept by chance in proportion to m times a
//!   target p^,
//!
//! ```text
//! w_j = m(x_j) p^(x_j)      W = sum_j w_j / p^(Y)
//! ```
//!
//!   and `F(Y) W` is an unbiased estimate of the integral of F wherever the target is positive where F
//!   is. The ray also carries what other strands send, so the target must not vanish where the environment
//!   is dark. The bare product never sends a ray there and loses that light.

use super::draws::{Draws, Purpose};
use super::scatter::{Direction, Scatter};
use crate::color::{Rgb, luminance};
use crate::scene::Environment;
use glam::Vec3;

/// Scattering that rays which hit other strands are expected to meet there.
const TYPICAL_ALBEDO: f32 = 0.5;

/// Shares of candidates: how many are drawn from the scattering model and from the environment, and
/// how many of the former the continuing ray stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Candidates from the scattering model, 0 or a power of two.
    scattering: u32,
    /// Candidates from the environment, a power of two.
    lights: u32,
    /// Samples of the scattering model that the continuing ray counts as; 0 if there is none.
    continuing: f32,
}

impl Plan {
    /// Candidates for direct light at a scattering depth, beside a continuing ray. Four at the eye, two deeper:
    /// twice as many lower the noise by less than they cost, most of all where a shading model is dear.
    pub(super) fn direct(depth: u32) -> Self {
        let half = match depth {
            0 => 2,
            _ => 1,
        };
        Self {
            scattering: half,
            lights: half,
            continuing: 1.0,
        }
    }

    /// Candidates for the only ray; `None` deep in the fur, where drawing from the scattering model
    /// alone does as well.
    pub(super) fn one_ray(depth: u32) -> Option<Self> {
        let half = match depth {
            0 => 4,
            1 | 2 => 2,
            3..=5 => 1,
            _ => return None,
        };
        Some(Self {
            scattering: half,
            lights: half,
            continuing: 0.0,
        })
    }

    /// Sum over techniques of count times density.
    fn density(&self, scatter_pdf: f32, light_pdf: f32) -> f32 {
        (self.scattering as f32 + self.continuing) * scatter_pdf + self.lights as f32 * light_pdf
    }

    /// The share of direct light that an escaping continuing ray brings.
    pub(super) fn escape_weight(&self, scatter_pdf: f32, light_pdf: f32) -> f32 {
        self.continuing * scatter_pdf / self.density(scatter_pdf, light_pdf)
    }
}

/// The guess of the light along a direction: a blend of the environment and of the light that other
/// strands send.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Expected share of rays that escape.
    escape: f32,
    /// Radiance expected along the others.
    indirect: f32,
}

impl Target {
    /// Only the environment: biased for a ray that carries all light.
    #[cfg(test)]
    pub(super) const DIRECT: Self = Self {
        escape: 1.0,
        indirect: 0.0,
    };

    /// Environment, and other strands that all light falls on.
    ///
    /// * `mean`: radiance over all directions. * `depth`: scattering events before this one. The chance to escape falls as paths go deeper;
    ///   any value in (0, 1) is unbiased. At 0.9 dark directions come with large weights and noise
    ///   doubles, below 0.2 bright lamps are missed.
    pub(super) fn all(mean: Rgb, depth: u32) -> Self {
        Self {
            escape: 0.5 * 0.8f32.powi(depth.min(10) as i32),
            indirect: TYPICAL_ALBEDO * luminance(mean),
        }
    }

    fn value(&self, density: f32, light: f32) -> f32 {
        density * (self.escape * light + (1.0 - self.escape) * self.indirect)
    }
}

/// A direction that may be taken.
pub(super) struct Candidate {
    /// Unit, world.
    pub(super) dir: Vec3,
    /// Scattered share per steradian.
    pub(super) density: Rgb,
    /// The environment's radiance from there.
    pub(super) light: Rgb,
    /// Weight of the balance heuristic, steradians.
    pub(super) weight: f32,
    /// A number in `[0, 1)` that belongs to it and is not used yet.
    pub(super) chance: f32,
}

/// The candidates of a plan at one scattering point.
pub(super) fn candidates(
    scatter: &Scatter<'_>,
    environment: &Environment,
    plan: Plan,
    draws: &Draws,
    bounce: u32,
) -> impl Iterator<Item = Candidate> {
    let scattering = draws.net(bounce, Purpose::Scatter);
    let lights = draws.net(bounce, Purpose::Light);
    (0..plan.scattering + plan.lights).filter_map(move |j| {
        // Each kind is an aligned run of its own net.
        // What the sampling of one side knows already is not looked up again.
        if j < plan.scattering {
            let u = scattering.point(draws.run(plan.scattering) + j);
            let s = scatter.sample([u[0], u[1], u[2]])?;
            let (light, light_pdf) = environment.eval(s.dir);
            Some(Candidate {
                dir: s.dir,
                density: s.weight * s.pdf,
                light,
                weight: 1.0 / plan.density(s.pdf, light_pdf),
                chance: u[3],
            })
        } else {
            let u = lights.point(draws.run(plan.lights) + j - plan.scattering);
            let s = environment.sample([u[0], u[1]])?;
            let (density, scatter_pdf) = scatter.eval(s.dir);
            Some(Candidate {
                dir: s.dir,
                density,
                light: s.radiance,
                weight: 1.0 / plan.density(scatter_pdf, s.pdf),
                chance: u[2],
            })
        }
    })
}

/// The probability with which a ray that would bring `light` is sent; what it brings is divided by it.
///
/// Most light is blocked in fur, so the noise of a ray is about what it would bring. Noise is least for a number
/// of rays that are sent in proportion to that.
///
/// * `enough`: luminance from which on it is always sent.
pub(super) fn chance_of_asking(light: Rgb, enough: f32) -> f32 {
    (luminance(light) / enough).min(1.0)
}

/// Draws one direction; its weight is scattering density times W.
pub(super) fn resample(
    scatter: &Scatter<'_>,
    environment: &Environment,
    plan: Plan,
    target: &Target,
    draws: &Draws,
    bounce: u32,
) -> Option<Direction> {
    let mut choice = draws.point(bounce, Purpose::Choice)[0];
    let (mut sum, mut kept) = (0.0f32, None);
    for candidate in candidates(scatter, environment, plan, draws, bounce) {
        let value = target.value(luminance(candidate.density), luminance(candidate.light));
        let weight = value * candidate.weight;
        // Also drops NaN.
        if !(weight > 0.0 && weight.is_finite()) {
            continue;
        }
        sum += weight;
        // Weighted reservoir with one random number: stretch what is left of it each time.
        let share = weight / sum;
        if choice < share {
            choice /= share;
            kept = Some((candidate, value));
        } else {
            choice = (choice - share) / (1.0 - share);
        }
    }
    let (candidate, value) = kept?;
    Some(Direction {
        dir: candidate.dir,
        weight: candidate.density * (sum / value),
        pdf: value / sum,
    })
}
