//! Voronoi cells: columns across the medulla, and polyhedra in it.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A column: the polygon round its center, cut by those of its neighbors.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub(super) center: DVec2,
    /// Toward each neighbor: unit normal and distance of the edge from the center.
    pub(super) edges: Vec<(DVec2, f64)>,
    /// Half-widths of a box about the center that holds it.
    pub(super) half: DVec2,
}

/// Rounds of moving points to the middle of their cells (Lloyd 1982). After about fifteen the cells
/// are as equal as they get to the eye.
const ROUNDS: usize = 15;
/// Corners of the polygon that stands for the outline.
const OUTLINE: u32 = 48;

/// The polygon that stands for an ellipse.
pub(super) fn ellipse(semi: DVec2) -> Vec<DVec2> {
    (0..OUTLINE)
        .map(|k| semi * DVec2::from_angle(TAU * f64::from(k) / f64::from(OUTLINE)))
        .collect()
}

/// Area of a polygon.
pub(super) fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let sum: f64 = corners.iter().zip(next).map(|(p, q)| p.perp_dot(*q)).sum();
    0.5 * sum
}

/// Splits what a star-shaped polygon about the axis holds into `count` columns of about equal size.
/// The same numbers give the same columns.
pub(super) fn columns(count: usize, outline: &[DVec2]) -> Vec<Column> {
    // A sunflower (Vogel 1979), then relaxed.
    let mut points: Vec<DVec2> = (0..count)
        .map(|i| {
            let r = ((i as f64 + 0.5) / count as f64).sqrt();
            let turn = (i as f64 * 0.381_966_011_250_105).fract() * outline.len() as f64;
            let (k, f) = (turn as usize, turn.fract());
            r * outline[k].lerp(outline[(k + 1) % outline.len()], f)
        })
        .collect();
    for _ in 0..ROUNDS {
        points = (0..count)
            .into_par_iter()
            .with_min_len(16)
            .map(|i| centroid(&polygon(&points, i, outline).0))
            .collect();
    }
    (0..count)
        .map(|i| {
            let (corners, neighbors) = polygon(&points, i, outline);
            let center = points[i];
            let edges = neighbors.into_iter().map(|j| {
                let apart = points[j] - center;
                (apart.normalize(), 0.5 * apart.length())
            });
            Column {
                center,
                edges: edges.collect(),
                half: corners
                    .iter()
                    .fold(DVec2::ZERO, |h, &c| h.max((c - center).abs())),
            }
        })
        .collect()
}

/// The cell of a point in the outline and the neighbors that bound it.
fn polygon(points: &[DVec2], index: usize, outline: &[DVec2]) -> (Vec<DVec2>, Vec<usize>) {
    let center = points[index];
    let mut corners = outline.to_vec();
    let mut others: Vec<usize> = (0..points.len()).filter(|&j| j != index).collect();
    others.sort_by(|&i, &j| {
        let (a, b) = (points[i], points[j]);
        a.distance_squared(center)
            .total_cmp(&b.distance_squared(center))
    });
    for &j in &others {
        let far = corners
            .iter()
            .fold(0.0f64, |f, c| f.max(c.distance_squared(center)));
        if points[j].distance_squared(center) > 4.0 * far {
            break;
        }
        corners = clip(&corners, points[j] - center, 0.5 * (points[j] + center));
    }
    // Those whose edge is still there.
    others.retain(|&j| {
        let (normal, middle) = (points[j] - center, 0.5 * (points[j] + center));
        let tolerance = 1e-9 * normal.length_squared();
        corners
            .iter()
            .filter(|&&c| normal.dot(c - middle) > -tolerance)
            .count()
            >= 2
    });
    (corners, others)
}

/// The part of a convex polygon behind the line through `on` across `normal`.
fn clip(corners: &[DVec2], normal: DVec2, on: DVec2) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (k, &p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        let (a, b) = (normal.dot(p - on), normal.dot(q - on));
        if a <= 0.0 {
            kept.push(p);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            kept.push(p + (q - p) * (a / (a - b)));
        }
    }
    kept
}

fn centroid(corners: &[DVec2]) -> DVec2 {
    let Some(&first) = corners.first() else {
        return DVec2::ZERO;
    };
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for pair in corners.windows(2) {
        let double = (pair[0] - first).perp_dot(pair[1] - first);
        sum += double * (first + pair[0] + pair[1]) / 3.0;
        area += double;
    }
    if area > 0.0 { sum / area } else { first }
}

/// A convex polyhedron as its faces: outward unit normal, distance from the origin, corners in order.
#[derive(Clone, Debug)]
pub(super) struct Polyhedron {
    pub(super) faces: Vec<PolyFace>,
}

