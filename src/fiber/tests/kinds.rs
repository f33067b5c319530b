//! Every kind of medulla: its share of air, its distance from the cuticle, its period, its looks from
//! the inside.

use super::super::{Fiber, Region};
use super::structure;
use crate::sampling::{Rng, concentric_disk};
use crate::species::{Continuity, Cortex, MedullaKind, Structure};
use glam::DVec3;

/// One fiber a kind, after the animals that have it.
pub(super) fn structures() -> Vec<(&'static str, Structure)> {
    let hare = structure(
        90.0,
        1.6,
        ("irregular-wave", 12.0, 0.5, 4),
        (
            0.8,
            MedullaKind::Multiserial {
                cell_um: 12.5,
                pitch_um: 10.0,
                septum_um: 1.5,
            },
        ),
    );
    let deer = structure(
        300.0,
        1.1,
        ("mosaic", 18.0, 0.5, 14),
        (
            0.94,
            MedullaKind::Lattice {
                cell_um: 30.0,
                wall_um: 1.0,
            },
        ),
    );
    let fox = structure(
        75.0,
        1.2,
        ("mosaic", 9.0, 0.5, 7),
        (0.7, MedullaKind::SChannel { pitch_um: 7.0 }),
    );
    let marten = structure(
        80.0,
        1.3,
        ("mosaic", 9.0, 0.5, 7),
        (
            0.75,
            MedullaKind::Cloisonne {
                columns: 4,
                pitch_um: 6.0,
                height_um: 3.5,
            },
        ),
    );
    let squirrel = structure(
        90.0,
        1.4,
        ("irregular-wave", 7.5, 0.4, 4),
        (
            0.78,
            MedullaKind::TireTread {
                pitch_um: 8.5,
                cell_um: 18.0,
                septum_um: 1.8,
            },
        ),
    );
    let mut globules = structure(
        100.0,
        1.1,
        ("irregular-wave", 11.0, 0.6, 5),
        (
            0.3,
            MedullaKind::Globules {
                spacing: 0.2,
                film_um: 1.3,
            },
        ),
    );
    globules.cortex.fusi_per_mm = 100.0;
    let dog = structure(
        70.0,
        1.1,
        ("mosaic", 9.0, 0.5, 7),
        (
            0.3,
            MedullaKind::Amorphous {
                radius_um: 1.2,
                air_fraction: 0.3,
            },
        ),
    );
    let mut human = structure(
        80.0,
        1.3,
        ("irregular-wave", 8.0, 0.4, 5),
        (
            0.3,
            MedullaKind::Amorphous {
                radius_um: 0.6,
                air_fraction: 0.3,
            },
        ),
    );
    human.medulla.continuity = Continuity::Fragmentary;
    human.cortex = Cortex {
        toward_medulla: -0.4,
        clear_rim: 0.1,
        streaks: 0.5,
        fusi_per_mm: 50.0,
    };
    let mut cow = super::bear_guard();
    cow.medulla.continuity = Continuity::Interrupted;
    cow.medulla.pigment = 2.0;
    let mut mouse = super::mink_under();
    mouse.medulla.continuity = Continuity::Interrupted;
    vec![
        ("hare, multiserial", hare),
        ("deer, lattice", deer),
        ("fox, S channel", fox),
        ("marten, cloisonne", marten),
        ("squirrel, tire tread", squirrel),
        ("bear, globules and fusi", globules),
        ("dog, amorphous", dog),
        ("human, fragmentary medium", human),
        ("cow, interrupted froth", cow),
        ("mouse, interrupted ladder", mouse),
    ]
}

/// A point in the medulla, even over its volume.
fn somewhere(fiber: &Fiber, rng: &mut Rng) -> DVec3 {
    let (x, y) = concentric_disk(rng.uniform(), rng.uniform());
    let [a, b] = fiber.semi_axes_um();
    let ratio = fiber.medulla.ratio;
    DVec3::new(
        ratio * a * x,
        ratio * b * y,
        fiber.period_um() * rng.uniform(),
    )
}

