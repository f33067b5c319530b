//! The full sphere of directions, azimuth across and inclination up, on a logarithmic color scale.

use super::text::{Pen, degrees};
use super::{Area, FAINT, Field, INK, PAPER, colormap};
use crate::image::Canvas;
use crate::math::frame;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Decades of the color scale below the peak: what falls below a ten-thousandth is black.
const DECADES: f32 = 4.0;

/// Grid lines over the map: light, so that they show on dark and bright.
const GRID: Vec3 = Vec3::new(1.0, 1.0, 1.0);

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, field: &Field) {
    let line = pen.line();
    let bar_width = 1.5 * line;
    let plot = Area {
        min: area.min + Vec2::new(6.0 * line, 1.5 * line),
        max: area.max - Vec2::new(bar_width + 7.5 * line, 3.5 * line),
    };
    pen.left(
        canvas,
        Vec2::new(plot.min.x, area.min.y - 0.4 * line),
        "S cos θ per steradian over all directions",
        INK,
    );
    fill(canvas, plot, field);
    grid(canvas, pen, plot, field);
    let bar = Area {
        min: Vec2::new(plot.max.x + line, plot.min.y),
        max: Vec2::new(plot.max.x + line + bar_width, plot.max.y),
    };
    color_bar(canvas, pen, bar, field.peak);
}

/// Place of a direction: azimuth -180..180 across, inclination 90..-90 down.
fn place(plot: Area, theta: f64, phi: f64) -> Vec2 {
    let x = (phi + PI) / TAU;
    let y = 0.5 - theta / PI;
    plot.min + plot.size() * Vec2::new(x as f32, y as f32)
}

fn fill(canvas: &mut Canvas, plot: Area, field: &Field) {
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
                    let density = field.gray(frame::direction(theta, phi));
                    colormap::color(1.0 + (density / field.peak).log10() / DECADES)
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

fn grid(canvas: &mut Canvas, pen: &Pen, plot: Area, field: &Field) {
    let line = pen.line();
    for k in -3..=3 {
        let theta = f64::from(k) * PI / 6.0;
        let (a, b) = (place(plot, theta, -PI), place(plot, theta, PI));
        thin(canvas, a, b, 0.18, pen.hair());
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
        thin(canvas, a, b, 0.18, pen.hair());
        if k % 3 == 0 {
            let below = b + Vec2::new(0.0, 0.6 * line);
            pen.center(canvas, below, &degrees(phi.to_degrees()), INK);
        }
    }
    let below = place(plot, -FRAC_PI_2, 0.0) + Vec2::new(0.0, 2.0 * line);
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
        thin(canvas, a, b, 0.55, pen.hair());
    }
    let center = place(plot, field.theta, 0.0);
    ring(canvas, center, 0.55 * line, 1.5 * pen.hair(), Vec3::ONE);
}

/// A translucent line, horizontal or vertical.
fn thin(canvas: &mut Canvas, a: Vec2, b: Vec2, opacity: f32, width: f32) {
    let (lo, hi) = (a.min(b) - 0.5 * width, a.max(b) + 0.5 * width);
    for y in lo.y.round() as i64..(hi.y.round() as i64).max(lo.y.round() as i64 + 1) {
        for x in lo.x.round() as i64..(hi.x.round() as i64).max(lo.x.round() as i64 + 1) {
            canvas.blend(x, y, GRID, opacity);
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

/// `100`, `0.01`, or in between what is short.
fn power_of_ten(exponent: i32) -> String {
    match exponent {
        -4..=3 => format!("{}", 10f64.powi(exponent)),
        _ => format!("1e{exponent}"),
    }
}
