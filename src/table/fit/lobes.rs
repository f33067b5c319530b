//! The parts from which hair shaders are made: longitudinal and azimuthal lobes, means over the width.

use super::data::COLUMNS;
use crate::math::bessel;
use std::f64::consts::{FRAC_PI_8, LN_2, PI, TAU};

/// Offsets over half the width at which a fiber is entered. The narrowest azimuthal lobe in use is as
/// wide as the spread from one to the next.
pub(super) const OFFSETS: usize = 40;

/// One lobe for one query: a product of a function of the inclination and one of the azimuth.
#[derive(Clone, Debug)]
pub(super) struct Lobe {
    /// Per row.
    pub(super) along: Vec<f64>,
    /// `around[channel][column]`: energy included, per radian.
    pub(super) around: Vec<[f64; COLUMNS]>,
}

/// Longitudinal scattering of d'Eon et al. 2011, "An energy-conserving hair reflectance model":
/// normalized so that its integral times `cos(theta_i)` is 1.
///
/// * `v`: variance.
pub(super) fn longitudinal(theta_i: f64, theta_q: f64, v: f64) -> f64 {
    let a = theta_i.cos() * theta_q.cos() / v;
    let b = theta_i.sin() * theta_q.sin() / v;
    if v <= 0.1 {
        (log_bessel(a) - b - 1.0 / v + LN_2 + (0.5 / v).ln()).exp()
    } else {
        (log_bessel(a) - b).exp() / ((1.0 / v).sinh() * 2.0 * v)
    }
}

/// Logarithm of the modified Bessel function I0.
fn log_bessel(x: f64) -> f64 {
    let horner =
        |coefficients: &[f64], t: f64| coefficients.iter().rev().fold(0.0, |s, c| s * t + c);
    if x < bessel::EDGE {
        horner(&bessel::NEAR, (x / bessel::EDGE).powi(2)).ln()
    } else {
        x + horner(&bessel::FAR, bessel::EDGE / x).ln() - 0.5 * x.ln()
    }
}

/// Mean of the longitudinal lobe over each row.
pub(super) fn along(edges: &[f64], theta_q: f64, v: f64) -> Vec<f64> {
    const POINTS: usize = 3;
    edges
        .windows(2)
        .map(|e| {
            let at = |i: usize| e[0] + (e[1] - e[0]) * (i as f64 + 0.5) / POINTS as f64;
            let sum: f64 = (0..POINTS).map(|i| longitudinal(at(i), theta_q, v)).sum();
            sum / POINTS as f64
        })
        .collect()
}

/// Variance of the longitudinal lobe R for a roughness 0..1 (Chiang et al. 2016, "A practical and
/// controllable hair and fur model for production path tracing").
pub(super) fn variance(roughness: f64) -> f64 {
    let m = roughness;
    (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2)
}

/// Scale of the azimuthal logistic for a roughness 0..1 (same source).
pub(super) fn logistic_scale(roughness: f64) -> f64 {
    let n = roughness;
    FRAC_PI_8.sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22))
}

/// Adds a logistic about azimuth `center`, trimmed to a full turn, times `energy` of each channel: its
/// mean over each column of azimuths, both signs together.
pub(super) fn add_logistic(around: &mut [[f64; COLUMNS]], center: f64, scale: f64, energy: &[f64]) {
    let logistic = |x: f64| 1.0 / (1.0 + (-x / scale).exp());
    let norm = logistic(PI) - logistic(-PI);
    // The integral from the center's far side to an azimuth, whole turns included.
    let integral = |phi: f64| {
        let off = phi - center;
        let turns = ((off + PI) / TAU).floor();
        turns + (logistic(off - turns * TAU) - logistic(-PI)) / norm
    };
    let step = PI / COLUMNS as f64;
    let edge = |i: usize| [integral(i as f64 * step), integral(-(i as f64) * step)];
    let mut before = edge(0);
    for column in 0..COLUMNS {
        let behind = edge(column + 1);
        let share = (behind[0] - before[0] + before[1] - behind[1]) / (2.0 * step);
        for (around, energy) in around.iter_mut().zip(energy) {
            around[column] += energy * share;
        }
        before = behind;
    }
}

/// A ray that enters at an offset from the axis.
pub(super) struct Entry {
    pub(super) gamma_i: f64,
    pub(super) gamma_t: f64,
    /// Cosine between ray and surface.
    pub(super) cosine: f64,
    /// Cosine of the inclination inside.
    pub(super) cos_theta_t: f64,
}

/// Rays of all offsets `0..1`, each standing for an equal share of the width.
pub(super) fn entries(eta: f64, theta_q: f64) -> impl Iterator<Item = Entry> {
    let (sin, cos) = theta_q.sin_cos();
    let bravais = (eta * eta - sin * sin).sqrt() / cos;
    let cos_theta_t = (1.0 - (sin / eta).powi(2)).sqrt();
    (0..OFFSETS).map(move |i| {
        let h = (i as f64 + 0.5) / OFFSETS as f64;
        Entry {
            gamma_i: h.asin(),
            gamma_t: (h / bravais).min(1.0).asin(),
            cosine: cos * (1.0 - h * h).sqrt(),
            cos_theta_t,
        }
    })
}

/// Azimuth at which light leaves after `p` crossings.
pub(super) fn exit_azimuth(p: usize, entry: &Entry) -> f64 {
    let p = p as f64;
    2.0 * p * entry.gamma_t - 2.0 * entry.gamma_i + p * PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lobes_are_normalized() {
        for v in [0.002, 0.05, 0.2, 1.5] {
            for theta in [-1.2, 0.0, 0.7] {
                let n = 20_000;
                let sum: f64 = (0..n)
                    .map(|i| {
                        let t = PI * ((i as f64 + 0.5) / n as f64 - 0.5);
                        longitudinal(t, theta, v) * t.cos() * PI / n as f64
                    })
                    .sum();
                assert!((sum - 1.0).abs() < 1e-4, "{v} {theta}: {sum}");
            }
        }
        for (center, scale) in [(0.3, 0.05), (9.0, 0.4), (-4.0, 0.01)] {
            let mut around = [[0.0; COLUMNS]];
            add_logistic(&mut around, center, scale, &[0.7]);
            let sum: f64 = around[0].iter().sum::<f64>() * 2.0 * PI / COLUMNS as f64;
            assert!((sum - 0.7).abs() < 1e-9, "{center}: {sum}");
        }
    }
}
