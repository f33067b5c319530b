//! The scaled surface as triangles without a gap.
//!
//! A strip's surface is linear in z and nearly so in u: quadrilaterals between columns of equal u.
//! Where the surfaces of two strips cross at their common end, the riser between them changes sides
//! and a column of its own is put there. On the half plane between two sectors both may have strips
//! that the other does not, of no length there: radial edges on it stop at every point that either has.

use super::Weld;
use crate::fiber::scales::{Cell, Scales, at};
use glam::DVec3;

/// Points of a half plane nearer than this in z are at the end of the same strip, micrometers.
const SAME_Z: f64 = 1e-7;
/// Heights nearer than this are equal, in units of the radius: below what single precision tells
/// apart.
const SAME_HEIGHT: f64 = 1e-8;

/// The surface of one period in the unit-circle frame, faces and risers.
///
/// * `round`: flat pieces once round.
pub(super) fn tessellate(scales: &Scales, round: usize) -> [Weld; 2] {
    let mut parts = [Weld::new("cuticle"), Weld::new("riser")];
    let steps = round.div_ceil(scales.sectors.len());
    let stops: Vec<Stops> = (0..scales.sectors.len())
        .map(|line| Stops::new(scales, line))
        .collect();
    for sector in 0..scales.sectors.len() {
        let columns = columns(scales, sector, steps);
        for pair in columns.windows(2) {
            let lines = [
                (pair[0] == 0.0).then(|| &stops[sector]),
                (pair[1] == 1.0).then(|| &stops[scales.neighbor(sector, 1)]),
            ];
            column(scales, sector, [pair[0], pair[1]], lines, &mut parts);
        }
    }
    parts
}

/// Values of u between which the sector is flat.
fn columns(scales: &Scales, sector: usize, steps: usize) -> Vec<f64> {
    let mut columns: Vec<f64> = (0..=steps).map(|i| i as f64 / steps as f64).collect();
    for strip in 0..scales.count(sector) {
        // The difference of heights at the common end is a quadratic in u.
        let [d0, dm, d1] = [0.0, 0.5, 1.0].map(|u| {
            let [p, q] = ends(scales, sector, strip, u);
            q.height - p.height
        });
        let (a, b, c) = (2.0 * (d0 - 2.0 * dm + d1), 4.0 * dm - 3.0 * d0 - d1, d0);
        for u in roots(a, b, c) {
            if columns.iter().all(|known| (known - u).abs() > 1e-6) {
                columns.push(u);
            }
        }
    }
    columns.sort_by(f64::total_cmp);
    columns
}

/// Roots of `a x^2 + b x + c` within 0..1, simple ones.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let root = b * b - 4.0 * a * c;
    if root <= 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (b + root.sqrt().copysign(b));
    [q / a, c / q]
        .into_iter()
        .filter(|x| *x > 0.0 && *x < 1.0)
        .collect()
}

/// A place of the surface at given u.
#[derive(Clone, Copy)]
struct End {
    z: f64,
    height: f64,
}

/// The upper end of a strip and the lower end of the next one, at the same z.
fn ends(scales: &Scales, sector: usize, strip: usize, u: f64) -> [End; 2] {
    let of = |strip: usize| {
        scales.strip(Cell {
            sector,
            strip,
            shift: 0.0,
        })
    };
    let (strip, next) = (of(strip), (strip + 1) % scales.count(sector));
    let z = at(strip.end, u);
    // The next strip is counted from its own period.
    let below = if next == 0 { scales.period } else { 0.0 };
    let height = strip.height_at(u, z);
    let mut above = of(next).height_at(u, z - below);
    if (above - height).abs() < SAME_HEIGHT {
        above = height;
    }
    [End { z, height }, End { z, height: above }]
}

