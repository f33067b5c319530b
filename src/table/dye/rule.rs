//! The flux of a texel at an optical depth between or beyond the levels.
//!
//! Three facts about Laplace transforms of path lengths make this safe:
//!
//! * They are linear in the distribution. So there are weights, the same for all texels, with which
//!   the flux at `tau` is a sum of the fluxes at nearby levels; they are fitted so that every single
//!   path length comes out right, and then every mixture does.
//! * Their logarithm is convex. So the chord through the two levels around `tau` bounds it from
//!   above, and the chords of the neighboring intervals, prolonged, bound it from below. Clamped
//!   between them the result is positive, does not exceed the level before or fall below the one
//!   behind, and is exact where all light has gone the same way.
//! * At great depth only the shortest paths count. Where their lengths are distributed as a power, the
//!   flux falls as a power of the depth toward that of the light that met no pigment (Watson's
//!   lemma). Over levels that double, that is a geometric series toward a limit, and three of them
//!   tell both (Aitken 1926). So it goes on beyond the last level, again no lower than the chord.
//!
//! At a level the level itself is returned.

use super::RUN;
use super::power::power;

/// Levels that take part in one sum. Six leave twice the error, ten gain nothing more.
const SUPPORT: usize = 8;

/// Longest path length, in radii, for which the weights are fitted. Light through a plain fiber
/// travels 2 to 8 radii, scattered light some 10; longer paths are rare, and a wider fit would pay
/// for them with accuracy at the short ones.
const LONGEST_PATH: f64 = 60.0;

/// Errors of the fit count relative to `sqrt(transmittance) + FLOOR`: smaller favors dark texels,
/// larger favors bright ones. At 0.1 the error stays below half a percent of the clear flux.
const FLOOR: f64 = 0.1;

/// A series of which one term is more than this share of the one before has no limit that three
/// terms tell.
const STEADY: f32 = 0.999;

/// How the flux at one optical depth follows from the levels; the same for every texel.
#[derive(Clone, Debug)]
pub(super) enum Rule {
    /// The depth of a level.
    Level(usize),
    /// Between two levels.
    Between(Between),
    /// Beyond the last level.
    Beyond(Beyond),
}

#[derive(Clone, Debug)]
pub(super) struct Between {
    /// The level before; the next one lies behind the depth.
    before: usize,
    /// The first level of the sum.
    first: usize,
    weights: Vec<f32>,
    /// Place of the depth in its interval, 0..1.
    chord: f32,
    /// The same in units of the interval before (> 1), if there is one: a lower bound.
    from_below: Option<f32>,
    /// The same in units of the interval behind (< 0), if there is one: a lower bound.
    from_above: Option<f32>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    last: usize,
    /// How many times the last interval lies between the last level and the depth.
    steps: f32,
    /// How many times the last ratio of levels does, if the last three are a geometric series.
    terms: Option<f32>,
}

impl Rule {
    /// * `levels`: at least one, ascending, the first 0; two unless `tau` is 0.
    pub(super) fn new(levels: &[f64], tau: f64) -> Self {
        let before = levels.partition_point(|&l| l <= tau) - 1;
        if levels[before] == tau {
            return Self::Level(before);
        }
        let place = |i: usize| (tau - levels[i]) / (levels[i + 1] - levels[i]);
        let last = levels.len() - 1;
        if before == last {
            let ratio = |i: usize| levels[i] / levels[i - 1];
            let geometric = last >= 3 && (ratio(last) / ratio(last - 1) - 1.0).abs() < 1e-6;
            let terms = (tau / levels[last]).ln() / ratio(last).ln();
            return Self::Beyond(Beyond {
                last,
                steps: (place(last - 1) - 1.0) as f32,
                terms: geometric.then_some(terms as f32),
            });
        }
        // A sum of two or three exponentials fits nothing; then the chord has to do.
        let count = match levels.len() {
            0..4 => 0,
            n => n.min(SUPPORT),
        };
        let first = (before + 1)
            .saturating_sub(count / 2)
            .min(levels.len() - count);
        let weights = fit_weights(&levels[first..first + count], tau);
        Self::Between(Between {
            before,
            first,
            weights: weights.iter().map(|&w| w as f32).collect(),
            chord: place(before) as f32,
            from_below: (before > 0).then(|| place(before - 1) as f32),
            from_above: (before + 2 <= last).then(|| place(before + 1) as f32),
        })
    }

