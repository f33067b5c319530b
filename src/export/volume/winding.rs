//! How often a closed mesh winds around a voxel: which side of the skin it is on.
//!
//! Lines of voxels along z are cut with all triangles. Every crossing is decided by the signs of three
//! edge functions that neighboring triangles share to the bit, and a line through an edge or a corner
//! is moved aside by an amount smaller than any number, the same for all triangles. So crossings of a
//! closed mesh always cancel, wherever its vertices lie.

use glam::{DVec2, DVec3, IVec3};
use std::collections::HashMap;
use std::ops::Range;

/// Crossings of all lines of voxels with a mesh.
#[derive(Debug)]
pub(super) struct Winding {
    /// Height in voxels and change of the winding number, sorted along each line.
    crossings: Vec<(f64, i8)>,
    /// Crossings of the line at (x, y).
    lines: HashMap<(i32, i32), Range<u32>>,
}

impl Winding {
    /// * `triangles`: corners in voxels, counter-clockwise seen from outside.
    pub(super) fn new(triangles: &[[DVec3; 3]]) -> Self {
        let mut all: Vec<((i32, i32), f64, i8)> = Vec::new();
        for corners in triangles {
            cross(corners, |line, z, sign| all.push((line, z, sign)));
        }
        all.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut lines = HashMap::new();
        let mut start = 0;
        for line in all.chunk_by(|a, b| a.0 == b.0) {
            let end = start + line.len() as u32;
            lines.insert(line[0].0, start..end);
            start = end;
        }
        let crossings = all.into_iter().map(|(_, z, sign)| (z, sign)).collect();
        Self { crossings, lines }
    }

    /// Whether the voxel is inside.
    pub(super) fn is_inside(&self, voxel: IVec3) -> bool {
        let Some(range) = self.lines.get(&(voxel.x, voxel.y)) else {
            return false;
        };
        let line = &self.crossings[range.start as usize..range.end as usize];
        let below = line.iter().take_while(|(z, _)| *z < f64::from(voxel.z));
        below.map(|(_, sign)| i32::from(*sign)).sum::<i32>() > 0
    }

    /// Lines whose crossings do not cancel; none for a closed mesh.
    #[cfg(test)]
    pub(super) fn unbalanced(&self) -> usize {
        let sum = |r: &Range<u32>| {
            let line = &self.crossings[r.start as usize..r.end as usize];
            line.iter().map(|(_, sign)| i32::from(*sign)).sum::<i32>()
        };
        self.lines.values().filter(|r| sum(r) != 0).count()
    }
}

/// Crossings of the lines under a triangle: the line, the height and the change of the winding number
/// on the way up.
fn cross(corners: &[DVec3; 3], mut found: impl FnMut((i32, i32), f64, i8)) {
    let [a, b, c] = *corners;
    let flat = corners.map(DVec3::truncate);
    let lo = flat[0].min(flat[1]).min(flat[2]).ceil().as_ivec2();
    let hi = flat[0].max(flat[1]).max(flat[2]).floor().as_ivec2();
    for x in lo.x..=hi.x {
        for y in lo.y..=hi.y {
            let p = DVec2::new(f64::from(x), f64::from(y));
            let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| is_left(flat[i], flat[j], p));
            if sides[0] != sides[1] || sides[1] != sides[2] {
                continue;
            }
            // Twice the areas of the parts opposite to a, b and c.
            let part = |i: usize, j: usize| (flat[i] - p).perp_dot(flat[j] - p).abs();
            let weights = [part(1, 2), part(2, 0), part(0, 1)];
            let sum: f64 = weights.iter().sum();
            let z = if sum > 0.0 {
                (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / sum
            } else {
                (a.z + b.z + c.z) / 3.0
            };
            // A face that looks up is where the line leaves.
            found((x, y), z, if sides[0] { -1 } else { 1 });
        }
    }
}

/// Whether `p` is to the left of the way from `a` to `b`. For `b` to `a` it is the opposite, also on the
/// line itself, where `p` counts as moved by an infinitely small way upward and by an infinitely
/// smaller one to the left.
fn is_left(a: DVec2, b: DVec2, p: DVec2) -> bool {
    let swapped = (b.x, b.y) < (a.x, a.y);
    let (from, to) = if swapped { (b, a) } else { (a, b) };
    let left = (to - from).perp_dot(p - from) >= 0.0;
    left != swapped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box whose corners, edges and faces lie exactly on lines of voxels.
    fn cube(lo: DVec3, hi: DVec3) -> Vec<[DVec3; 3]> {
        let corner = |i: usize| {
            DVec3::new(
                [lo.x, hi.x][i & 1],
                [lo.y, hi.y][i >> 1 & 1],
                [lo.z, hi.z][i >> 2],
            )
        };
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        halves.map(|t| t.map(corner)).collect()
    }

    #[test]
    fn lines_through_edges_and_corners_are_crossed_once() {
        let mut mesh = cube(DVec3::splat(-3.0), DVec3::new(5.0, 4.0, 6.5));
        mesh.extend(cube(DVec3::ZERO, DVec3::splat(9.0)));
        let winding = Winding::new(&mesh);
        assert_eq!(winding.unbalanced(), 0);
        for x in -5..12 {
            for y in -5..12 {
                for z in -5..12 {
                    let p = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                    let within = |lo: DVec3, hi: DVec3, room: f64| {
                        p.cmpgt(lo - room).all() && p.cmplt(hi + room).all()
                    };
                    let either = |room| {
                        within(DVec3::splat(-3.0), DVec3::new(5.0, 4.0, 6.5), room)
                            || within(DVec3::ZERO, DVec3::splat(9.0), room)
                    };
                    let inside = winding.is_inside(IVec3::new(x, y, z));
                    // On the surface itself either answer will do.
                    assert!(inside || !either(-1e-9), "{p}");
                    assert!(!inside || either(1e-9), "{p}");
                }
            }
        }
        // Without a face that looks down.
        mesh.remove(0);
        assert!(Winding::new(&mesh).unbalanced() > 0);
    }
}
