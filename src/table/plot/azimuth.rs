//! The azimuthal cut: how much light leaves toward each azimuth, over all inclinations.

use super::text::{Pen, degrees};
use super::{Area, CHANNELS, FAINT, Field, INK, Plot};
use crate::image::Canvas;
use crate::math::{frame, fresnel};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Columns of the cut, of 2 degrees: wider than a texel, or the steps of texels would show.
const COLUMNS: usize = 180;

/// Azimuths averaged for a column of the table.
const TAPS: usize = 4;

/// Inclinations summed for a column.
const ROWS: usize = 360;

/// Decades of the vertical scale.
const DECADES: f32 = 3.0;

/// A smooth bare cylinder, whose scattering has a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothCylinder {
    /// Its index over that of what surrounds it.
    pub eta: f64,
    /// Absorption per radius for R, G and B.
    pub tau: [f64; 3],
}

impl SmoothCylinder {
    /// Light per radian of azimuth in each of `columns` columns from -pi to pi, for a query at
    /// inclination `theta`: Bravais' law makes the inclined cylinder a circle of another index
    /// (Marschner et al. 2003). Means over the columns, so that caustics are finite.
    fn cut(&self, theta: f64, channel: usize, columns: usize) -> Vec<f64> {
        /// Entries over half the width; a column holds hundreds of them.
        const ENTRIES: usize = 40_000;
        let (sin, cos) = theta.sin_cos();
        let bravais = (self.eta * self.eta - sin * sin).sqrt() / cos.max(1e-9);
        let cos_theta_t = (1.0 - (sin / self.eta).powi(2)).sqrt();
        let mut sums = vec![0.0; columns];
        for i in 0..ENTRIES {
            let h = (i as f64 + 0.5) / ENTRIES as f64;
            let (gamma_i, gamma_t) = (h.asin(), (h / bravais).asin());
            let (f, _) = fresnel::dielectric(cos * gamma_i.cos(), self.eta);
            let t = (-2.0 * self.tau[channel] * gamma_t.cos() / cos_theta_t).exp();
            let mut share = f;
            for p in 0..40 {
                if p == 1 {
                    share = (1.0 - f).powi(2) * t;
                } else if p > 1 {
                    share *= f * t;
                }
                if share < 1e-9 {
                    break;
                }
                let p = f64::from(p);
                let phi = 2.0 * p * gamma_t - 2.0 * gamma_i + p * PI;
                for phi in [phi, -phi] {
                    let turn = (phi / TAU + 0.5).rem_euclid(1.0);
                    let column = ((turn * columns as f64) as usize).min(columns - 1);
                    sums[column] += share;
                }
            }
        }
        let unit = columns as f64 / TAU / (2 * ENTRIES) as f64;
        sums.iter_mut().for_each(|s| *s *= unit);
        sums
    }
}

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, field: &Field, plot: &Plot) {
    let line = pen.line();
    let frame = Area {
        min: area.min + Vec2::new(6.0 * line, 1.8 * line),
        max: area.max - Vec2::new(2.0 * line, 2.6 * line),
    };
    let channels = if plot.gray { 1 } else { 3 };
    let cut = measured(field);
    let peak = cut
        .iter()
        .flat_map(|c| c.to_array())
        .fold(1e-9f32, f32::max);
    // Up to the next half decade.
    let top = (2.0 * peak.log10()).ceil() / 2.0;
    let place = |column: f64, value: f64| {
        let y = (top - (value.max(1e-12) as f32).log10()) / DECADES;
        let x = column as f32 / COLUMNS as f32;
        frame.min + frame.size() * Vec2::new(x, y.clamp(0.0, 1.0))
    };
    let caption = match plot.closed_form {
        Some(_) => "light per radian; thin line: closed form",
        None => "light per radian of azimuth",
    };
    let title = Vec2::new(frame.min.x, area.min.y);
    pen.left(canvas, title, caption, INK);
    axes(canvas, pen, frame, top);
    for c in (0..channels).rev() {
        let ink = if plot.gray { INK } else { CHANNELS[c] };
        let value = |i: usize| f64::from(cut[i % COLUMNS][c]);
        let points: Vec<Vec2> = (0..COLUMNS)
            .map(|i| place(i as f64 + 0.5, value(i)))
            .collect();
        if plot.closed_form.is_some() {
            // Pale and wide, so that the closed form is seen upon it.
            canvas.polyline(&points, 4.0 * pen.hair(), ink.lerp(Vec3::ONE, 0.6));
        } else {
            canvas.polyline(&points, 2.0 * pen.hair(), ink);
        }
    }
    if let Some(cylinder) = plot.closed_form {
        for (c, &channel) in CHANNELS.iter().enumerate().take(channels) {
            let ink = if plot.gray { INK } else { 0.7 * channel };
            let cut = cylinder.cut(field.theta, c, COLUMNS);
            let points = cut
                .iter()
                .enumerate()
                .map(|(i, &v)| place(i as f64 + 0.5, v));
            let points: Vec<Vec2> = points.collect();
            canvas.polyline(&points, pen.hair(), ink);
        }
    }
}

