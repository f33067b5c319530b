//! The lobe as a surface about the fiber: distance from the origin is the square root of the
//! density in that direction.

use super::frame3d::View;
use super::text::Pen;
use super::{Area, FAINT, Field, INK, colormap};
use crate::image::Canvas;
use crate::math::frame;
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Steps of the mesh in inclination; twice as many in azimuth. Finer than the texels of a table of
/// 64, so that edges are the table's.
const STEPS: usize = 360;

/// Directions averaged for one corner of the mesh, along each axis: smooths the steps of texels.
const TAPS: i32 = 3;

/// Half the width of that average, radians: about a texel of a table of 64.
const BLUR: f64 = 0.012;

/// Part of the unit ball that the view shows: room for arrows and labels.
const REACH: f32 = 1.32;

const FIBER: Vec3 = Vec3::new(0.47, 0.40, 0.34);
const ARROW: Vec3 = Vec3::new(0.10, 0.45, 0.75);

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, field: &Field, gray: bool) {
    // Seen across the plane of incidence, a little from above and from the light's side.
    let mut view = View::new(area, Vec3::new(0.45, -1.0, 0.42), REACH);
    let title = area.min + glam::Vec2::new(2.0 * pen.line(), -0.4 * pen.line());
    pen.left(canvas, title, "lobe: distance = √(S cos θ)", INK);
    axes(canvas, pen, &mut view);
    fiber(canvas, &mut view);
    arrow(canvas, pen, &mut view, field.query);
    surface(canvas, &mut view, field, gray);
}

/// One corner of the mesh.
#[derive(Clone, Copy)]
struct Corner {
    position: Vec3,
    /// Density relative to the peak, 0..1.
    height: f32,
    tint: Vec3,
}

fn surface(canvas: &mut Canvas, view: &mut View, field: &Field, gray: bool) {
    let columns = 2 * STEPS;
    let corners: Vec<Corner> = (0..(STEPS + 1) * columns)
        .into_par_iter()
        .map(|i| {
            let theta = FRAC_PI_2 - PI * (i / columns) as f64 / STEPS as f64;
            let phi = TAU * (i % columns) as f64 / columns as f64;
            corner(field, theta, phi)
        })
        .collect();
    let at = |row: usize, column: usize| corners[row * columns + column % columns];
    for row in 0..STEPS {
        for column in 0..columns {
            let quad = [
                at(row, column),
                at(row + 1, column),
                at(row + 1, column + 1),
                at(row, column + 1),
            ];
            let normal = (quad[2].position - quad[0].position)
                .cross(quad[3].position - quad[1].position)
                .normalize_or_zero();
            let shade = shade(view.turn(normal));
            let color = |c: &Corner| {
                let base = if gray {
                    colormap::color(0.25 + 0.75 * c.height.sqrt())
                } else {
                    c.tint
                };
                (c.position, base * shade)
            };
            let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| color(&quad[k]));
            view.triangle(canvas, [a, b, c]);
            view.triangle(canvas, [a, c, d]);
        }
    }
}

fn corner(field: &Field, theta: f64, phi: f64) -> Corner {
    let w = frame::direction(theta, phi);
    let east = frame::direction(0.0, phi + FRAC_PI_2);
    let north = w.cross(east);
    let mut rgb = Vec3::ZERO;
    let tap = |i: i32| BLUR * f64::from(2 * i - (TAPS - 1)) / f64::from(TAPS - 1);
    for (i, j) in (0..TAPS).flat_map(|i| (0..TAPS).map(move |j| (i, j))) {
        rgb += field.rgb((w + tap(i) * east + tap(j) * north).normalize());
    }
    rgb /= (TAPS * TAPS) as f32;
    let height = (rgb.element_sum() / 3.0 / field.peak).min(1.0);
    let brightest = rgb.max_element().max(1e-12);
    // The hue of the light, at full strength: how bright it is the surface itself tells.
    let tint = (rgb / brightest).map(crate::color::srgb_from_linear);
    Corner {
        position: w.as_vec3() * height.sqrt(),
        height,
        tint: 0.12 + 0.88 * tint,
    }
}

/// Diffuse shading in view space: a key light from the upper left, a weak fill, both sides lit.
fn shade(normal: Vec3) -> f32 {
    let n = if normal.z < 0.0 { -normal } else { normal };
    let key = n.dot(Vec3::new(-0.45, 0.6, 0.66)).max(0.0);
    let fill = n.dot(Vec3::new(0.7, -0.2, 0.68)).max(0.0);
    0.28 + 0.62 * key + 0.16 * fill
}

/// The unit circle in the normal plane with marks every 30 degrees.
fn axes(canvas: &mut Canvas, pen: &Pen, view: &mut View) {
    let on = |phi: f64, r: f64| frame::direction(0.0, phi).as_vec3() * r as f32;
    for i in 0..180 {
        let phi = |i: i32| TAU * f64::from(i) / 180.0;
        view.line(
            canvas,
            on(phi(i), 1.0),
            on(phi(i + 1), 1.0),
            pen.hair(),
            FAINT,
        );
    }
    for k in 0..12 {
        let phi = TAU * f64::from(k) / 12.0;
        view.line(canvas, on(phi, 0.97), on(phi, 1.03), pen.hair(), FAINT);
        if k % 3 == 0 {
            let label = ["φ 0°", "90°", "180°", "-90°"][k as usize / 3];
            let at = view.project(on(phi, 1.17)).0;
            pen.center(
                canvas,
                at - glam::Vec2::new(0.0, 0.5 * pen.line()),
                label,
                FAINT,
            );
        }
    }
}

/// The fiber along z, thin, with an arrow head toward the tip.
fn fiber(canvas: &mut Canvas, view: &mut View) {
    let width = 0.022
        * view
            .project(Vec3::X)
            .0
            .distance(view.project(-Vec3::X).0)
            .max(200.0);
    view.line(canvas, Vec3::Z * -1.15, Vec3::Z * 1.15, width, FIBER);
    for i in 0..=20 {
        let f = i as f32 / 20.0;
        view.dot(canvas, Vec3::Z * (1.15 + 0.1 * f), width * (1.0 - f), FIBER);
    }
}

/// The query direction as an arrow that ends near the fiber.
fn arrow(canvas: &mut Canvas, pen: &Pen, view: &mut View, query: Vec3) {
    let width = 3.0 * pen.hair();
    let tail = 1.22 * query;
    view.line(canvas, tail, 0.12 * query, width, ARROW);
    for i in 0..=12 {
        let f = i as f32 / 12.0;
        view.dot(
            canvas,
            query * (0.05 + 0.1 * f),
            width * (0.3 + 1.6 * f),
            ARROW,
        );
    }
}
