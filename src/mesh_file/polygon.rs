//! Polygons cut into triangles that stay inside, by ears (Meisters 1975, "Polygons have ears").

use glam::{DVec2, DVec3, Vec3};

/// Corners from which a fan has to do: cutting ears takes the square of them.
const MOST: usize = 4096;

/// Triangles of a polygon, by number of corner. Those of convex polygons are a fan from the first corner, and so are
/// those of what is no polygon: crossing itself, without area, of too many corners.
pub(super) fn triangles(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut ears = Vec::with_capacity(corners.len().saturating_sub(2));
    let flat = (3 < left.len() && left.len() <= MOST).then(|| flattened(corners));
    if let Some(flat) = flat.filter(|flat| (0..flat.len()).any(|i| bend(flat, &left, i) < 0.0)) {
        while left.len() > 3 {
            let Some(ear) = (0..left.len()).find(|&i| is_ear(&flat, &left, i)) else {
                break;
            };
            ears.push(around(&left, ear));
            left.remove(ear);
        }
    }
    ears.extend((2..left.len()).map(|i| [left[0], left[i - 1], left[i]]));
    ears
}

/// Seen from the side from which they turn to the left, by Newell's normal.
fn flattened(corners: &[Vec3]) -> Vec<DVec2> {
    let points: Vec<DVec3> = corners
        .iter()
        .map(|p| (*p - corners[0]).as_dvec3())
        .collect();
    let normal: DVec3 = (0..points.len())
        .map(|i| points[i].cross(points[(i + 1) % points.len()]))
        .sum();
    let (x, y) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
    points
        .iter()
        .map(|p| DVec2::new(p.dot(x), p.dot(y)))
        .collect()
}

/// A corner with those before and after it.
fn around(left: &[usize], i: usize) -> [usize; 3] {
    let n = left.len();
    [left[(i + n - 1) % n], left[i], left[(i + 1) % n]]
}

/// Positive where the border turns to the left at a corner, as it does at all of a convex one.
fn bend(flat: &[DVec2], left: &[usize], i: usize) -> f64 {
    let [a, b, c] = around(left, i).map(|k| flat[k]);
    (b - a).perp_dot(c - b)
}

/// Whether a corner can be cut off: no other one lies in its triangle.
fn is_ear(flat: &[DVec2], left: &[usize], i: usize) -> bool {
    let [a, b, c] = around(left, i).map(|k| flat[k]);
    let is_inside = |p: DVec2| {
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
        p != a && p != b && p != c && sides.iter().all(|side| *side >= 0.0)
    };
    bend(flat, left, i) > 0.0 && !left.iter().any(|&k| is_inside(flat[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> (f32, f32) {
        let crosses = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| corners[i]);
            0.5 * (b - a).cross(c - a)
        });
        let (sum, all) = crosses.fold((Vec3::ZERO, 0.0), |(sum, all), cross| {
            (sum + cross, all + cross.length())
        });
        (sum.length(), all)
    }

    /// Triangles that overlap, or lie outside, have more area than the polygon.
    fn assert_inside(corners: &[Vec3]) {
        let triangles = triangles(corners);
        assert_eq!(triangles.len(), corners.len() - 2);
        let (polygon, all) = area(corners, &triangles);
        assert!((all / polygon - 1.0).abs() < 1e-4, "{all} {polygon}");
        let mut uses = vec![0; corners.len()];
        triangles.as_flattened().iter().for_each(|&i| uses[i] += 1);
        assert!(uses.iter().all(|&n| n > 0), "{uses:?}");
    }

    #[test]
    fn concave_polygons_are_not_left() {
        let flat = |points: &[(f32, f32)]| -> Vec<Vec3> {
            points.iter().map(|&(x, y)| Vec3::new(x, 2.0, y)).collect()
        };
        let dart = flat(&[(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)]);
        let l = flat(&[
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ]);
        let star: Vec<Vec3> = (0..10)
            .map(|i| {
                let (sin, cos) = (i as f32 / 10.0 * std::f32::consts::TAU).sin_cos();
                let r = if i % 2 == 0 { 1.0 } else { 0.3 };
                Vec3::new(r * cos, 0.5 * r * cos, r * sin)
            })
            .collect();
        for polygon in [dart, l, star] {
            for first in 0..polygon.len() {
                let mut turned = polygon.clone();
                turned.rotate_left(first);
                assert_inside(&turned);
                turned.reverse();
                assert_inside(&turned);
            }
        }
    }

    #[test]
    fn any_star_shaped_polygon_is_cut() {
        let mut rng = Rng::new(3, 0);
        for n in 4..60 {
            let corner = |i| {
                let (sin, cos) = (i as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
                let r = 0.1 + rng.uniform_f32();
                Vec3::new(r * cos, r * sin, 0.0)
            };
            assert_inside(&(0..n).map(corner).collect::<Vec<_>>());
        }
    }

    #[test]
    fn what_is_convex_or_no_polygon_is_a_fan() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        assert_eq!(triangles(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(&square[..3]), [[0, 1, 2]]);
        assert_eq!(triangles(&[Vec3::ONE; 5]).len(), 3);
        let bow = [Vec3::ZERO, Vec3::X + Vec3::Y, Vec3::X, Vec3::Y];
        assert_eq!(triangles(&bow).len(), 2);
        assert_eq!(triangles(&[Vec3::NAN; 4]).len(), 2);
        assert!(triangles(&square[..2]).is_empty());
    }
}
