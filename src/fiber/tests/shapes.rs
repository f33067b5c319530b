//! Closed forms: chords of the cylinder, volumes and chords of the medulla.

use super::super::medulla::Voids;
use super::super::{Fiber, Region};
use super::walk::launch;
use crate::math::frame::direction;
use crate::sampling::Rng;
use crate::species::MedullaKind;
use glam::DVec3;

#[test]
fn the_bare_cylinder_has_the_chords_of_a_cylinder() {
    let fiber = Fiber::build(&super::glass(), 0).unwrap();
    let r = 40.0;
    for i in 0..2000 {
        let mut rng = Rng::new(1, i);
        let theta = 1.5 * (2.0 * rng.uniform() - 1.0);
        let h = 2.0 * rng.uniform() - 1.0;
        let dir = direction(theta, 0.3);
        let side = direction(0.0, 0.3 + std::f64::consts::FRAC_PI_2);
        let origin = h * r * side - 5000.0 * dir + 1e4 * DVec3::Z;
        let first = fiber.next_hit(origin, dir, Region::Outside, None).unwrap();
        let p = origin + first.t * dir;
        let second = fiber
            .next_hit(p, dir, Region::Cortex, Some(first.state))
            .unwrap();
        let chord = 2.0 * r * (1.0 - h * h).sqrt() / theta.cos();
        assert!(
            (second.t - chord).abs() < 1e-9 * r / theta.cos(),
            "{h} {theta}"
        );
        // No inclination is lost: the normal is exactly across the axis.
        assert_eq!(first.normal.z, 0.0);
        assert_eq!(second.to, Region::Outside);
        let out = fiber.next_hit(p + second.t * dir, dir, Region::Outside, Some(second.state));
        assert!(out.is_none());
    }
}

#[test]
fn an_elliptic_cylinder_is_met_where_its_equation_holds() {
    let mut s = super::glass();
    s.aspect = 2.5;
    let fiber = Fiber::build(&s, 0).unwrap();
    let (a, b) = (40.0 * 2.5f64.sqrt(), 40.0 / 2.5f64.sqrt());
    for i in 0..500 {
        let (origin, dir) = launch(&fiber, &mut Rng::new(2, i));
        if let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) {
            let p = origin + hit.t * dir;
            assert!(((p.x / a).powi(2) + (p.y / b).powi(2) - 1.0).abs() < 1e-12);
            let n = DVec3::new(p.x / (a * a), p.y / (b * b), 0.0).normalize();
            assert!((n - hit.normal).length() < 1e-12);
        }
    }
}

#[test]
fn froth_holds_the_asked_share_of_air_and_keeps_its_distance() {
    for (seed, air) in [(1, 0.2), (2, 0.4), (3, 0.5)] {
        let mut s = super::bear_guard();
        s.medulla.kind = MedullaKind::Froth {
            radius_um: 4.0,
            radius_sigma: 0.4,
            air_fraction: air,
        };
        let fiber = Fiber::build(&s, seed).unwrap();
        let Voids::Froth(froth) = &fiber.medulla.voids else {
            panic!("no froth")
        };
        let (a, b) = (fiber.section.a, fiber.section.b);
        let medulla = std::f64::consts::PI * (s.medulla.ratio.powi(2)) * a * b * fiber.period_um();
        assert!((froth.volume() / medulla / air - 1.0).abs() < 0.02);
        for (i, p) in froth.spheres.iter().enumerate() {
            for q in &froth.spheres[i + 1..] {
                let mut d = p.center - q.center;
                d.z -= froth.period * (d.z / froth.period).round();
                assert!(d.length() > p.radius + q.radius);
            }
        }
        // Independent of the volume sum: points at random.
        let mut air_points = 0;
        let n = 40_000;
        for i in 0..n {
            let mut rng = Rng::new(9, i);
            let (x, y) = crate::sampling::concentric_disk(rng.uniform(), rng.uniform());
            let at = DVec3::new(a * x, b * y, 0.0) * s.medulla.ratio;
            let at = at + DVec3::Z * fiber.period_um() * rng.uniform();
            air_points += u32::from(fiber.region_at(at) == Region::Void);
        }
        let share = f64::from(air_points) / n as f64;
        assert!((share - air).abs() < 0.02 * air + 4.0 * (0.25 / n as f64).sqrt());
    }
}

