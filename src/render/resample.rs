//! Quasi-random sampling importance resampling: directions drawn nearly by the product of
//! scattering and light.                                                 [Talbot05, Perez05]
//!
//! Some candidates come from the scattering model, others from the environment. Each gets the
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
use crate::scene::{Aim, Environment, Sight, Spot};
use glam::Vec3;

/// Scattering that rays which hit other strands are expected to meet there.
const TYPICAL_ALBEDO: f32 = 0.5;

/// Probability that light comes to a place in the fur from one direction, where nothing is known of it.
pub(super) const TYPICAL_OPEN: f32 = 0.2;

/// Added to that probability where it is thought to be known: less makes noise where it is wrong, more asks in vain.
const HIDDEN: f32 = 0.02;

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
    /// Candidates for direct light at a scattering depth, beside a continuing ray.
    ///
    /// Half as many or twice as many from the environment are worth the same. Those from the scattering model are left to the
    /// continuing ray where they are dear: of tables they cost a quarter more than they gain, of analytic models a tenth less.
    ///
    /// * `copies`: ways in which the path goes on.
    pub(super) fn direct(depth: u32, is_dear_to_draw: bool, copies: u32) -> Self {
        let (scattering, lights) = match depth {
            0 => (2, 4),
            _ => (1, 2),
        };
        Self {
            scattering: if is_dear_to_draw { 0 } else { scattering },
            lights,
            continuing: copies as f32,
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
    /// About the probability that light comes from there.
    pub(super) open: f32,
}

/// What a place is thought to see of the environment.
#[derive(Clone, Copy)]
pub(super) struct Prospect<'a> {
    environment: &'a Environment,
    sight: Option<&'a Sight>,
}

impl<'a> Prospect<'a> {
    pub(super) fn new(environment: &'a Environment, sight: Option<&'a Sight>) -> Self {
        Self { environment, sight }
    }

    /// How much likelier than by the environment alone a bin is.
    #[inline]
    fn favor(&self, sight: &Sight, bin: usize) -> f32 {
        sight.share(bin) / self.environment.bins()[bin]
    }

    /// About the probability that light comes from a bin that is likelier by a factor.
    #[inline]
    fn open(sight: &Sight, favor: f32) -> f32 {
        (favor * sight.seen()).min(1.0)
    }

    /// The environment's radiance from a spot, the density of what is drawn there, and about the probability that light
    /// comes from there.
    #[inline]
    pub(super) fn eval(&self, spot: Spot) -> (Rgb, f32, f32) {
        let (light, pdf) = self.environment.eval_at(spot);
        match self.sight {
            Some(sight) if pdf > 0.0 => {
                let favor = self.favor(sight, self.environment.bin_of(spot));
                (light, pdf * favor, Self::open(sight, favor))
            }
            _ => (light, pdf, TYPICAL_OPEN),
        }
    }

    /// A direction that is about to be drawn, the factor on its density, and about the probability that light comes from
    /// there.
    #[inline]
    fn aim(&self, u: [f32; 2]) -> Option<(Aim, f32, f32)> {
        let Some(sight) = self.sight else {
            return Some((self.environment.aim(u)?, 1.0, TYPICAL_OPEN));
        };
        let (bin, rest) = sight.choose(u[0]);
        let favor = self.favor(sight, bin);
        let aim = self.environment.aim_in(bin, [rest, u[1]]);
        Some((aim, favor, Self::open(sight, favor)))
    }
}

/// Most candidates of a kind.
const MOST: usize = 4;

/// The candidates of a plan at one scattering point, each told to `each`.
///
/// All texels that they need are asked for before the first of them is read.
#[inline(always)]
pub(super) fn candidates(
    scatter: &Scatter<'_>,
    prospect: Prospect<'_>,
    plan: Plan,
    draws: &Draws,
    bounce: u32,
    mut each: impl FnMut(Candidate),
) {
    // Each kind is an aligned run of its own net.
    let net = draws.net(bounce, Purpose::Light);
    let first = draws.run(plan.lights);
    let mut aims = [None; MOST];
    for (j, aim) in (0..plan.lights).zip(&mut aims) {
        let u = net.point(first + j);
        *aim = prospect.aim([u[0], u[1]]).map(|aim| (aim, u[2]));
    }
    let net = draws.net(bounce, Purpose::Scatter);
    let first = draws.run(plan.scattering);
    let mut drawn = [None; MOST];
    for (j, drawn) in (0..plan.scattering).zip(&mut drawn) {
        let u = net.point(first + j);
        let direction = scatter.sample([u[0], u[1], u[2]]);
        *drawn = direction.map(|s| (s, prospect.environment.spot(s.dir), u[3]));
    }
    // What the sampling of one side knows already is not looked up again.
    for (s, spot, chance) in drawn[..plan.scattering as usize].iter().flatten() {
        let (light, light_pdf, open) = prospect.eval(*spot);
        each(Candidate {
            dir: s.dir,
            density: s.weight * s.pdf,
            light,
            weight: 1.0 / plan.density(s.pdf, light_pdf),
            chance: *chance,
            open,
        });
    }
    for ((aim, favor, open), chance) in aims[..plan.lights as usize].iter().flatten() {
        let Some(s) = prospect.environment.draw(*aim) else {
            continue;
        };
        let (density, scatter_pdf) = scatter.eval(s.dir);
        each(Candidate {
            dir: s.dir,
            density,
            light: s.radiance,
            weight: 1.0 / plan.density(scatter_pdf, s.pdf * favor),
            chance: *chance,
            open: *open,
        });
    }
}

/// The probability with which a ray that would bring `light` is sent; what it brings is divided by it.
///
/// Most light is blocked in fur, so the noise of a ray is about what it would bring times the root of the probability that
/// it does. Noise is least for a number of rays that are sent in proportion to that.
///
/// * `open`: about that probability. * `enough`: luminance from which on a ray is always sent where as much is open as
///   usual.
pub(super) fn chance_of_asking(light: Rgb, open: f32, enough: f32) -> f32 {
    let favor = ((open + HIDDEN) * (1.0 / TYPICAL_OPEN)).sqrt();
    (luminance(light) * favor / enough).min(1.0)
}

/// Draws one direction; its weight is scattering density times W.
pub(super) fn resample(
    scatter: &Scatter<'_>,
    prospect: Prospect<'_>,
    plan: Plan,
    target: &Target,
    draws: &Draws,
    bounce: u32,
) -> Option<Direction> {
    let mut choice = draws.point(bounce, Purpose::Choice)[0];
    let (mut sum, mut kept) = (0.0f32, None);
    candidates(scatter, prospect, plan, draws, bounce, |candidate| {
        let value = target.value(luminance(candidate.density), luminance(candidate.light));
        let weight = value * candidate.weight;
        // Also drops NaN.
        if !(weight > 0.0 && weight.is_finite()) {
            return;
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
    });
    let (candidate, value) = kept?;
    Some(Direction {
        dir: candidate.dir,
        weight: candidate.density * (sum / value),
        pdf: value / sum,
    })
}
