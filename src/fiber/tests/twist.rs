//! Twisted fibers: their normals against the closed form, their screw symmetry, rays through them.

use super::super::{Fiber, HitState, Region};
use super::walk::{launch, walk};
use super::{fox_guard, glass, mouse_guard, rabbit_guard, structure};
use crate::sampling::Rng;
use crate::species::{MedullaKind, Section, Structure};
use glam::DVec3;
use std::f64::consts::TAU;

fn twisted(mut structure: Structure, turns_per_cm: f64) -> Fiber {
    structure.twist_turns_per_cm = turns_per_cm;
    Fiber::build(&structure, 4).unwrap()
}

fn oval() -> Structure {
    Structure {
        aspect: 2.0,
        ..glass()
    }
}

/// Hare and fox guards, a bent one, a bare oval, right- and left-handed.
fn fibers() -> Vec<(&'static str, Fiber)> {
    let hare = MedullaKind::Multiserial {
        cell_um: 12.5,
        pitch_um: 10.0,
        septum_um: 1.5,
    };
    let hare = Structure {
        section: Section::DumbBell,
        ..structure(90.0, 2.2, ("irregular-wave", 9.0, 0.5, 4), (0.8, hare))
    };
    vec![
        ("oval", twisted(oval(), 2.0)),
        ("hare", twisted(hare, 2.0)),
        ("fox", twisted(fox_guard(), 1.0)),
        ("rabbit", twisted(rabbit_guard(), -2.0)),
        ("mouse", twisted(mouse_guard(), 20.0)),
    ]
}

fn turned(v: DVec3, angle: f64) -> DVec3 {
    DVec3::new(
        v.x * angle.cos() - v.y * angle.sin(),
        v.x * angle.sin() + v.y * angle.cos(),
        v.z,
    )
}

/// The surface is `f(R(-tau z) (x, y)) = 1`, f the ellipse's form: its gradient has the part
/// `tau (y f_x - x f_y)` along z, which no straight oval has, and whose sign is the hand's.
#[test]
fn normals_are_those_of_a_twisted_oval() {
    for turns in [2.0, -5.0] {
        let fiber = twisted(oval(), turns);
        let tau = TAU * turns * 1e-4;
        let [a, b] = fiber.section.half_extents();
        let (mut worst, mut together, mut alone) = (0.0f64, 0.0, 0.0);
        for i in 0..4000 {
            let (origin, dir) = launch(&fiber, &mut Rng::new(1, i));
            let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) else {
                continue;
            };
            let p = origin + hit.t * dir;
            let q = turned(p, -tau * p.z);
            let f = (q.x / a).powi(2) + (q.y / b).powi(2);
            // Flat pieces of half a degree.
            assert!((f - 1.0).abs() < 1e-3, "{f}");
            let (fx, fy) = (q.x / (a * a), q.y / (b * b));
            let along = tau * (q.y * fx - q.x * fy);
            let normal = turned(DVec3::new(fx, fy, along), tau * p.z).normalize();
            worst = worst.max((normal - hit.normal).length());
            together += normal.z * hit.normal.z;
            alone += normal.z * normal.z;
        }
        // A piece of half a degree is off by as much at a vertex, more where the curve is sharp.
        assert!(worst < 0.03, "{worst}");
        let share = together / alone;
        assert!((share - 1.0).abs() < 0.02, "{share}");
    }
}

