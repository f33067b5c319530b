//! How far voids may reach in a section that is no ellipse: the section's own shape in the small,
//! waisted where it is, and nowhere nearer to the cuticle than keratin must be thick.
//!
//! Voids are unions of convex bodies, so what of a convex cell lies within the edge is cut to a convex
//! part of it: the edge point nearest to the cell's middle gives a half-plane, the nearest of those
//! left in the cell another, until none is left (after Deits and Tedrake 2015). Outward curves are
//! approached by chords, and a waist is cut off by one line.

use crate::fiber::convex::Plane;
use crate::fiber::scales::{Cell, Scales};
use crate::fiber::section::Section;
use crate::fiber::voronoi::Column;
use glam::DVec2;
use std::f64::consts::TAU;

/// The closed curve that voids may reach, counterclockwise, star-shaped about the axis.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Edge {
    /// Points at even angles of the unit-circle frame, micrometers.
    points: Vec<DVec2>,
}

/// A half-plane `normal . p <= offset`, seen from the middle of a cell.
pub(in crate::fiber) type HalfPlane = (DVec2, f64);

/// A convex part of what the edge holds.
#[derive(Clone, Debug)]
pub(in crate::fiber) struct Part {
    middle: DVec2,
    sides: Vec<HalfPlane>,
    /// Half-widths of a box about the axis that holds it.
    pub(in crate::fiber) half: DVec2,
}

/// Points of the edge: in hair of a hundred micrometers about one a micrometer.
const POINTS: usize = 360;
/// How far a cell may reach over the edge between chords, which are laid as much inside, micrometers;
/// as much for parts of the whole, which would have too many sides otherwise.
const TOLERANCE_UM: f64 = 0.03;
const TOLERANCE_OF_PARTS_UM: f64 = 0.15;
/// Chords of one cell at most: far more than there are.
const MOST_CHORDS: usize = 360;
/// Parts that what the edge holds is split into at most, and points by which they are found. A
/// dumb-bell needs three or five, a bent section some more.
const MOST_PARTS: usize = 12;
const PROBES: u32 = 2000;

/// Directions of the sides of a square.
const SQUARE: [DVec2; 4] = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];

