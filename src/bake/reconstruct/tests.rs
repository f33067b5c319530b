//! Filtered maps against what is known of them.

use super::*;
use crate::bake::{Bake, Goal, Settings};
use crate::fiber::Fiber;
use crate::progress::{Cancel, Silent};
use crate::sampling::Rng;
use crate::table::{StructureTable, Undyed};

fn table(fiber: &Fiber, settings: &Settings) -> (f64, StructureTable) {
    let bake = Bake::of_fiber(fiber, settings).unwrap();
    bake.run(&Goal::default(), &Silent, &Cancel::default());
    match bake.snapshot().unwrap() {
        Undyed::Gray(table) => (bake.error(), *table),
        Undyed::Colored(_) => unreachable!("one fiber"),
    }
}

fn fiber(name: &str) -> Fiber {
    let species = crate::species::load(name, &[]).unwrap();
    Fiber::build(&species.classes[0].stations[0].structure, 0).unwrap()
}

/// Photons over all nodes, and how much better the truth is to be known.
const PHOTONS: u64 = 60_000;
const BETTER: u64 = 30;

#[test]
fn filtered_maps_keep_their_sums_and_are_nearer_to_the_truth_as_they_say() {
    for name in ["human", "polar-bear"] {
        let fiber = fiber(name);
        let settings = |photons, reconstruct, seed| Settings {
            photons,
            reconstruct,
            seed,
            levels: crate::bake::absorption_levels(5),
            ..Settings::cone()
        };
        let (said, filtered) = table(&fiber, &settings(PHOTONS, true, 1));
        let (raw_said, raw) = table(&fiber, &settings(PHOTONS, false, 1));
        let (_, truth) = table(&fiber, &settings(PHOTONS * BETTER, false, 2));
        for node in 0..truth.nodes.len() {
            for level in 0..truth.levels.len() {
                assert_eq!(filtered.ledger(node, level), raw.ledger(node, level));
                let map = filtered.map(node, level);
                assert!(map.iter().all(|f| *f >= 0.0));
                let sum: f64 = map.iter().map(|&f| f64::from(f)).sum();
                assert!((sum / raw.albedo(node, level) - 1.0).abs() < 1e-5, "{name}");
            }
        }
        let cube = Unicube::new(raw.res);
        let norm = Norm::new(&cube, true);
        let distance = |a: &StructureTable, level: usize| {
            let (mut apart, mut power) = (0.0, 0.0);
            for node in 3..13 {
                let maps = a.map(node, level).iter().zip(truth.map(node, level));
                for (texel, (&a, &t)) in maps.enumerate() {
                    apart += norm.weight(texel) * f64::from(a - t).powi(2);
                    power += norm.weight(texel) * f64::from(t).powi(2);
                }
            }
            (apart / power).sqrt()
        };
        let of_truth = raw_said / (BETTER as f64).sqrt();
        let actual = (distance(&filtered, 0).powi(2) - of_truth * of_truth).sqrt();
        assert!(actual < 0.5 * raw_said, "{name}: {actual} after {raw_said}");
        assert!(
            (said / actual - 1.0).abs() < 0.2,
            "{name}: said {said}, is {actual}, was {raw_said}"
        );
        for level in 1..5 {
            let (a, b) = (distance(&filtered, level), distance(&raw, level));
            assert!(a < 0.7 * b, "{name} {level}: {a} of {b}");
        }
    }
}

/// Sums of a lopsided lobe, `copies` times the same photons.
fn lobe(cube: &Unicube, copies: u32) -> Tally {
    use crate::bake::deposit::{Deposits, Rest};
    let levels = crate::bake::absorption_levels(3);
    let mut tally = Tally::new(cube.texels(), levels.len());
    let mut rng = Rng::new(9, 9);
    let mut deposits = Deposits::default();
    for i in 0..40_000u32 {
        let (theta, turn) = rng.normal_pair();
        let w = crate::math::frame::direction(0.1 + 0.15 * theta, 0.8 * turn);
        let rest = Rest {
            part: PHOTON,
            share: 1.0,
            path: f64::from(i % 2) * rng.uniform(),
        };
        tally.emit(1);
        deposits.push(cube.texel(w), rest);
    }
    tally.escape(&mut deposits, &levels);
    for _ in 0..copies.ilog2() {
        let same = tally.clone();
        tally.add(&same);
    }
    tally
}

#[test]
fn the_filter_vanishes_as_photons_come_in() {
    let cube = Unicube::new(16);
    let mut last = f64::INFINITY;
    for copies in [1, 1 << 6, 1 << 12] {
        let tally = lobe(&cube, copies);
        let filter = Reconstruction::new(&cube, true);
        let filtered = filter.maps(&tally).flux;
        let mut folded = tally.clone();
        folded.fold(&cube);
        let raw = folded.flux();
        let off: f64 = filtered
            .iter()
            .zip(&raw)
            .map(|(a, b)| f64::from(a - b).powi(2))
            .sum();
        let all: f64 = raw.iter().map(|&b| f64::from(b).powi(2)).sum();
        let off = (off / all).sqrt();
        // Noise falls by 8 a step; what the filter does falls with its square.
        assert!(off < last / 20.0, "{copies}: {off} after {last}");
        last = off;
    }
}