/// One column of a sector.
fn column(
    scales: &Scales,
    sector: usize,
    u: [f64; 2],
    lines: [Option<&Stops>; 2],
    [faces, risers]: &mut [Weld; 2],
) {
    let [begin, end] = scales.sectors[sector].planes;
    let direction = u.map(|u| {
        let d = DVec3::new(
            begin.cos + u * (end.cos - begin.cos),
            begin.sin + u * (end.sin - begin.sin),
            0.0,
        );
        // The half planes themselves are as they are, to the bit.
        if u == 0.0 {
            DVec3::new(begin.cos, begin.sin, 0.0)
        } else if u == 1.0 {
            DVec3::new(end.cos, end.sin, 0.0)
        } else {
            d.normalize()
        }
    });
    let point = |side: usize, height: f64, z: f64| (1.0 + height) * direction[side] + z * DVec3::Z;
    let count = scales.count(sector);
    let at_end = |strip: usize| u.map(|u| ends(scales, sector, strip, u));
    let mut below = at_end(count - 1);
    let mut shift = -scales.period;
    for strip in 0..count {
        let above = at_end(strip);
        let lower = |side: usize| {
            let e = below[side][1];
            point(side, e.height, e.z + shift)
        };
        let upper = |side: usize| {
            let e = above[side][0];
            point(side, e.height, e.z)
        };
        faces.polygon(&[lower(0), lower(1), upper(1), upper(0)]);
        riser(&above, lines, &point, risers);
        below = above;
        shift = 0.0;
    }
}

/// The wall between the upper end of a strip and the next one.
fn riser(
    ends: &[[End; 2]; 2],
    lines: [Option<&Stops>; 2],
    point: &impl Fn(usize, f64, f64) -> DVec3,
    risers: &mut Weld,
) {
    // Heights on the way up or down each side, its ends included.
    let side = |side: usize| {
        let [from, to] = ends[side];
        let mut heights = vec![from.height];
        if let Some(stops) = lines[side] {
            heights.extend(stops.between(from.z, from.height, to.height));
        }
        heights.push(to.height);
        heights
            .into_iter()
            .map(|h| point(side, h, from.z))
            .collect::<Vec<_>>()
    };
    let (left, right) = (side(0), side(1));
    // Triangles between the two rows, the longer one stepped on first.
    let (mut i, mut j) = (0, 0);
    while i + 1 < left.len() || j + 1 < right.len() {
        let share = |k: usize, row: &[DVec3]| (k + 1) as f64 / (row.len() - 1) as f64;
        if j + 1 < right.len() && (i + 1 >= left.len() || share(j, &right) <= share(i, &left)) {
            risers.polygon(&[left[i], right[j], right[j + 1]]);
            j += 1;
        } else {
            risers.polygon(&[left[i], right[j], left[i + 1]]);
            i += 1;
        }
    }
}

/// All heights at which strips of the two sectors beside a half plane end on it.
struct Stops {
    period: f64,
    /// Ascending in z, then height; z within the period.
    points: Vec<(f64, f64)>,
}

impl Stops {
    fn new(scales: &Scales, line: usize) -> Self {
        let mut points = Vec::new();
        for (sector, u) in [(line, 0.0), (scales.neighbor(line, 0), 1.0)] {
            for strip in 0..scales.count(sector) {
                for end in ends(scales, sector, strip, u) {
                    let z = end.z.rem_euclid(scales.period);
                    // What is next to the period's end is next to its beginning.
                    let z = if scales.period - z < SAME_Z {
                        z - scales.period
                    } else {
                        z
                    };
                    points.push((z, end.height));
                }
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Self {
            period: scales.period,
            points,
        }
    }

    /// The heights at `z` strictly between two heights, in their order.
    fn between(&self, z: f64, from: f64, to: f64) -> Vec<f64> {
        let z = z.rem_euclid(self.period);
        let z = if self.period - z < SAME_Z {
            z - self.period
        } else {
            z
        };
        let first = self.points.partition_point(|p| p.0 < z - SAME_Z);
        let near = self.points[first..]
            .iter()
            .take_while(|p| p.0 <= z + SAME_Z);
        let inside = |h: &f64| (h - from.min(to)) > SAME_HEIGHT && (from.max(to) - h) > SAME_HEIGHT;
        let mut heights: Vec<f64> = near.map(|p| p.1).filter(inside).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| (*a - *b).abs() <= SAME_HEIGHT);
        if from > to {
            heights.reverse();
        }
        heights
    }
}