impl Edge {
    /// * `ratio`: radius of the medulla over the section's.
    /// * `cortex_um`: least keratin between voids and cuticle.
    pub(super) fn new(section: &Section, scales: &Scales, ratio: f64, cortex_um: f64) -> Self {
        let axes = DVec2::new(section.a, section.b);
        let cuticle = lowest(scales, axes);
        let room = |p: DVec2| nearest(&cuticle, p).distance(p) >= cortex_um;
        let points = (0..POINTS).map(|i| {
            let psi = TAU * i as f64 / POINTS as f64;
            let out = axes * section.rho(psi) * DVec2::from_angle(psi);
            // The keratin outside thins steadily on the way out.
            let (mut inside, mut outside) = (0.0, ratio);
            if room(ratio * out) {
                inside = ratio;
            }
            while outside - inside > 1e-4 {
                let middle = 0.5 * (inside + outside);
                if room(middle * out) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside * out
        });
        Self {
            points: points.collect(),
        }
    }

    /// The curve.
    pub(super) fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Whether a point is inside.
    pub(super) fn holds(&self, p: DVec2) -> bool {
        let n = self.points.len();
        let crossed = (0..n).filter(|&i| {
            let (a, b) = (self.points[i], self.points[(i + 1) % n]);
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossed.count() % 2 == 1
    }

    /// Largest factor by which an ellipse of these semi-axes fits in.
    pub(super) fn inscribed(&self, axes: DVec2) -> f64 {
        let reach = self.points.iter().map(|p| (*p / axes).length());
        // Between two points the curve may come nearer by a chord's sagitta.
        0.999 * reach.fold(f64::INFINITY, f64::min)
    }

    /// Half-widths of a box about the axis.
    pub(super) fn half(&self) -> DVec2 {
        let reach = self.points.iter().map(|p| p.abs());
        reach.fold(DVec2::ZERO, DVec2::max)
    }

    /// Outward normal at a point of the curve.
    fn normal(&self, i: usize) -> DVec2 {
        let n = self.points.len();
        let along = self.points[(i + 1) % n] - self.points[(i + n - 1) % n];
        DVec2::new(along.y, -along.x).normalize_or_zero()
    }

    /// Half-planes that cut a convex cell to what the edge holds of it.
    ///
    /// * `sides`: of the cell, seen from `middle`.
    /// * `inset_um`: how far from the edge it must stay, and what it may be off.
    fn cut(
        &self,
        middle: DVec2,
        sides: &[HalfPlane],
        [inset_um, tolerance_um]: [f64; 2],
    ) -> Vec<HalfPlane> {
        let mut chords: Vec<HalfPlane> = Vec::new();
        let is_in = |p: DVec2, chords: &[HalfPlane]| {
            let all = sides.iter().chain(chords);
            all.into_iter()
                .all(|(normal, offset)| normal.dot(p) < offset - tolerance_um + inset_um)
        };
        while chords.len() < MOST_CHORDS {
            let left = (0..self.points.len()).map(|i| (i, self.points[i] - middle));
            let left = left.filter(|(_, p)| is_in(*p, &chords));
            let nearest = left.min_by(|a, b| a.1.length_squared().total_cmp(&b.1.length_squared()));
            let Some((i, p)) = nearest else { break };
            let normal = self.normal(i);
            // A curve that shows the cell its outside has no chord there.
            let normal = if normal.dot(p) > 0.0 {
                normal
            } else {
                p.normalize_or_zero()
            };
            chords.push((normal, normal.dot(p) - tolerance_um - inset_um));
        }
        chords
    }

    /// The sides along the hair that keep a column's cells inside.
    pub(super) fn planes(&self, column: &Column, inset_um: f64) -> Vec<Plane> {
        along_the_hair(self.cut(column.center, &column.edges, [inset_um, TOLERANCE_UM]))
    }

    /// As much for a body that lies within `reach` of a point.
    pub(super) fn box_planes(&self, center: DVec2, reach: f64) -> Vec<Plane> {
        let square = SQUARE.map(|side| (side, reach));
        along_the_hair(self.cut(center, &square, [0.0, TOLERANCE_UM]))
    }

    /// Convex parts that hold all that the edge does, but for corners between them. They overlap.
    pub(super) fn parts(&self) -> Vec<Part> {
        let half = self.half();
        let mut left: Vec<DVec2> = (0..PROBES)
            .map(|i| {
                let i = f64::from(i) + 0.5;
                let at = DVec2::new(0.754_877_666, 0.569_840_291) * i;
                half * (2.0 * at.fract() - 1.0)
            })
            .filter(|p| self.holds(*p))
            .collect();
        let all = left.len();
        let mut parts: Vec<Part> = Vec::new();
        while parts.len() < MOST_PARTS && left.len() * 200 > all {
            let deep = |p: &DVec2| nearest(&self.points, *p).distance_squared(*p);
            let Some(&middle) = left.iter().max_by(|p, q| deep(p).total_cmp(&deep(q))) else {
                break;
            };
            let around = SQUARE.map(|n| (n, n.dot(-middle) + n.abs().dot(half) + 1.0));
            let part = Part {
                sides: self.cut(middle, &around, [0.0, TOLERANCE_OF_PARTS_UM]),
                middle,
                half,
            };
            left.retain(|p| !part.holds(*p));
            parts.push(part);
        }
        parts
    }

    /// Nearest point of the curve, scaled, among those at about the angle of `p`.
    pub(in crate::fiber) fn near(&self, p: DVec2, axes: DVec2, scale: f64) -> DVec2 {
        const WINDOW: usize = 30;
        let n = self.points.len();
        let turn = (p.y / axes.y).atan2(p.x / axes.x) / TAU;
        let first = (turn.rem_euclid(1.0) * n as f64) as usize + n - WINDOW;
        let points: [DVec2; 2 * WINDOW] =
            std::array::from_fn(|k| scale * self.points[(first + k) % n]);
        let pairs = points.windows(2).map(|s| on_segment(s[0], s[1], p));
        let closer = |a: &DVec2, b: &DVec2| a.distance_squared(p).total_cmp(&b.distance_squared(p));
        pairs.min_by(closer).unwrap_or(points[WINDOW])
    }

    /// Radius of the curve at an angle of the unit-circle frame, as a point.
    pub(in crate::fiber) fn at(&self, psi: f64) -> DVec2 {
        let n = self.points.len();
        let x = (psi / TAU).rem_euclid(1.0) * n as f64;
        let (i, f) = (x as usize, x.fract());
        self.points[i % n].lerp(self.points[(i + 1) % n], f)
    }
}

impl Part {
    fn holds(&self, p: DVec2) -> bool {
        let p = p - self.middle;
        self.sides.iter().all(|(n, offset)| n.dot(p) <= *offset)
    }

    /// Its sides as planes along the hair, seen from a body's center.
    pub(in crate::fiber) fn planes(&self, center: DVec2) -> Vec<Plane> {
        let shift = self.middle - center;
        let plane = |&(normal, offset): &HalfPlane| Plane {
            normal: normal.extend(0.0),
            offset: offset + normal.dot(shift),
        };
        self.sides.iter().map(plane).collect()
    }
}

fn along_the_hair(sides: Vec<HalfPlane>) -> Vec<Plane> {
    let plane = |(normal, offset): HalfPlane| Plane {
        normal: normal.extend(0.0),
        offset,
    };
    sides.into_iter().map(plane).collect()
}

/// The lowest of the cuticle all round, micrometers.
fn lowest(scales: &Scales, axes: DVec2) -> Vec<DVec2> {
    let of = |sector: usize| {
        let strips = (0..scales.count(sector)).map(|strip| {
            let strip = *scales.strip(Cell {
                sector,
                strip,
                shift: 0.0,
            });
            let at = |z: f64| strip.height[0] + strip.slope[0] * z;
            at(strip.begin[0]).min(at(strip.end[0]))
        });
        let plane = scales.sectors[sector].planes[0];
        (1.0 + strips.fold(f64::INFINITY, f64::min)) * axes * DVec2::new(plane.cos, plane.sin)
    };
    (0..scales.sectors.len()).map(of).collect()
}

/// Nearest point of a closed curve.
fn nearest(curve: &[DVec2], p: DVec2) -> DVec2 {
    let n = curve.len();
    let on = (0..n).map(|i| on_segment(curve[i], curve[(i + 1) % n], p));
    let closer = |a: &DVec2, b: &DVec2| a.distance_squared(p).total_cmp(&b.distance_squared(p));
    on.min_by(closer).unwrap_or(DVec2::ZERO)
}

/// Nearest point of a segment.
fn on_segment(a: DVec2, b: DVec2, p: DVec2) -> DVec2 {
    let along = b - a;
    let share = (p - a).dot(along) / along.length_squared().max(1e-30);
    a + share.clamp(0.0, 1.0) * along
}