/// A face of a polyhedron.
#[derive(Clone, Debug)]
pub(super) struct PolyFace {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) corners: Vec<DVec3>,
    /// The neighbor that cut it; `None` for a face of the cuboid.
    pub(super) neighbor: Option<usize>,
}

impl Polyhedron {
    /// A box about the origin.
    pub(super) fn cuboid(half: DVec3) -> Self {
        let faces = (0..6).map(|k| {
            let (axis, sign) = (k / 2, if k % 2 == 0 { 1.0 } else { -1.0 });
            let mut normal = DVec3::ZERO;
            normal[axis] = sign;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| {
                let mut c = normal * half[axis];
                c[u] = a * half[u];
                c[v] = b * half[v];
                c
            });
            PolyFace {
                normal,
                offset: half[axis],
                corners: corners.to_vec(),
                neighbor: None,
            }
        });
        Self {
            faces: faces.collect(),
        }
    }

    /// Cuts away what lies beyond `normal . p = offset`, where a neighbor begins.
    pub(super) fn clip(&mut self, normal: DVec3, offset: f64, neighbor: usize) {
        let beyond = |p: DVec3| normal.dot(p) - offset;
        if self.corners().all(|p| beyond(p) <= 0.0) {
            return;
        }
        let mut rim: Vec<DVec3> = Vec::new();
        for face in &mut self.faces {
            let old = std::mem::take(&mut face.corners);
            for (k, &p) in old.iter().enumerate() {
                let q = old[(k + 1) % old.len()];
                let (a, b) = (beyond(p), beyond(q));
                if a <= 0.0 {
                    face.corners.push(p);
                }
                if (a <= 0.0) != (b <= 0.0) {
                    let cut = p + (q - p) * (a / (a - b));
                    face.corners.push(cut);
                    rim.push(cut);
                }
            }
        }
        self.faces.retain(|f| f.corners.len() >= 3);
        if rim.len() < 3 {
            return;
        }
        let middle = rim.iter().sum::<DVec3>() / rim.len() as f64;
        let (u, v) = normal.any_orthonormal_pair();
        let angle = |p: DVec3| ((p - middle).dot(v).atan2((p - middle).dot(u)), p);
        let mut turned: Vec<(f64, DVec3)> = rim.iter().map(|&p| angle(p)).collect();
        turned.sort_by(|p, q| p.0.total_cmp(&q.0));
        rim.clear();
        rim.extend(turned.iter().map(|(_, p)| p));
        self.faces.push(PolyFace {
            normal,
            offset,
            corners: rim,
            neighbor: Some(neighbor),
        });
    }

    /// All corners, each as often as faces meet there.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.faces.iter().flat_map(|f| f.corners.iter().copied())
    }

    /// Square of the distance of the farthest corner from the origin.
    pub(super) fn reach2(&self) -> f64 {
        self.corners().fold(0.0, |r, p| r.max(p.length_squared()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(p: &Polyhedron) -> f64 {
        let face = |f: &PolyFace| {
            let fan = f.corners.windows(2).skip(1);
            fan.map(|w| f.corners[0].dot(w[0].cross(w[1])).abs() / 6.0)
                .sum::<f64>()
        };
        p.faces.iter().map(face).sum()
    }

    #[test]
    fn the_cell_of_a_body_centered_lattice_is_the_truncated_octahedron() {
        let mut p = Polyhedron::cuboid(DVec3::splat(2.0));
        for i in -1..=1 {
            for j in -1..=1 {
                for k in -1..=1 {
                    let whole = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
                    for at in [whole, whole + 0.5] {
                        if at != DVec3::ZERO {
                            p.clip(at.normalize(), 0.5 * at.length(), 0);
                        }
                    }
                }
            }
        }
        // Half a cube to a point; 14 faces; farthest corner at sqrt(5) / 4.
        assert!((volume(&p) - 0.5).abs() < 1e-12);
        assert_eq!(p.faces.len(), 14);
        assert!((p.reach2() - 5.0 / 16.0).abs() < 1e-12);
    }

    #[test]
    fn columns_share_the_ellipse_evenly() {
        let semi = DVec2::new(30.0, 20.0);
        let columns = columns(24, &ellipse(semi));
        let even = std::f64::consts::PI * semi.x * semi.y / 24.0;
        for c in &columns {
            // The inscribed circle of a hexagon of the same area has a radius of 0.537 roots of it.
            let least = c.edges.iter().fold(f64::INFINITY, |d, e| d.min(e.1));
            assert!(least > 0.4 * even.sqrt() && least < 0.6 * even.sqrt());
            assert!((c.center / semi).length() < 1.0);
        }
    }
}