    /// The fluxes of a run of texels, at most [`RUN`].
    ///
    /// * `at`: those at a level.
    pub(super) fn apply<'a>(&self, at: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
        match self {
            Self::Level(level) => out.copy_from_slice(at(*level)),
            Self::Beyond(rule) => rule.apply(at, out),
            Self::Between(rule) => rule.apply(at, out),
        }
    }
}

impl Between {
    fn apply<'a>(&self, at: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
        let count = out.len();
        let (a, b) = (at(self.before), at(self.before + 1));
        // Plain loops over runs, one a step: so they become SIMD instructions.
        let (mut lower, mut upper) = ([0.0; RUN], [0.0; RUN]);
        let (lower, upper) = (&mut lower[..count], &mut upper[..count]);
        for ((upper, &a), &b) in upper.iter_mut().zip(a).zip(b) {
            *upper = a * power(ratio(b, a), self.chord);
        }
        lower.copy_from_slice(b);
        if let Some(place) = self.from_below {
            let before = at(self.before - 1);
            for ((lower, &a), &z) in lower.iter_mut().zip(a).zip(before) {
                *lower = lower.max(a * power(ratio(a, z), place - 1.0));
            }
        }
        if let Some(place) = self.from_above {
            let next = at(self.before + 2);
            for ((lower, &b), &n) in lower.iter_mut().zip(b).zip(next) {
                let chord = b * power(ratio(n, b), place);
                *lower = if n > 0.0 { lower.max(chord) } else { *lower };
            }
        }
        out.fill(0.0);
        if self.weights.is_empty() {
            out.copy_from_slice(upper);
        }
        for (i, &w) in self.weights.iter().enumerate() {
            for (out, &f) in out.iter_mut().zip(at(self.first + i)) {
                *out += w * f;
            }
        }
        let bounds = lower.iter().zip(upper.iter());
        for (((out, (&lower, &upper)), &a), &b) in out.iter_mut().zip(bounds).zip(a).zip(b) {
            // Rounding may cross the bounds where all light has gone the same way.
            let within = out.max(lower.min(upper)).min(upper);
            let dark = out.max(0.0).min(a);
            let falling = if b > 0.0 { within } else { dark };
            *out = if a > b { falling } else { a };
        }
    }
}

impl Beyond {
    fn apply<'a>(&self, at: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
        let (a, b) = (at(self.last - 1), at(self.last));
        for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
            *out = b * power(ratio(b, a).min(1.0), self.steps);
        }
        let Some(terms) = self.terms else { return };
        let texels = out.iter_mut().zip(at(self.last - 2)).zip(a).zip(b);
        for (((out, &z), &a), &b) in texels {
            let drop = (a - b).max(0.0);
            let share = ratio(drop, z - a);
            let steady = share < STEADY;
            // What all further terms sum to, and what those up to the depth do.
            let rest = drop * share / (1.0 - share.min(STEADY));
            let goes_on = b - rest * (1.0 - power(share.min(1.0), terms));
            *out = if steady && z > a {
                goes_on.max(*out).min(b)
            } else {
                *out
            };
        }
    }
}

/// Twice an optical depth: what the noise of a dyed map follows from.
///
/// A photon that counts `w` at `tau` counts `w^2` at `2 tau`, so the variance of the flux `F(tau)` is that
/// of the clear level times `F(2 tau) / F(0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubled {
    low: usize,
    high: usize,
    /// Place of twice the depth between the two, beyond 1 behind the last level.
    share: f32,
}

