//! Albedo over the inclination of the query direction.

use super::text::{Pen, degrees};
use super::{Area, CHANNELS, FAINT, INK, Plot};
use crate::image::Canvas;
use crate::table::{Mode, ScatterMaps};
use glam::Vec2;
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) fn draw(canvas: &mut Canvas, pen: &Pen, area: Area, maps: &ScatterMaps, plot: &Plot) {
    let line = pen.line();
    let frame = Area {
        min: area.min + Vec2::new(6.0 * line, 1.8 * line),
        max: area.max - Vec2::new(9.0 * line, 2.6 * line),
    };
    let title = Vec2::new(frame.min.x, area.min.y);
    pen.left(
        canvas,
        title,
        "albedo over the inclination of the query",
        INK,
    );
    let place = |theta: f64, albedo: f64| {
        let x = theta / PI + 0.5;
        frame.min + frame.size() * Vec2::new(x as f32, 1.0 - albedo as f32)
    };

    for k in 0..=2 {
        let albedo = f64::from(k) / 2.0;
        let (a, b) = (place(-FRAC_PI_2, albedo), place(FRAC_PI_2, albedo));
        canvas.line(a, b, 0.5 * pen.hair(), FAINT);
        let label = ["0", "0.5", "1"][k as usize];
        pen.right(canvas, a - Vec2::new(0.6 * line, 0.0), label, INK);
    }
    for k in -3..=3 {
        let theta = f64::from(k) * PI / 6.0;
        let foot = place(theta, 0.0);
        canvas.line(
            foot,
            foot - Vec2::new(0.0, 0.4 * line),
            0.5 * pen.hair(),
            FAINT,
        );
        let below = foot + Vec2::new(0.0, 0.9 * line);
        pen.center(canvas, below, &degrees(theta.to_degrees()), INK);
    }
    let here = plot.incidence_deg.to_radians();
    let (a, b) = (place(here, 0.0), place(here, 1.0));
    dashed(canvas, a, b, pen);

    let channels = if plot.gray { 1 } else { 3 };
    for (c, &ink) in CHANNELS.iter().enumerate().take(channels) {
        let color = if plot.gray { INK } else { ink };
        let points: Vec<Vec2> = curve(maps, c)
            .iter()
            .map(|&(theta, albedo)| place(theta, albedo.min(1.0)))
            .collect();
        canvas.polyline(&points, 2.0 * pen.hair(), color);
    }
}

/// Points of the curve: a line through the nodes in cone mode, steps over the bins in paper mode.
fn curve(maps: &ScatterMaps, channel: usize) -> Vec<(f64, f64)> {
    let nodes = &maps.nodes;
    let albedo = |node: usize| maps.albedo(node)[channel];
    match nodes.mode {
        Mode::Cone => {
            let last = nodes.len() - 1;
            let inner = (0..=last).map(|j| (nodes.centers[j], albedo(j)));
            std::iter::once((-FRAC_PI_2, albedo(0)))
                .chain(inner)
                .chain(std::iter::once((FRAC_PI_2, albedo(last))))
                .collect()
        }
        Mode::Paper => (0..nodes.len())
            .flat_map(|j| [(nodes.edges[j], albedo(j)), (nodes.edges[j + 1], albedo(j))])
            .collect(),
    }
}

fn dashed(canvas: &mut Canvas, a: Vec2, b: Vec2, pen: &Pen) {
    let dashes = 15;
    for i in (0..dashes).step_by(2) {
        let at = |i: i32| a.lerp(b, i as f32 / dashes as f32);
        canvas.line(at(i), at(i + 1), pen.hair(), FAINT);
    }
}
