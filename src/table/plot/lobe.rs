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
pub(super) const FINE: usize = 360;

/// The same for small pictures, where a step is a pixel or two.
pub(super) const COARSE: usize = 180;

/// Directions averaged for one corner of the mesh, along each axis.
const TAPS: i32 = 5;

/// Half the extent of the world that the view shows: the unit ball, arrows and labels.
const REACH: f32 = 1.25;

const FIBER: Vec3 = Vec3::new(0.78, 0.67, 0.56);
const ARROW: Vec3 = Vec3::new(0.25, 0.62, 0.98);

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, field: &Field, gray: bool) {
    let view = solid(canvas, pen, area, field, gray, FINE);
    let title = area.min + glam::Vec2::new(2.0 * pen.line(), -0.4 * pen.line());
    let caption = "lobe: distance is the root of S cos θ";
    pen.left(canvas, title, caption, INK);
    labels(canvas, pen, &view);
}

/// The lobe, fiber and query without letters.
pub(super) fn solid(
    canvas: &mut Canvas,
    pen: &Pen,
    area: Area,
    field: &Field,
    gray: bool,
    steps: usize,
) -> View {
    // Seen across the plane of incidence, a little from above and from the light's side.
    let mut view = View::new(area, Vec3::new(0.45, -1.0, 0.42), REACH);
    axes(canvas, pen, &mut view);
    let z = Vec3::Z;
    cone(canvas, &mut view, [-1.1 * z, 1.1 * z], [0.022; 2], FIBER);
    cone(canvas, &mut view, [1.1 * z, 1.22 * z], [0.045, 0.0], FIBER);
    // The query comes from outside the unit ball, so that no lobe hides it.
    let q = field.query;
    cone(canvas, &mut view, [1.3 * q, 1.1 * q], [0.012; 2], ARROW);
    cone(canvas, &mut view, [1.12 * q, 1.02 * q], [0.034, 0.0], ARROW);
    surface(canvas, &mut view, field, gray, steps);
    view
}

/// One corner of the mesh.
#[derive(Clone, Copy)]
struct Corner {
    position: Vec3,
    /// Density relative to the peak, 0..1.
    height: f32,
    tint: Vec3,
}

fn surface(canvas: &mut Canvas, view: &mut View, field: &Field, gray: bool, steps: usize) {
    let columns = 2 * steps;
    let corners: Vec<Corner> = (0..(steps + 1) * columns)
        .into_par_iter()
        .map(|i| {
            let theta = FRAC_PI_2 - PI * (i / columns) as f64 / steps as f64;
            let phi = TAU * (i % columns) as f64 / columns as f64;
            corner(field, theta, phi)
        })
        .collect();
    let at = |row: usize, column: usize| corners[row * columns + column % columns];
    for row in 0..steps {
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

/// Mean density about a direction: smooths the steps of texels and the noise of short bakes.
fn corner(field: &Field, theta: f64, phi: f64) -> Corner {
    let w = frame::direction(theta, phi);
    let east = frame::direction(0.0, phi + FRAC_PI_2);
    let north = w.cross(east);
    let mut rgb = Vec3::ZERO;
    let tap = |i: i32| field.blur * f64::from(2 * i - (TAPS - 1)) / f64::from(TAPS - 1);
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
    for i in 0..180 {
        let phi = |i: i32| TAU * f64::from(i) / 180.0;
        let (a, b) = (in_plane(phi(i), 1.0), in_plane(phi(i + 1), 1.0));
        view.line(canvas, a, b, pen.hair(), FAINT);
    }
    for k in 0..12 {
        let phi = TAU * f64::from(k) / 12.0;
        let (a, b) = (in_plane(phi, 0.97), in_plane(phi, 1.03));
        view.line(canvas, a, b, pen.hair(), FAINT);
    }
}

/// Azimuths at the circle, over everything else so that they can be read.
fn labels(canvas: &mut Canvas, pen: &Pen, view: &View) {
    for (k, label) in ["φ 0°", "90°", "180°", "-90°"].into_iter().enumerate() {
        let (at, _) = view.project(in_plane(FRAC_PI_2 * k as f64, 1.14));
        let above = at - glam::Vec2::new(0.0, 0.5 * pen.line());
        pen.center(canvas, above, label, INK);
    }
}

/// A point of the normal plane.
fn in_plane(phi: f64, radius: f64) -> Vec3 {
    (frame::direction(0.0, phi) * radius).as_vec3()
}

/// A shaded cone or tube from one end to the other, with its radii there.
fn cone(canvas: &mut Canvas, view: &mut View, ends: [Vec3; 2], radii: [f32; 2], color: Vec3) {
    const SIDES: usize = 24;
    let (x, y) = (ends[1] - ends[0]).normalize().any_orthonormal_pair();
    let rim = |end: usize, side: usize| {
        let angle = side as f32 / SIDES as f32 * std::f32::consts::TAU;
        let outward = angle.cos() * x + angle.sin() * y;
        let shaded = color * shade(view.turn(outward));
        (ends[end] + radii[end] * outward, shaded)
    };
    let mut triangles = Vec::with_capacity(3 * SIDES);
    for side in 0..SIDES {
        let [a, b] = [0, 1].map(|end| (rim(end, side), rim(end, side + 1)));
        triangles.push([a.0, a.1, b.1]);
        triangles.push([a.0, b.1, b.0]);
        // The wide end is closed by a disk.
        let dark = 0.5 * color;
        triangles.push([(ends[0], dark), (a.0.0, dark), (a.1.0, dark)]);
    }
    for triangle in triangles {
        view.triangle(canvas, triangle);
    }
}
