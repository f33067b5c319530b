//! Light through a medulla: the closed form of its mean path, and a medium that stands for bubbles.

use super::super::{Fiber, medulla};
use crate::bake::{End, Photon, Sides, fly};
use crate::sampling::Rng;
use crate::species::{MedullaKind, Structure};

fn round(ratio: f64, kind: MedullaKind) -> Structure {
    let smooth = ("smooth", 10.0, 0.0, 1);
    let mut s = super::structure(60.0, 1.0, smooth, (ratio, kind));
    s.cuticle.roughness = 0.0;
    s
}

/// Paths through pigment of photons from all directions, each with the cosine that it counts by.
fn paths(fiber: &Fiber, count: u64) -> Vec<(f64, f64)> {
    let flights = (0..count).filter_map(|i| {
        let bin = (i % 16) as f64 / 8.0 - 1.0;
        let photon = Photon {
            seed: 1,
            stream: i,
            sin_range: (bin, bin + 0.125),
            sides: Sides::ALL,
        };
        let flight = fly(fiber, &photon, 100_000);
        assert!(!matches!(flight.end, End::Lost | End::Truncated));
        matches!(flight.end, End::Escaped(_)).then_some((flight.theta().cos(), flight.path_um))
    });
    flights.collect()
}

/// Share of light from all directions that comes out again.
fn albedo(paths: &[(f64, f64)], absorption_per_um: f64) -> f64 {
    let all: f64 = paths.iter().map(|p| p.0).sum();
    let out = paths
        .iter()
        .map(|p| p.0 * (-absorption_per_um * p.1).exp())
        .sum::<f64>();
    out / all
}

/// Share of the directions and places in a cylinder of index n that light from outside never reaches
/// and that pass by the medulla: `b > ratio` and `n b sin > 1`, with b the distance of a ray from the
/// axis and sin that of its angle with the axis.
fn unreached(ior: f64, ratio: f64) -> f64 {
    let n = 400_000;
    let mut rng = Rng::new(3, 3);
    let hidden = (0..n)
        .filter(|_| {
            let r = rng.uniform().sqrt();
            let b = r * (std::f64::consts::TAU * rng.uniform()).sin().abs();
            let cos = 2.0 * rng.uniform() - 1.0;
            b > ratio && ior * b * (1.0 - cos * cos).sqrt() > 1.0
        })
        .count();
    hidden as f64 / f64::from(n)
}

/// In a field that is the same in all directions rays pass a part in proportion to its volume and its
/// index squared, whatever the shape of what scatters them: the mean path through keratin is
/// `4 n^2 V / S` (after Blanco and Fournier 2003), V the keratin's volume, S the surface outside.
#[test]
fn the_mean_path_through_keratin_is_that_of_an_even_field() {
    let froth = |radius_um, air_fraction| MedullaKind::Froth {
        radius_um,
        radius_sigma: 0.3,
        air_fraction,
    };
    // Curved walls only: between flat ones, as in a ladder, some light that is caught inside never
    // meets any from outside, and the mean path is some percent shorter.
    for kind in [froth(4.0, 0.35), froth(3.0, 0.2)] {
        let ratio = 0.9;
        let fiber = Fiber::build(&round(ratio, kind), 2).unwrap();
        let paths = paths(&fiber, 30_000);
        let all: f64 = paths.iter().map(|p| p.0).sum();
        let mean = paths.iter().map(|p| p.0 * p.1).sum::<f64>() / all;
        let (n, radius) = (1.55f64, 30.0);
        let keratin = 1.0 - fiber.air_fraction() * ratio * ratio - unreached(n, ratio);
        let expected = 2.0 * n * n * radius * keratin;
        eprintln!(
            "{}: mean path {mean:.2}, expected {expected:.2}",
            kind.name()
        );
        assert!(
            (mean / expected - 1.0).abs() < 0.03,
            "{}: {mean} {expected}",
            kind.name()
        );
    }
}

/// Where bubbles of one size or of many give way to a medium both send the same light back, from clear to
/// black. Not so cells with flat walls: light that runs within a wall meets hardly any from outside, so that
/// they absorb less than the medium.
#[test]
fn a_medium_and_its_cells_have_the_same_albedo() {
    let amorphous = |radius_um, air_fraction| MedullaKind::Amorphous {
        radius_um,
        air_fraction,
    };
    let kinds = [
        amorphous(1.5, 0.3),
        amorphous(2.0, 0.4),
        MedullaKind::Froth {
            radius_um: 1.6,
            radius_sigma: 0.4,
            air_fraction: 0.35,
        },
    ];
    for kind in kinds {
        let cells = round(0.6, kind);
        let stand_in = medulla::equivalent(&cells.medulla).unwrap();
        let mut medium = round(
            0.6,
            MedullaKind::Medium {
                scattering_per_um: stand_in.scattering_per_um,
                asymmetry: stand_in.asymmetry,
            },
        );
        medium.medulla.pigment = stand_in.pigment;
        let cells = Fiber::build(&cells, 4).unwrap();
        assert!(cells.void_count() > 100);
        let medium = Fiber::build(&medium, 4).unwrap();
        let (a, b) = (paths(&cells, 20_000), paths(&medium, 20_000));
        for depth in [0.05, 0.2, 0.8, 3.2] {
            let (x, y) = (albedo(&a, depth / 30.0), albedo(&b, depth / 30.0));
            eprintln!("{}, depth {depth}: {x:.4} {y:.4}", kind.name());
            assert!(
                (x / y - 1.0).abs() < 0.05,
                "{} {depth}: {x} {y}",
                kind.name()
            );
        }
    }
}