fn share_of_points(fiber: &Fiber) -> f64 {
    let n = 60_000;
    let mut rng = Rng::new(17, 0);
    let inside = (0..n)
        .filter(|_| fiber.region_at(somewhere(fiber, &mut rng)) == Region::Void)
        .count();
    inside as f64 / f64::from(n)
}

/// Shares of air in the recipes.
fn literature(kind: &MedullaKind) -> (f64, f64) {
    match *kind {
        MedullaKind::Ladder { .. } => (0.55, 0.75),
        MedullaKind::Multiserial { .. } => (0.55, 0.75),
        MedullaKind::Lattice { .. } => (0.85, 0.95),
        MedullaKind::SChannel { .. } | MedullaKind::Cloisonne { .. } => (0.3, 0.5),
        MedullaKind::TireTread { .. } => (0.5, 0.6),
        MedullaKind::Globules { .. } => (0.2, 0.3),
        MedullaKind::Amorphous { air_fraction, .. } | MedullaKind::Froth { air_fraction, .. } => {
            (0.98 * air_fraction, 1.02 * air_fraction)
        }
        MedullaKind::None | MedullaKind::Medium { .. } => (0.0, 0.0),
    }
}

#[test]
fn air_is_what_it_says_and_what_the_literature_says() {
    for (name, s) in structures() {
        let start = std::time::Instant::now();
        let fiber = Fiber::build(&s, 3).unwrap();
        let built = start.elapsed().as_secs_f64();
        let (told, met) = (fiber.air_fraction(), share_of_points(&fiber));
        eprintln!(
            "{name}: {:.1} ms, period {:.0}, {} voids, air {told:.4}, points {met:.4}",
            1e3 * built,
            fiber.period_um(),
            fiber.void_count()
        );
        assert!((told - met).abs() < 0.01, "{name}: {told} {met}");
        if fiber.medulla.pieces.is_none() {
            let (least, most) = literature(&s.medulla.kind);
            assert!((least..=most).contains(&told), "{name}: {told}");
        }
    }
}

#[test]
fn voids_keep_their_distance_from_the_cuticle() {
    for (name, mut s) in structures() {
        // As wide as it may be: the cortex that is left is then thinner than the distance.
        let fiber = Fiber::build(&s, 5).unwrap();
        if s.cortex.fusi_per_mm == 0.0 {
            s.medulla.ratio = fiber.surface.rho_min() - 0.05 / fiber.section.b;
        }
        let Ok(fiber) = Fiber::build(&s, 5) else {
            panic!("{name}");
        };
        let distance = match s.medulla.kind {
            MedullaKind::Lattice { .. } => 0.5,
            _ => 1.0,
        };
        // Fusi are no part of the medulla and need 0.3 um.
        let distance = if s.cortex.fusi_per_mm > 0.0 {
            0.3
        } else {
            distance
        };
        let [a, b] = fiber.semi_axes_um();
        let least = fiber.surface.rho_min() - distance / b;
        for i in 0..60_000 {
            let mut rng = Rng::new(31, i);
            let rho = least + (fiber.surface.rho_max() - least) * rng.uniform();
            let (sin, cos) = (std::f64::consts::TAU * rng.uniform()).sin_cos();
            let z = fiber.period_um() * rng.uniform();
            let region = fiber.region_at(DVec3::new(a * rho * cos, b * rho * sin, z));
            assert_ne!(region, Region::Void, "{name}");
        }
    }
}

