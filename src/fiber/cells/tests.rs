//! Where a seam of two voids meets the outline.

use super::{Cell, Cells, Face, Neighbor, OUTLINE};
use crate::sampling::Rng;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Slices of air through an elliptic cylinder, one upon the other, their faces tilted.
fn slices(count: usize, semi: DVec2, thickness: f64) -> Cells {
    let normal = DVec3::new(0.04, -0.003, 1.0).normalize();
    let half = 0.5 * thickness * normal.z;
    let cells: Vec<Cell> = (0..count)
        .map(|k| {
            let beside = |up: bool| {
                let (next, turn) = match (up, k) {
                    (true, k) if k + 1 == count => (0, 1),
                    (true, k) => (k + 1, 0),
                    (false, 0) => (count - 1, -1),
                    (false, k) => (k - 1, 0),
                };
                vec![Neighbor::new(next, turn)]
            };
            Cell {
                center: DVec3::Z * (thickness * (k as f64 + 0.5)),
                faces: vec![
                    Face::new(normal, half, half, beside(true)),
                    Face::new(-normal, half, half, beside(false)),
                ],
                air: true,
                rim: true,
            }
        })
        .collect();
    Cells::new(&cells, semi, thickness * count as f64, thickness)
}

#[test]
fn a_ray_that_comes_in_at_a_seam_enters_by_the_outline() {
    let (semi, thickness) = (DVec2::new(30.0, 24.0), 7.0);
    let cells = slices(5, semi, thickness);
    let mut rng = Rng::new(3, 0);
    for _ in 0..100_000 {
        // A place where a seam meets the outline, missed by about what single precision errs.
        let azimuth = TAU * rng.uniform();
        let q = semi * DVec2::from_angle(azimuth);
        let z = thickness * (1.0 + (4.0 * rng.uniform()).floor()) - 0.04 * q.x + 0.003 * q.y;
        let near = q.extend(z + 4e-6 * (rng.uniform() - 0.5));
        let inward = (-near.truncate() / semi / semi).normalize();
        let dir = (inward.rotate(DVec2::from_angle(2.0 * (rng.uniform() - 0.5))))
            .extend(3.0 * (rng.uniform() - 0.5))
            .normalize();
        let (t, face) = cells
            .enter(near - 5.0 * dir, dir, 0.0, f64::INFINITY, None)
            .expect("there is nothing but air");
        // Along the seam a rounding error is a long way; the walk allows for so much.
        assert!((t - 5.0).abs() < 1e-3, "{t}");
        assert!(face & OUTLINE != 0, "entered by the seam at {near}");
    }
}