impl Doubled {
    pub(super) fn new(levels: &[f64], tau: f64) -> Self {
        if tau == 0.0 || levels.len() < 2 {
            return Self {
                low: 0,
                high: 0,
                share: 0.0,
            };
        }
        let low = levels
            .partition_point(|&l| l <= 2.0 * tau)
            .clamp(1, levels.len() - 1)
            - 1;
        let share = (2.0 * tau - levels[low]) / (levels[low + 1] - levels[low]);
        Self {
            low,
            high: low + 1,
            share: share as f32,
        }
    }

    /// Turns relative standard errors of the clear level into those of the dyed map. Unknown ones (0)
    /// stay unknown, and where nothing arrived they stay infinite.
    ///
    /// * `flux`: of the dyed map.
    pub(super) fn grow<'a>(
        &self,
        at: impl Fn(usize) -> &'a [f32],
        flux: &[f32],
        relative: &mut [f32],
    ) {
        if self.high == 0 {
            return;
        }
        let levels = at(0).iter().zip(at(self.low)).zip(at(self.high));
        for ((relative, &f), ((&clear, &a), &b)) in relative.iter_mut().zip(flux).zip(levels) {
            let twice = a * power(ratio(b, a).min(1.0), self.share);
            // By Schwarz at least 1; rounding and chords know nothing of that.
            let grown = (ratio(clear, f) * ratio(twice, f)).sqrt().max(1.0);
            *relative = if *relative > 0.0 {
                *relative * grown
            } else {
                0.0
            };
        }
    }
}

/// `a / b`, 0 where `b` is not positive.
#[inline]
fn ratio(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// Weights `w` with `sum_k w_k exp(-l levels_k) ~ exp(-l tau)` for all path lengths `l` from 0 to
/// [`LONGEST_PATH`], by least squares over log-spaced lengths. The length 0, light that never
/// entered, is exact.
fn fit_weights(levels: &[f64], tau: f64) -> Vec<f64> {
    const LENGTHS: usize = 200;
    let shortest = 1e-3f64;
    let ratio = LONGEST_PATH / shortest;
    let rows = (0..=LENGTHS).map(|i| {
        let length = match i {
            0 => 0.0,
            _ => shortest * ratio.powf((i - 1) as f64 / (LENGTHS - 1) as f64),
        };
        let target = (-length * tau).exp();
        let weight = if i == 0 { 1e4 } else { 1.0 } / (target.sqrt() + FLOOR);
        let row: Vec<f64> = levels
            .iter()
            .map(|l| weight * (-length * l).exp())
            .collect();
        (row, weight * target)
    });
    least_squares(rows.collect(), levels.len())
}

/// Least squares by modified Gram-Schmidt, one more column for the right-hand side.
fn least_squares(rows: Vec<(Vec<f64>, f64)>, columns: usize) -> Vec<f64> {
    let mut q: Vec<Vec<f64>> = (0..columns)
        .map(|k| rows.iter().map(|(row, _)| row[k]).collect())
        .collect();
    let mut rest: Vec<f64> = rows.iter().map(|(_, target)| *target).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut r = vec![vec![0.0; columns]; columns];
    let mut projected = vec![0.0; columns];
    for k in 0..columns {
        let norm = dot(&q[k], &q[k]).sqrt().max(f64::MIN_POSITIVE);
        r[k][k] = norm;
        q[k].iter_mut().for_each(|x| *x /= norm);
        let (done, later) = q.split_at_mut(k + 1);
        let unit = &done[k];
        for (j, column) in later.iter_mut().enumerate() {
            let along = dot(unit, column);
            r[k][k + 1 + j] = along;
            column
                .iter_mut()
                .zip(unit)
                .for_each(|(x, u)| *x -= along * u);
        }
        projected[k] = dot(unit, &rest);
        rest.iter_mut()
            .zip(unit)
            .for_each(|(x, u)| *x -= projected[k] * u);
    }
    let mut solution = vec![0.0; columns];
    for k in (0..columns).rev() {
        let known: f64 = (k + 1..columns).map(|j| r[k][j] * solution[j]).sum();
        solution[k] = (projected[k] - known) / r[k][k];
    }
    solution
}