#[test]
fn a_period_on_everything_is_turned_and_the_same() {
    for (name, fiber) in fibers() {
        let period = fiber.period_um();
        let angle = fiber.twist * period;
        let screw = |p: DVec3, n: f64| turned(p, n * angle) + n * period * DVec3::Z;
        for i in 0..3000 {
            let mut rng = Rng::new(2, i);
            let (mut p, dir) = launch(&fiber, &mut rng);
            p += 2.8 * fiber.bounding_radius_um() / dir.truncate().length() * dir;
            if i % 2 == 0 {
                p.z = 20.0 * (rng.uniform() - 0.5);
            }
            let region = fiber.region_at(p);
            assert_eq!(region, fiber.region_at(screw(p, 1.0)), "{name} {p}");
            let here = fiber.next_hit(p, dir, region, None);
            let there = fiber.next_hit(screw(p, -3.0), turned(dir, -3.0 * angle), region, None);
            let (Some(here), Some(there)) = (here, there) else {
                assert!(here.is_none() && there.is_none(), "{name} {p} {dir}");
                continue;
            };
            // Corners lie on a lattice of about a millionth of a micrometer, turned ones on other
            // places of it; a ray that grazes the surface multiplies that.
            let across = (here.t - there.t).abs() * dir.dot(here.normal).abs();
            assert!(across < 1e-5, "{name} {p} {dir}: {across}");
            let normal = turned(there.normal, 3.0 * angle);
            assert!((here.normal - normal).length() < 1e-6, "{name} {p} {dir}");
        }
    }
}

/// Untwisted, the regions are those of the straight fiber, but for slivers that flat pieces cut off.
#[test]
fn regions_are_the_straight_fibers_turned() {
    for (name, fiber) in fibers() {
        let straight = Structure {
            twist_turns_per_cm: 0.0,
            ..fiber.structure().clone()
        };
        let straight = Fiber::build(&straight, 4).unwrap();
        let n = 20_000;
        let differ = (0..n).filter(|&i| {
            let p = super::library::somewhere(&fiber, &mut Rng::new(3, i));
            let q = turned(p, -fiber.twist * p.z);
            fiber.region_at(p) != straight.region_at(q)
        });
        let share = differ.count() as f64 / n as f64;
        assert!(share < 0.01, "{name}: {share}");
        let voids = [&fiber, &straight].map(Fiber::void_count);
        assert_eq!(voids[0], voids[1]);
        assert!(!fiber.is_mirror_symmetric() && straight.is_mirror_symmetric());
    }
}

#[test]
fn no_ray_is_lost_in_a_twisted_fiber() {
    for (name, fiber) in fibers() {
        let tally = walk(&fiber, 3000, 3);
        eprintln!("{name}: {} segments, {} lost", tally.segments, tally.lost);
        assert!(tally.segments > 3000, "{name}");
        assert_eq!(tally.lost, 0, "{name}");
        assert!(
            tally.wrong_between as f64 <= 1e-5 * tally.segments as f64,
            "{name}"
        );
        assert!(
            tally.wrong_sides as f64 <= 1e-4 * tally.segments as f64 + 2.0,
            "{name}"
        );
    }
}

/// Pigment that leans and streaks keeps its mean.
#[test]
fn pigment_turns_with_the_fiber() {
    let mut leaning = oval();
    leaning.cortex.toward_medulla = 0.6;
    leaning.cortex.streaks = 0.5;
    let fiber = twisted(leaning, 2.0);
    let (mut pigment, mut way) = (0.0, 0.0);
    for i in 0..3000 {
        let (mut p, dir) = launch(&fiber, &mut Rng::new(7, i));
        let (mut region, mut from): (Region, Option<HitState>) = (Region::Outside, None);
        while let Some(hit) = fiber.next_hit(p, dir, region, from) {
            if region == Region::Cortex {
                pigment += hit.pigment_um;
                way += hit.t;
            }
            p += hit.t * dir;
            (region, from) = (hit.to, Some(hit.state));
        }
    }
    let mean: f64 = pigment / way;
    assert!((mean - 1.0).abs() < 0.03, "{mean}");
}

/// A round fiber without scales is the same twisted or not: nothing to turn.
#[test]
fn a_twisted_cylinder_is_a_cylinder() {
    let fiber = twisted(glass(), 2.0);
    for i in 0..1000 {
        let (origin, dir) = launch(&fiber, &mut Rng::new(5, i));
        if let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) {
            let p = origin + hit.t * dir;
            assert!((p.truncate().length() / 40.0 - 1.0).abs() < 1e-4);
            assert!(hit.normal.z.abs() < 1e-3);
        }
    }
}