/// Light of the table per radian in each column.
fn measured(field: &Field) -> Vec<Vec3> {
    (0..COLUMNS)
        .into_par_iter()
        .map(|column| {
            let mut sum = Vec3::ZERO;
            for i in 0..ROWS * TAPS {
                let (row, tap) = (i / TAPS, (i % TAPS) as f64 + 0.5);
                let phi = TAU * (column as f64 + tap / TAPS as f64) / COLUMNS as f64 - PI;
                let theta = PI * (row as f64 + 0.5) / ROWS as f64 - FRAC_PI_2;
                let density = field.rgb(frame::direction(theta, phi));
                sum += density * (theta.cos() * PI / (ROWS * TAPS) as f64) as f32;
            }
            sum
        })
        .collect()
}

fn axes(canvas: &mut Canvas, pen: &Pen, area: Area, top: f32) {
    let line = pen.line();
    let at = |x: f32, y: f32| area.min + area.size() * Vec2::new(x, y);
    let mut exponent = top.floor();
    while exponent >= top - DECADES {
        let y = (top - exponent) / DECADES;
        canvas.line(at(0.0, y), at(1.0, y), 0.5 * pen.hair(), FAINT);
        let label = super::sphere_map::power_of_ten(exponent as i32);
        pen.right(canvas, at(0.0, y) - Vec2::new(0.6 * line, 0.0), &label, INK);
        exponent -= 1.0;
    }
    for k in -2..=2 {
        let x = 0.5 + 0.25 * k as f32;
        canvas.line(at(x, 0.0), at(x, 1.0), 0.5 * pen.hair(), FAINT);
        let below = at(x, 1.0) + Vec2::new(0.0, 0.9 * line);
        pen.center(canvas, below, &degrees(90.0 * f64::from(k)), INK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINE: usize = 360;

    #[test]
    fn the_closed_form_keeps_its_energy_and_its_caustics() {
        let glass = SmoothCylinder {
            eta: 1.55,
            tau: [0.0, 0.2, 0.2],
        };
        let cut = glass.cut(0.0, 0, FINE);
        let step = TAU / FINE as f64;
        assert!((cut.iter().sum::<f64>() * step - 1.0).abs() < 1e-4);
        // The rainbow of TRT at 18.62 degrees and of the next lobe at 95.30.
        let at = |degrees: f64| cut[((degrees + 180.0) as usize).min(FINE - 1)];
        assert!(at(18.3) > 2.0 * at(20.5) && at(18.3) > 1.2 * at(10.5));
        assert!(at(95.7) > 2.0 * at(93.5));
        // With absorption: 0.682760 of the light at 30 degrees.
        let sum = glass.cut(30f64.to_radians(), 1, FINE).iter().sum::<f64>() * step;
        assert!((sum - 0.682_760).abs() < 1e-3, "{sum}");
    }
}