/// Cauchy: lines uniform in a convex body have in any part of it a mean chord of `4 V / S`, with S all
/// of the part's boundary.
#[test]
fn chords_between_the_voids_follow_cauchy() {
    let mut s = super::bear_guard();
    s.aspect = 1.0;
    s.medulla.pigment = 2.0;
    let fiber = Fiber::build(&s, 4).unwrap();
    let Voids::Froth(froth) = &fiber.medulla.voids else {
        panic!("no froth")
    };
    let radius = s.medulla.ratio * fiber.section.a;
    let (pi, period) = (std::f64::consts::PI, fiber.period_um());
    let surface: f64 = froth
        .spheres
        .iter()
        .map(|p| 4.0 * pi * p.radius.powi(2))
        .sum();
    let volume = pi * radius * radius * period - froth.volume();
    let expected = 4.0 * volume / (surface + 2.0 * pi * radius * period);
    let (mut sum, mut count) = (0.0, 0u32);
    for path in 0..20_000 {
        let mut rng = Rng::new(21, path);
        // Uniform on the outline with a cosine law about its normal: uniform lines.
        let (u, v) = (rng.uniform(), std::f64::consts::TAU * rng.uniform());
        let turn = glam::DMat3::from_rotation_z(2.0 * pi * rng.uniform());
        let dir = DVec3::new(-(1.0 - u).sqrt(), u.sqrt() * v.cos(), u.sqrt() * v.sin());
        let dir = turn * dir;
        let at = turn * DVec3::new(radius, 0.0, period * rng.uniform());
        let mut p = at + dir * 1e-9;
        let (mut region, mut from) = (fiber.region_at(p), None);
        while region != Region::Outside {
            let hit = fiber.next_hit(p, dir, region, from).unwrap();
            if region == Region::Cortex {
                // The pigment of the walls is twice the cortex's: what exceeds t lies in the medulla.
                let chord = hit.pigment_um - hit.t;
                sum += chord;
                count += u32::from(chord > 0.0);
            }
            p += hit.t * dir;
            region = hit.to;
            from = Some(hit.state);
        }
    }
    let mean = sum / f64::from(count);
    assert!((mean / expected - 1.0).abs() < 0.03, "{mean} {expected}");
}

#[test]
fn rungs_never_touch_and_fill_what_they_say() {
    let fiber = Fiber::build(&super::fox_guard(), 5).unwrap();
    let Voids::Ladder(ladder) = &fiber.medulla.voids else {
        panic!("no ladder")
    };
    for pair in ladder.pucks.windows(2) {
        assert!(pair[0].center + pair[0].half + 0.1 < pair[1].center - pair[1].half);
    }
    let ratio = fiber.medulla.ratio;
    let (n, mut inside) = (60_000, 0u32);
    for i in 0..n {
        let mut rng = Rng::new(9, i);
        let (x, y) = crate::sampling::concentric_disk(rng.uniform(), rng.uniform());
        let at = DVec3::new(fiber.section.a * x, fiber.section.b * y, 0.0) * ratio;
        let at = at + DVec3::Z * fiber.period_um() * rng.uniform();
        inside += u32::from(fiber.region_at(at) == Region::Void);
    }
    let share = f64::from(inside) / n as f64;
    let expected = ladder.air_fraction(ratio);
    assert!((share - expected).abs() < 0.008, "{share} {expected}");
    assert!((0.5..0.75).contains(&expected), "{expected}");
}
