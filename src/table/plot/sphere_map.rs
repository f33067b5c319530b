//! The full sphere of directions, azimuth across and inclination up: a density on a logarithmic color
//! scale, or the difference of two on a linear one.

use super::text::{Pen, degrees};
use super::{Area, FAINT, Field, INK, PAPER, colormap};
use crate::image::Canvas;
use crate::math::frame;
use crate::math::unicube::Unicube;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Decades of the color scale below the peak: what falls below a ten-thousandth is black.
const DECADES: f32 = 4.0;

/// What a map shows.
pub(super) enum MapStyle<'a> {
    /// `S cos(theta)`, logarithmic from the peak down.
    Density(&'a Field<'a>),
    /// A difference, linear about zero.
    Difference(&'a Difference<'a>),
}

/// The difference of two densities in shares of the peak of the second.
pub(super) struct Difference<'a> {
    judged: &'a Field<'a>,
    reference: &'a Field<'a>,
    /// Share at the ends of the color scale.
    range: f32,
}

impl<'a> Difference<'a> {
    pub(super) fn new(judged: &'a Field<'a>, reference: &'a Field<'a>) -> Self {
        let mut all = Self {
            judged,
            reference,
            range: 1.0,
        };
        let cube = Unicube::new(reference.table.res());
        let mut sizes: Vec<f32> = (0..cube.texels())
            .into_par_iter()
            .map(|texel| all.at(cube.direction(texel, 0.5, 0.5).0).abs())
            .collect();
        sizes.sort_by(f32::total_cmp);
        // All but a thousandth of the directions fit; the next of 1, 2, 5, 10, ...
        let most = sizes[sizes.len() - 1 - sizes.len() / 1000].max(1e-4);
        let decade = 10f32.powf(most.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
        let fits = |range: &f32| *range >= most * 0.999;
        all.range = steps.into_iter().find(fits).unwrap_or(most);
        all
    }

    /// In shares of the peak.
    fn at(&self, w: DVec3) -> f32 {
        (self.judged.gray(w) - self.reference.gray(w)) / self.reference.peak
    }
}

impl MapStyle<'_> {
    fn color(&self, w: DVec3) -> Vec3 {
        match self {
            Self::Density(field) => {
                colormap::color(1.0 + (field.gray(w) / field.peak).log10() / DECADES)
            }
            Self::Difference(difference) => {
                colormap::diverging(difference.at(w) / difference.range)
            }
        }
    }

    fn field(&self) -> &Field<'_> {
        match self {
            Self::Density(field) => field,
            Self::Difference(difference) => difference.reference,
        }
    }

    /// Grid lines over the map: light on densities, so that they show on dark and bright.
    fn grid(&self) -> Vec3 {
        match self {
            Self::Density(_) => Vec3::ONE,
            Self::Difference(_) => Vec3::splat(0.25),
        }
    }
}

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, style: &MapStyle<'_>, title: &str) {
    let line = pen.line();
    let bar_width = 1.5 * line;
    let plot = Area {
        min: area.min + Vec2::new(6.0 * line, 1.5 * line),
        max: area.max - Vec2::new(bar_width + 7.5 * line, 3.5 * line),
    };
    let at = Vec2::new(plot.min.x, area.min.y - 0.4 * line);
    pen.left(canvas, at, title, INK);
    fill(canvas, plot, style);
    grid(canvas, pen, plot, style);
    let bar = Area {
        min: Vec2::new(plot.max.x + line, plot.min.y),
        max: Vec2::new(plot.max.x + line + bar_width, plot.max.y),
    };
    match style {
        MapStyle::Density(field) => color_bar(canvas, pen, bar, field.peak),
        MapStyle::Difference(difference) => difference_bar(canvas, pen, bar, difference.range),
    }
}

/// Place of a direction: azimuth -180..180 across, inclination 90..-90 down.
fn place(plot: Area, theta: f64, phi: f64) -> Vec2 {
    let x = (phi + PI) / TAU;
    let y = 0.5 - theta / PI;
    plot.min + plot.size() * Vec2::new(x as f32, y as f32)
}

fn fill(canvas: &mut Canvas, plot: Area, style: &MapStyle<'_>) {
    let (x0, y0) = (plot.min.x.round() as usize, plot.min.y.round() as usize);
    let (x1, y1) = (plot.max.x.round() as usize, plot.max.y.round() as usize);
    let (width, height) = ((x1 - x0) as f64, (y1 - y0) as f64);
    let rows: Vec<Vec<Vec3>> = (y0..y1)
        .into_par_iter()
        .map(|y| {
            let theta = FRAC_PI_2 - PI * ((y - y0) as f64 + 0.5) / height;
            (x0..x1)
                .map(|x| {
                    let phi = TAU * ((x - x0) as f64 + 0.5) / width - PI;
                    style.color(frame::direction(theta, phi))
                })
                .collect()
        })
        .collect();
    for (y, row) in rows.iter().enumerate() {
        for (x, color) in row.iter().enumerate() {
            canvas.set(x0 + x, y0 + y, *color);
        }
    }
}

