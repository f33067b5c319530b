//! How far a place in a section is from a surface at least: what spares rays in waisted fibers most marches.
//!
//! A ray from void to void in the bulge of a dumb-bell has to ask whether it leaves the fiber, and its medulla, on the way;
//! an ellipse answers in closed form. Here the way is covered by circles that are known to be clear.

use super::march::Side;
use super::scales::{Scales, Sector};
use super::section::UnitRay;
use glam::{DVec2, Vec2};
use std::f64::consts::FRAC_1_SQRT_2;

/// Cells along one side of the grid: with fewer many voids lie in cells too near the rim, with more building it costs
/// more milliseconds than it spares in a first table.
const SIDE: usize = 96;

/// Points on the surface between two of its lines.
const BETWEEN: usize = 2;

/// Circles that a way is covered with, at most: rays that graze are left to the march.
const MOST_CIRCLES: u32 = 12;

/// Cells within which a ray from the surface has to be clear of it, or it marches all the way.
const MOST_CELLS: u32 = 8;

/// Above the rounding of single precision.
const MARGIN: f32 = 1e-6;

/// Distances in the unit-circle frame from a grid over a surface to the shell between the least and the greatest radius that
/// it has anywhere along z.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    /// Half the width of the grid, and cells per unit.
    reach: f64,
    per_unit: f64,
    /// What every place in a cell is away from the shell at least, row by row: positive within it, negative beyond; 0 where
    /// some are in it.
    cells: Vec<f32>,
}

/// The least or the greatest radius of a surface over z, as points round the axis.
struct Contour {
    points: Vec<Vec2>,
    /// No place on the contour is farther from the nearest point.
    within: f32,
}

impl Clearance {
    pub(super) fn new(scales: &Scales) -> Self {
        let reach = scales.rho_max;
        let width = 2.0 * reach / SIDE as f64;
        let extremes = scales.extremes();
        let [least, greatest] = [0, 1].map(|which| Contour::new(scales, &extremes, which));
        let slack = (width * FRAC_1_SQRT_2) as f32 + MARGIN;
        let cells = (0..SIDE * SIDE).map(|i| {
            let center = |k: usize| (k as f64 + 0.5) * width - reach;
            let (x, y) = (center(i % SIDE), center(i / SIDE));
            let (rho, [low, high]) = (x.hypot(y), extremes_at(scales, &extremes, x, y));
            if rho < low {
                (least.distance(x, y) - slack).max(0.0)
            } else if rho > high {
                -(greatest.distance(x, y) - slack).max(0.0)
            } else {
                0.0
            }
        });
        Self {
            reach,
            per_unit: 1.0 / width,
            cells: cells.collect(),
        }
    }

    /// Positive within the surface by at least so much, negative beyond it, 0 if neither is known.
    #[inline(always)]
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        // Places beyond the grid are farther away than the nearest in it.
        let index = |v: f64| (((v + self.reach) * self.per_unit) as usize).min(SIDE - 1);
        f64::from(self.cells[index(y) * SIDE + index(x)])
    }

    /// By how much a ray at `t` is clear on a side; 0 or less if that is not known.
    #[inline(always)]
    fn along(&self, ray: &UnitRay, side: Side, t: f64) -> f64 {
        let clear = self.at(ray.x + t * ray.dx, ray.y + t * ray.dy);
        match side {
            Side::Inside => clear,
            Side::Outside => -clear,
        }
    }

    /// How far a ray is certain to keep to the side of the surface that it is on at `from`: farther than `to` if all that way.
    #[inline]
    pub(super) fn until(&self, ray: &UnitRay, side: Side, from: f64, to: f64) -> f64 {
        let per_unit = 1.0 / ray.a.sqrt();
        let mut at = from;
        for _ in 0..MOST_CIRCLES {
            let step = per_unit * self.along(ray, side, at);
            if step <= 0.0 {
                break;
            }
            at += step;
            if at > to {
                break;
            }
        }
        at
    }

    /// Up to where a ray that starts on the surface may meet it again, if it is certain not to from there to `to`.
    #[inline]
    pub(super) fn dive(&self, ray: &UnitRay, side: Side, to: f64) -> Option<f64> {
        let cell = 1.0 / (self.per_unit * ray.a.sqrt());
        let ways = (1..=MOST_CELLS).map(|k| f64::from(k) * cell);
        let is_clear = |&t: &f64| self.along(ray, side, t) > 0.0;
        let from = ways.take_while(|&t| t < to).find(is_clear)?;
        (self.until(ray, side, from, to) > to).then_some(from)
    }
}

/// The extremes in the direction of a place.
fn extremes_at(scales: &Scales, extremes: &[[f64; 2]], x: f64, y: f64) -> [f64; 2] {
    let sector = scales.sector(x, y);
    let u = scales.across(sector, x, y);
    let [begin, end] = [sector, scales.neighbor(sector, 1)].map(|line| extremes[line]);
    [0, 1].map(|which| begin[which] + u * (end[which] - begin[which]))
}

impl Contour {
    /// * `extremes`: see [`Scales::extremes`]; `which` of the two.
    fn new(scales: &Scales, extremes: &[[f64; 2]], which: usize) -> Self {
        let mut points = Vec::with_capacity(BETWEEN * extremes.len());
        let mut half: f64 = 0.0;
        for (i, Sector { planes: [p, q], .. }) in scales.sectors.iter().enumerate() {
            let [begin, end] = [i, scales.neighbor(i, 1)].map(|line| extremes[line][which]);
            let at = |k: usize| {
                let u = k as f64 / BETWEEN as f64;
                let (x, y) = (p.cos + u * (q.cos - p.cos), p.sin + u * (q.sin - p.sin));
                let scale = (begin + u * (end - begin)) / x.hypot(y);
                DVec2::new(scale * x, scale * y)
            };
            for (a, b) in (0..BETWEEN).map(|k| (at(k), at(k + 1))) {
                points.push((0.5 * (a + b)).as_vec2());
                half = half.max(0.5 * a.distance(b));
            }
        }
        // Between its ends a piece is bent: by half its square over twice the radius, which is 0.35 at least.
        let within = (half + 2.0 * half * half) as f32;
        Self { points, within }
    }

    /// Least distance of a place from the contour.
    fn distance(&self, x: f64, y: f64) -> f32 {
        let place = Vec2::new(x as f32, y as f32);
        let squares = self.points.iter().map(|p| p.distance_squared(place));
        squares.fold(f32::INFINITY, f32::min).sqrt() - self.within
    }
}
