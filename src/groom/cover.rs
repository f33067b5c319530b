//! How much a coat covers in a picture, and how wide a thinner one must be to cover as much.
//!
//! Points are spread over pictures of the coat from some sides. Each notes, for every thinner coat, by how
//! much its hairs must be widened until one of them covers the point: the distance from the middle of the
//! nearest hair over half its width. So one walk over the hairs gives the covered share for any width.

use super::Groom;
use crate::sampling::Rng;
use crate::skin::Skin;
use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Points along the edge of a picture.
const EDGE: usize = 112;
/// Pictures from the height of the skin's own view, turned about the vertical axis.
const TURNS: usize = 3;
/// Hairs are never widened by more than this times what is missing of them.
const MOST: f32 = 1.5;

/// Factors on the widths of a part of a coat, by which it covers as much as all of it: for each part one a
/// class. Rows without hair of a class have 1.
///
/// * `groom`: sorted by class, then by rank, as [`super::grow`] makes it.
/// * `parts`: strands kept of each class, those of lowest rank.
pub(crate) fn widenings(groom: &Groom, skin: &Skin, parts: &[Vec<usize>]) -> Vec<Vec<f32>> {
    let mut counts = vec![0usize; groom.classes.len()];
    for &class in &groom.class {
        counts[usize::from(class)] += 1;
    }
    // What is missing of a class: its area is kept by hairs that much wider.
    let missing: Vec<Vec<f32>> = (parts.iter())
        .map(|kept| {
            let each = kept.iter().zip(&counts);
            each.map(|(&k, &n)| n as f32 / k.max(1) as f32).collect()
        })
        .collect();
    let views: Vec<Picture> = (0..=TURNS)
        .map(|turn| Picture::of(groom, skin, parts, &missing, turn))
        .collect();
    let covered = views.iter().flat_map(|view| &view.covered);
    let covered = covered.filter(|covered| **covered).count();
    (0..parts.len())
        .map(|part| {
            let all = views.iter().flat_map(|view| &view.needed[part]);
            let mut needed: Vec<f32> = all.copied().collect();
            // As many points as all hairs cover are covered at this width.
            let factor = match covered.checked_sub(1) {
                Some(last) => *needed.select_nth_unstable_by(last, f32::total_cmp).1,
                None => 1.0,
            };
            let factor = factor.min(MOST);
            missing[part]
                .iter()
                .map(|m| (m * factor).max(1.0))
                .collect()
        })
        .collect()
}

/// What is known of each point of a picture.
#[derive(Clone)]
struct Picture {
    /// Whether a hair of the whole coat covers it.
    covered: Vec<bool>,
    /// For each part of the coat: factor on what is missing at which a hair of it covers the point.
    needed: Vec<Vec<f32>>,
}

/// Where the points of a picture are, one in each cell of a grid.
struct Grid {
    lo: Vec2,
    cell: Vec2,
    /// Cells in a meter.
    inverse: Vec2,
    /// To the right, up and toward the viewer, unit.
    axes: [Vec3; 3],
    points: Vec<Vec2>,
    /// How near the skin comes at each point.
    skin: Vec<f32>,
}

impl Grid {
    /// Where a point of space is in the picture, and how near.
    fn project(&self, p: Vec3) -> (Vec2, f32) {
        let [right, up, near] = self.axes.map(|axis| p.dot(axis));
        (Vec2::new(right, up), near)
    }

    /// Cells of a row or column between two places; the first, if they lie before it.
    fn cells(&self, axis: usize, from: f32, to: f32) -> std::ops::Range<usize> {
        // Casts round down and end at 0.
        let cell = |x: f32| ((x - self.lo[axis]) * self.inverse[axis]) as usize;
        let end = cell(to).saturating_add(1).min(EDGE);
        cell(from).min(end)..end
    }
}

impl Picture {
    fn of(
        groom: &Groom,
        skin: &Skin,
        parts: &[Vec<usize>],
        missing: &[Vec<f32>],
        turn: usize,
    ) -> Self {
        let grid = Grid::around(groom, skin, turn);
        let starts: Vec<usize> = (0..groom.classes.len())
            .map(|class| groom.class.partition_point(|&c| usize::from(c) < class))
            .collect();
        let empty = Self {
            covered: vec![false; grid.points.len()],
            needed: vec![vec![f32::INFINITY; grid.points.len()]; parts.len()],
        };
        let seen = (0..groom.strands())
            .into_par_iter()
            .with_min_len(1 << 14)
            .fold(
                || (empty.clone(), Vec::new(), Vec::new()),
                |(mut seen, mut projected, mut reach), strand| {
                    let class = usize::from(groom.class[strand]);
                    let place = strand - starts[class];
                    let within = (0..parts.len()).filter(|&part| place < parts[part][class]);
                    reach.clear();
                    reach.extend(within.map(|part| (part, missing[part][class])));
                    projected.clear();
                    projected.extend(groom.strand(strand).iter().map(|p| grid.project(*p)));
                    let widths = &groom.widths[groom.range(strand)];
                    seen.add(&projected, widths, &reach, &grid);
                    (seen, projected, reach)
                },
            )
            .map(|(seen, ..)| seen)
            .reduce_with(|mut a, b| {
                for (a, b) in a.covered.iter_mut().zip(b.covered) {
                    *a |= b;
                }
                let parts = a.needed.iter_mut().zip(b.needed);
                for (a, b) in parts.flat_map(|(a, b)| a.iter_mut().zip(b)) {
                    *a = a.min(b);
                }
                a
            });
        seen.unwrap_or(empty)
    }