#[test]
fn everything_closes_after_a_period() {
    for (name, s) in structures() {
        let fiber = Fiber::build(&s, 5).unwrap();
        let up = DVec3::Z * fiber.period_um();
        for i in 0..20_000 {
            let mut rng = Rng::new(37, i);
            let mut p = somewhere(&fiber, &mut rng);
            if i % 2 == 0 {
                // About the seam.
                p.z = 20.0 * (rng.uniform() - 0.5);
            }
            let (u, v) = (rng.uniform(), rng.uniform());
            let dir = crate::math::frame::direction((2.0 * u - 1.0).asin(), 6.3 * v);
            let region = fiber.region_at(p);
            assert_eq!(region, fiber.region_at(p + up), "{name} {p}");
            let here = fiber.next_hit(p, dir, region, None).unwrap();
            let there = fiber.next_hit(p - 2.0 * up, dir, region, None).unwrap();
            assert!((here.t - there.t).abs() < 1e-6, "{name} {p} {dir}");
            assert!(
                (here.normal - there.normal).length() < 1e-4,
                "{name} {p} {dir}"
            );
        }
    }
}

/// Surface per volume without any ray: two points a little apart differ as often as something lies
/// between them.
fn surface_per_volume(fiber: &Fiber) -> f64 {
    let (n, step) = (300_000, 0.1);
    let mut rng = Rng::new(41, 0);
    let mut differ = 0;
    for _ in 0..n {
        let p = somewhere(fiber, &mut rng);
        let dir = crate::math::frame::direction(
            (2.0 * rng.uniform() - 1.0).asin(),
            std::f64::consts::TAU * rng.uniform(),
        );
        let air = |p: DVec3| fiber.region_at(p) == Region::Void;
        differ += u32::from(air(p) != air(p + step * dir));
    }
    2.0 * f64::from(differ) / (f64::from(n) * step)
}

/// A ray into the medulla, even over all lines that meet it: a place on the outline, a cosine law.
fn line_in(fiber: &Fiber, rng: &mut Rng) -> (DVec3, DVec3) {
    let [a, b] = fiber.semi_axes_um().map(|s| s * fiber.medulla.ratio);
    loop {
        let (sin, cos) = (std::f64::consts::TAU * rng.uniform()).sin_cos();
        // Even over the arc.
        if rng.uniform() * a.max(b) > (a * sin).hypot(b * cos) {
            continue;
        }
        let inward = -DVec3::new(b * cos, a * sin, 0.0).normalize();
        let (x, y) = concentric_disk(rng.uniform(), rng.uniform());
        let side = DVec3::new(inward.y, -inward.x, 0.0);
        let dir = x * side + y * DVec3::Z + (1.0 - x * x - y * y).max(0.0).sqrt() * inward;
        let at = DVec3::new(a * cos, b * sin, fiber.period_um() * rng.uniform());
        return (at, dir);
    }
}

#[test]
fn chords_in_the_voids_follow_cauchy() {
    for (name, s) in structures() {
        let fiber = Fiber::build(&s, 6).unwrap();
        if fiber.air_fraction() == 0.0 {
            continue;
        }
        let expected = 4.0 * fiber.air_fraction() / surface_per_volume(&fiber);
        let (mut sum, mut count) = (0.0, 0u32);
        for i in 0..8000 {
            let (mut p, dir) = line_in(&fiber, &mut Rng::new(43, i));
            let (mut region, mut from) = (Region::Cortex, None);
            for step in 0..10_000 {
                assert!(step < 9_999, "{name} {p}");
                let hit = fiber.next_hit(p, dir, region, from).unwrap();
                if region == Region::Void && fiber.is_in_medulla(p + 0.5 * hit.t * dir) {
                    sum += hit.t;
                    count += 1;
                }
                p += hit.t * dir;
                (region, from) = (hit.to, Some(hit.state));
                if region == Region::Outside {
                    break;
                }
            }
        }
        let mean = sum / f64::from(count);
        eprintln!("{name}: mean chord {mean:.3}, expected {expected:.3}");
        assert!(
            (mean / expected - 1.0).abs() < 0.05,
            "{name}: {mean} {expected}"
        );
    }
}
