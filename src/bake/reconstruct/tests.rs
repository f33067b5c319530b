//! Filtered maps against what is known of them.

use super::*;
use crate::bake::noise::Norm;
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

/// Photons over all nodes, and how many times as many the truth is taken from.
const PHOTONS: u64 = 60_000;
const BETTER: u64 = 20;

/// The sum over nodes and texels within the norm of the product of what two tables are off two truths
/// with nothing in common, relative to S squared: noise of the truths drops out, and so does that
/// of the tables if they are two.
fn off([a, b]: [&StructureTable; 2], [t, u]: &[StructureTable; 2], level: usize) -> f64 {
    let cube = Unicube::new(a.res);
    let norm = Norm::new(&cube, true);
    let (mut apart, mut power) = (0.0f64, 0.0);
    for node in (0..a.nodes.len()).filter(|n| a.nodes.centers[*n].abs() < 73f64.to_radians()) {
        let [a, b, t, u] = [a, b, t, u].map(|table| table.map(node, level));
        for texel in 0..a.len() {
            let [a, b, t, u] = [a, b, t, u].map(|map| f64::from(map[texel]));
            apart += norm.weight(texel) * 0.5 * ((a - t) * (b - u) + (a - u) * (b - t));
            power += norm.weight(texel) * t * u;
        }
    }
    (apart / power).max(0.0).sqrt()
}

#[test]
fn filtered_maps_keep_their_sums_and_are_nearer_to_the_truth_as_they_say() {
    for (name, bias) in [("human", 0.09), ("polar-bear", 0.11), ("red-fox", 0.11)] {
        let fiber = fiber(name);
        let settings = |photons, reconstruct, seed| Settings {
            photons,
            reconstruct,
            seed,
            levels: crate::bake::absorption_levels(5),
            ..Settings::cone()
        };
        let (said, filtered) = table(&fiber, &settings(PHOTONS, true, 1));
        let (_, again) = table(&fiber, &settings(PHOTONS, true, 4));
        let (raw_said, raw) = table(&fiber, &settings(PHOTONS, false, 1));
        let truths = [2, 3].map(|seed| table(&fiber, &settings(PHOTONS * BETTER, false, seed)).1);
        for node in 0..raw.nodes.len() {
            for level in 0..raw.levels.len() {
                assert_eq!(filtered.ledger(node, level), raw.ledger(node, level));
                let map = filtered.map(node, level);
                assert!(map.iter().all(|f| *f >= 0.0));
                let sum: f64 = map.iter().map(|&f| f64::from(f)).sum();
                assert!((sum / raw.albedo(node, level) - 1.0).abs() < 1e-5, "{name}");
            }
        }
        let actual = off([&filtered, &filtered], &truths, 0);
        assert!(actual < 0.3 * raw_said, "{name}: {actual} after {raw_said}");
        assert!(
            said < 1.4 * actual && actual < 1.4 * said,
            "{name}: said {said}, is {actual}, was {raw_said}"
        );
        // What the filter does to the mean.
        let common = off([&filtered, &again], &truths, 0);
        assert!(common < bias, "{name}: {common} of {actual}");
        for level in 1..5 {
            let [a, b] = [&filtered, &raw].map(|table| off([table, table], &truths, level));
            assert!(a < 0.4 * b, "{name} {level}: {a} of {b}");
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
        let filter = Reconstruction::new(&cube, &Nodes::new(Mode::Cone, 16), true);
        // All nodes alike: not what S is like, so that the guess is wrong and has to be put right.
        let (texels, levels) = (tally.texels(), tally.levels());
        let mut flux = vec![0.0; 16 * levels * texels];
        let mut error = vec![0.0; 16 * texels];
        filter.maps(&vec![tally.clone(); 16], &mut flux, &mut error);
        let filtered = &flux[5 * levels * texels..6 * levels * texels];
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