    /// Notes what one strand covers.
    ///
    /// * `strand`: its control points in the picture, and how near they are. * `widths`: its diameters.
    /// * `parts`: which parts of the coat have it, and what is missing of its class in each.
    fn add(&mut self, strand: &[(Vec2, f32)], widths: &[f32], parts: &[(usize, f32)], grid: &Grid) {
        let widest = parts
            .iter()
            .fold(1.0f32, |most, part| most.max(MOST * part.1));
        for (ends, widths) in strand.windows(2).zip(widths.windows(2)) {
            let [(a, near_a), (b, near_b)] = [ends[0], ends[1]];
            let (half_a, half_b) = (0.5 * widths[0], 0.5 * widths[1]);
            let (way, reach) = (b - a, widest * half_a.max(half_b));
            let inverse = way.length_squared().max(f32::MIN_POSITIVE).recip();
            for row in grid.cells(1, a.y.min(b.y) - reach, a.y.max(b.y) + reach) {
                // Where the piece is that can reach into this row.
                let bottom = grid.lo.y + row as f32 * grid.cell.y - reach - a.y;
                let ends = [bottom, bottom + grid.cell.y + 2.0 * reach];
                let [t0, t1] = if way.y == 0.0 {
                    [0.0, 1.0]
                } else {
                    ends.map(|end| (end / way.y).clamp(0.0, 1.0))
                };
                let (x0, x1) = (a.x + t0 * way.x, a.x + t1 * way.x);
                for column in grid.cells(0, x0.min(x1) - reach, x0.max(x1) + reach) {
                    let point = row * EDGE + column;
                    if parts.is_empty() && self.covered[point] {
                        continue;
                    }
                    let at = grid.points[point];
                    let t = ((at - a).dot(way) * inverse).clamp(0.0, 1.0);
                    if near_a + t * (near_b - near_a) < grid.skin[point] {
                        continue;
                    }
                    let half = half_a + t * (half_b - half_a);
                    let off = at.distance(a + t * way) / half.max(f32::MIN_POSITIVE);
                    self.covered[point] |= off <= 1.0;
                    for &(part, missing) in parts {
                        let needed = &mut self.needed[part][point];
                        *needed = needed.min(off / missing);
                    }
                }
            }
        }
    }
}

impl Grid {
    /// A grid around a coat, seen from one of the sides.
    fn around(groom: &Groom, skin: &Skin, turn: usize) -> Self {
        // From around, and once from above.
        let near = if turn < TURNS {
            Quat::from_rotation_y(TAU * turn as f32 / TURNS as f32) * skin.view
        } else {
            Vec3::Y
        };
        let near = near.normalize_or(Vec3::Z);
        let right = Vec3::Y.cross(near).normalize_or(Vec3::X);
        let axes = [right, near.cross(right), near];
        let flat = |p: &Vec3| Vec2::new(p.dot(axes[0]), p.dot(axes[1]));
        let (lo, hi) = (groom.points.par_iter().map(flat).map(|p| (p, p))).reduce(
            || (Vec2::INFINITY, Vec2::NEG_INFINITY),
            |a, b| (a.0.min(b.0), a.1.max(b.1)),
        );
        let cell = ((hi - lo) / EDGE as f32).max(Vec2::splat(f32::MIN_POSITIVE));
        let points = (0..EDGE * EDGE).map(|i| {
            let mut rng = Rng::new(turn as u64, i as u64);
            let within = Vec2::new(rng.uniform_f32(), rng.uniform_f32());
            let corner = Vec2::new((i % EDGE) as f32, (i / EDGE) as f32);
            lo + (corner + within) * cell
        });
        let mut grid = Self {
            lo,
            cell,
            inverse: cell.recip(),
            axes,
            points: points.collect(),
            skin: vec![f32::NEG_INFINITY; EDGE * EDGE],
        };
        grid.hide_behind(skin);
        grid
    }

    /// Notes how near the skin comes at each point.
    fn hide_behind(&mut self, skin: &Skin) {
        for triangle in 0..skin.triangles.len() {
            let [(a, za), (b, zb), (c, zc)] = skin.corners(triangle).map(|p| self.project(p));
            let doubled = (b - a).perp_dot(c - a);
            if doubled == 0.0 {
                continue;
            }
            let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
            for row in self.cells(1, lo.y, hi.y) {
                for column in self.cells(0, lo.x, hi.x) {
                    let point = row * EDGE + column;
                    let at = self.points[point];
                    let u = (at - a).perp_dot(c - a) / doubled;
                    let v = (b - a).perp_dot(at - a) / doubled;
                    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                        let near = za + u * (zb - za) + v * (zc - za);
                        self.skin[point] = self.skin[point].max(near);
                    }
                }
            }
        }
    }
}
