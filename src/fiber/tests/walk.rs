//! Rays bounce at random through every fiber; the region that the hits tell must be the one that the
//! shapes tell.

use super::super::{Fiber, HitState, Region};
use crate::math::frame::direction;
use crate::sampling::Rng;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A ray toward the fiber from a sphere of directions, uniform over the projected bounding cylinder.
pub(super) fn launch(fiber: &Fiber, rng: &mut Rng) -> (DVec3, DVec3) {
    let theta = (2.0 * rng.uniform() - 1.0).asin();
    let phi = TAU * rng.uniform();
    let dir = -direction(theta, phi);
    let r = fiber.bounding_radius_um();
    let side = DVec3::new(-phi.sin(), phi.cos(), 0.0) * r * (2.0 * rng.uniform() - 1.0);
    let z = DVec3::Z * fiber.period_um() * rng.uniform();
    let back = 3.0 * r / theta.cos().max(1e-3);
    (side + z - back * dir, dir)
}

fn cosine_about(normal: DVec3, rng: &mut Rng) -> DVec3 {
    let (u, v) = (rng.uniform(), TAU * rng.uniform());
    let (x, y) = normal.any_orthonormal_pair();
    let r = u.sqrt();
    (r * v.cos() * x + r * v.sin() * y + (1.0 - u).sqrt() * normal).normalize()
}

pub(super) struct Tally {
    pub(super) segments: u64,
    pub(super) lost: u64,
    pub(super) wrong_between: u64,
    pub(super) wrong_sides: u64,
    escaped: u64,
}

pub(super) fn walk(fiber: &Fiber, paths: u64, seed: u64) -> Tally {
    let mut tally = Tally {
        segments: 0,
        lost: 0,
        wrong_between: 0,
        wrong_sides: 0,
        escaped: 0,
    };
    for path in 0..paths {
        let mut rng = Rng::new(seed, path);
        let (mut p, mut dir) = launch(fiber, &mut rng);
        let mut region = Region::Outside;
        let mut from: Option<HitState> = None;
        for _ in 0..200 {
            let Some(hit) = fiber.next_hit(p, dir, region, from) else {
                if region == Region::Outside {
                    tally.escaped += 1;
                } else {
                    tally.lost += 1;
                    eprintln!("lost in {region:?} at {p} along {dir} from {from:?}");
                }
                break;
            };
            tally.segments += 1;
            assert!(hit.t >= 0.0 && hit.t.is_finite(), "{hit:?}");
            assert!((hit.normal.length() - 1.0).abs() < 1e-9, "{hit:?}");
            assert!(hit.normal.dot(dir) <= 1e-12, "{hit:?} {dir}");
            let end = p + hit.t * dir;
            // Points nearer to a boundary than rounding allows to tell are no evidence.
            if hit.t > 1e-4 && fiber.region_at(p + 0.5 * hit.t * dir) != region {
                tally.wrong_between += 1;
            }
            // Above what a grazing hit is off.
            let step = 1e-6;
            if hit.normal.dot(dir) < -1e-2
                && (fiber.region_at(end + step * hit.normal) != region
                    || fiber.region_at(end - step * hit.normal) != hit.to)
            {
                tally.wrong_sides += 1;
            }
            let reflect = rng.uniform() < 0.35;
            dir = cosine_about(if reflect { hit.normal } else { -hit.normal }, &mut rng);
            if !reflect {
                region = hit.to;
            }
            p = end;
            from = Some(hit.state);
        }
    }
    tally
}

#[test]
fn regions_agree_with_the_shapes_and_no_ray_is_lost() {
    let mut segments = 0;
    for (name, fiber) in super::all() {
        let tally = walk(&fiber, 30_000, 3);
        segments += tally.segments;
        eprintln!(
            "{name}: {} segments, {} lost, {} wrong between, {} wrong sides, {} escaped",
            tally.segments, tally.lost, tally.wrong_between, tally.wrong_sides, tally.escaped
        );
        assert!(tally.segments > 30_000, "{name}");
        assert_eq!(tally.lost, 0, "{name}");
        // The midpoint of a grazing hop may be nearer to the surface than rounding tells.
        assert!(
            tally.wrong_between as f64 <= 1e-6 * tally.segments as f64,
            "{name}"
        );
        // Beside an edge the point on the other side is beyond the neighboring element.
        assert!(
            tally.wrong_sides as f64 <= 1e-5 * tally.segments as f64 + 2.0,
            "{name}"
        );
    }
    assert!(segments > 1_000_000, "{segments}");
}

#[test]
fn a_straight_line_crosses_an_even_number_of_boundaries() {
    for (name, fiber) in super::all() {
        for path in 0..20_000 {
            let mut rng = Rng::new(11, path);
            let (mut p, dir) = launch(&fiber, &mut rng);
            let (mut region, mut from, mut count) = (Region::Outside, None, 0);
            while let Some(hit) = fiber.next_hit(p, dir, region, from) {
                p += hit.t * dir;
                region = hit.to;
                from = Some(hit.state);
                count += 1;
                assert!(count < 100_000, "{name}");
            }
            assert_eq!(region, Region::Outside, "{name}, path {path}");
            assert_eq!(count % 2, 0, "{name}, path {path}");
        }
    }
}

#[test]
fn hard_directions_neither_hang_nor_leak() {
    for (name, fiber) in super::all() {
        let r = fiber.bounding_radius_um();
        for path in 0..2000 {
            let mut rng = Rng::new(5, path);
            // Along the axis, across it exactly, through the axis, through corners of the grid.
            let tilt = 10f64.powf(-9.0 * rng.uniform());
            let phi = 0.25 * PI * f64::from(rng.bits() % 8);
            let dir = match path % 4 {
                0 => direction(0.5 * PI - tilt, phi),
                1 => direction(0.0, phi),
                2 => direction(-0.5 * PI + tilt, phi),
                _ => direction(tilt, phi + tilt),
            };
            let z = 1e6 * (rng.uniform() - 0.5);
            let target = DVec3::new(0.0, 0.0, z)
                + r * rng.uniform() * direction(0.0, phi + 1.0) * f64::from(rng.bits() % 2);
            let (mut p, mut region, mut from) = (
                target - 3.0 * r * dir / tilt.min(dir.x.hypot(dir.y)),
                Region::Outside,
                None,
            );
            let mut left = 2000;
            while left > 0 {
                left -= 1;
                let Some(hit) = fiber.next_hit(p, dir, region, from) else {
                    break;
                };
                assert!(
                    hit.t.is_finite() && hit.normal.is_finite(),
                    "{name} {path} {region:?} {p} {dir} {hit:?} {from:?}"
                );
                p += hit.t * dir;
                region = hit.to;
                from = Some(hit.state);
            }
            // Rays near the axis meet more boundaries than there is time for.
            // Lifted scales and waists make the shell so thick that such a ray crosses decimeters of cells in it.
            let is_thick = name == "worn bear" || !fiber.section.is_ellipse();
            let steepest = if is_thick { 1e-3 } else { 1e-9 };
            if left > 0 && dir.x.hypot(dir.y) > steepest {
                assert_eq!(
                    region,
                    Region::Outside,
                    "{name}, path {path}, {dir} {p} {from:?}"
                );
            }
        }
    }
}
