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
                cell_um: 20.0,
                septum_um: 1.0,
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
                spacing: 0.9,
                film_um: 1.0,
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
    }
}