fn grid(canvas: &mut Canvas, pen: &Pen, plot: Area, style: &MapStyle<'_>) {
    let (field, ink) = (style.field(), style.grid());
    let line = pen.line();
    for k in -3..=3 {
        let theta = f64::from(k) * PI / 6.0;
        let (a, b) = (place(plot, theta, -PI), place(plot, theta, PI));
        thin(canvas, a, b, (ink, 0.18), pen.hair());
        pen.right(
            canvas,
            a - Vec2::new(0.6 * line, 0.0),
            &degrees(theta.to_degrees()),
            INK,
        );
    }
    for k in -6..=6 {
        let phi = f64::from(k) * PI / 6.0;
        let (a, b) = (place(plot, FRAC_PI_2, phi), place(plot, -FRAC_PI_2, phi));
        thin(canvas, a, b, (ink, 0.18), pen.hair());
        if k % 3 == 0 {
            let below = b + Vec2::new(0.0, 0.9 * line);
            pen.center(canvas, below, &degrees(phi.to_degrees()), INK);
        }
    }
    let below = place(plot, -FRAC_PI_2, 0.0) + Vec2::new(0.0, 2.2 * line);
    pen.center(
        canvas,
        below,
        "azimuth φ (0° back to the light, 180° through)",
        FAINT,
    );
    let name = Vec2::new(
        plot.min.x - 6.0 * line,
        plot.min.y + 0.25 * plot.size().y - 0.5 * line,
    );
    pen.left(canvas, name, "θ", INK);
    let tip = Vec2::new(plot.min.x - 6.0 * line, plot.min.y + 1.2 * line);
    pen.left(canvas, tip, "tip", FAINT);
    let root = Vec2::new(plot.min.x - 6.0 * line, plot.max.y - 2.2 * line);
    pen.left(canvas, root, "root", FAINT);

    // The specular cone and the query direction.
    let dashes = 90;
    for i in (0..dashes).step_by(2) {
        let phi = |i: i32| TAU * f64::from(i) / f64::from(dashes) - PI;
        let (a, b) = (
            place(plot, -field.theta, phi(i)),
            place(plot, -field.theta, phi(i + 1)),
        );
        thin(canvas, a, b, (ink, 0.55), pen.hair());
    }
    let center = place(plot, field.theta, 0.0);
    ring(canvas, center, 0.55 * line, 1.5 * pen.hair(), ink);
}

/// A translucent line, horizontal or vertical.
fn thin(canvas: &mut Canvas, a: Vec2, b: Vec2, (ink, opacity): (Vec3, f32), width: f32) {
    let (lo, hi) = (a.min(b) - 0.5 * width, a.max(b) + 0.5 * width);
    for y in lo.y.round() as i64..(hi.y.round() as i64).max(lo.y.round() as i64 + 1) {
        for x in lo.x.round() as i64..(hi.x.round() as i64).max(lo.x.round() as i64 + 1) {
            canvas.blend(x, y, ink, opacity);
        }
    }
}

fn ring(canvas: &mut Canvas, center: Vec2, radius: f32, width: f32, color: Vec3) {
    let points: Vec<Vec2> = (0..=32)
        .map(|i| center + radius * Vec2::from_angle(i as f32 / 32.0 * std::f32::consts::TAU))
        .collect();
    canvas.polyline(&points, width, color);
}

fn color_bar(canvas: &mut Canvas, pen: &Pen, bar: Area, peak: f32) {
    let height = bar.size().y;
    let rows = height.round() as usize;
    for i in 0..rows {
        let y = bar.min.y.round() + i as f32;
        let value = 1.0 - (i as f32 + 0.5) / rows as f32;
        let (min, max) = (Vec2::new(bar.min.x, y), Vec2::new(bar.max.x, y + 1.0));
        canvas.fill_rect(min, max, colormap::color(value));
    }
    // A mark at every whole power of ten, and one at the top.
    let top = peak.log10();
    let mut exponent = top.floor();
    while exponent > top - DECADES {
        let y = bar.min.y + height * (top - exponent) / DECADES;
        let (a, b) = (
            Vec2::new(bar.max.x - 0.3 * bar.size().x, y),
            Vec2::new(bar.max.x, y),
        );
        canvas.line(a, b, pen.hair(), PAPER);
        let at = Vec2::new(bar.max.x + 0.5 * pen.line(), y - 0.5 * pen.line());
        pen.left(canvas, at, &power_of_ten(exponent as i32), INK);
        exponent -= 1.0;
    }
}

/// Shares from plus the range at the top to minus the range.
fn difference_bar(canvas: &mut Canvas, pen: &Pen, bar: Area, range: f32) {
    let height = bar.size().y;
    let rows = height.round() as usize;
    for i in 0..rows {
        let y = bar.min.y.round() + i as f32;
        let value = 1.0 - 2.0 * (i as f32 + 0.5) / rows as f32;
        let (min, max) = (Vec2::new(bar.min.x, y), Vec2::new(bar.max.x, y + 1.0));
        canvas.fill_rect(min, max, colormap::diverging(value));
    }
    for step in -2..=2 {
        let share = 0.5 * step as f32;
        let y = bar.min.y + 0.5 * height * (1.0 - share);
        let percent = (100.0 * share * range * 1e4).round() / 1e4;
        let sign = if step > 0 { "+" } else { "" };
        let at = Vec2::new(bar.max.x + 0.5 * pen.line(), y - 0.5 * pen.line());
        pen.left(canvas, at, &format!("{sign}{percent}%"), INK);
    }
}

/// `100`, `0.01`, or in between what is short.
pub(super) fn power_of_ten(exponent: i32) -> String {
    match exponent {
        -4..=3 => format!("{}", 10f64.powi(exponent)),
        _ => format!("1e{exponent}"),
    }
}
