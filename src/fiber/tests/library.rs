//! What the recipes of medullae ask for, over every hair of the library: share of air, distance from
//! the cuticle, mean chord, outline.

use super::super::{Fiber, Region};
use super::walk::launch;
use crate::sampling::Rng;
use crate::species::{self, Continuity, MedullaKind, Structure};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Every station of every built-in animal, without fusi: they are no part of the medulla. Made-up
/// animals keep to no recipe.
pub(super) fn medullae() -> Vec<(String, Structure)> {
    let mut all = Vec::new();
    for id in species::ids() {
        let species = species::load(id, &[]).unwrap();
        if species.latin.is_empty() {
            continue;
        }
        for class in &species.classes {
            for station in &class.stations {
                let mut structure = station.structure.clone();
                structure.cortex.fusi_per_mm = 0.0;
                if structure.medulla.ratio > 0.0 {
                    let name = format!("{id} {} {}", class.name, station.at);
                    all.push((name, structure));
                }
            }
        }
    }
    assert!(all.len() > 80, "{}", all.len());
    all
}

fn fibers() -> Vec<(String, Fiber)> {
    let build = |(name, s): (String, Structure)| (name, Fiber::build(&s, 9).unwrap());
    medullae().into_par_iter().map(build).collect()
}

/// A point in the box about the fiber.
pub(super) fn somewhere(fiber: &Fiber, rng: &mut Rng) -> DVec3 {
    let r = fiber.bounding_radius_um();
    let mut even = |scale: f64| scale * (2.0 * rng.uniform() - 1.0);
    let (x, y) = (even(r), even(r));
    DVec3::new(x, y, fiber.period_um() * rng.uniform())
}

/// Shares of air in the recipes.
fn recipe(kind: &MedullaKind) -> (f64, f64) {
    match *kind {
        MedullaKind::Ladder { .. } => (0.55, 0.75),
        MedullaKind::Multiserial { .. } => (0.6, 0.75),
        MedullaKind::Lattice { .. } => (0.85, 0.95),
        MedullaKind::SChannel { .. } | MedullaKind::Cloisonne { .. } => (0.3, 0.5),
        MedullaKind::TireTread { .. } => (0.5, 0.6),
        MedullaKind::Globules { .. } => (0.2, 0.3),
        MedullaKind::Froth { .. } => (0.3, 0.5),
        MedullaKind::Amorphous { .. } => (0.2, 0.4),
        MedullaKind::None | MedullaKind::Medium { .. } => (0.0, 0.0),
    }
}

#[test]
fn every_medulla_of_the_library_holds_as_much_air_as_its_recipe_says() {
    let wrong: Vec<String> = (fibers().par_iter())
        .filter(|(_, fiber)| fiber.medulla.medium.is_none())
        .filter_map(|(name, fiber)| {
            let (mut within, mut air) = (0u32, 0u32);
            for i in 0..100_000 {
                let p = somewhere(fiber, &mut Rng::new(1, i));
                within += u32::from(fiber.is_in_medulla(p));
                air += u32::from(fiber.region_at(p) == Region::Void);
            }
            let medulla = &fiber.structure().medulla;
            let met = f64::from(air) / f64::from(within);
            let (mut least, mut most) = recipe(&medulla.kind);
            // Pieces end at whole voids, which may be one more or less.
            if medulla.continuity != Continuity::Continuous {
                (least, most) = (0.85 * least, 1.15 * most);
            }
            // 100 000 points, a tenth or more of them within, tell a share to a hundredth.
            let in_range = (least - 0.012..=most + 0.012).contains(&met);
            (!in_range).then(|| format!("{name}: {} holds {met:.3}", medulla.kind.name()))
        })
        .collect();
    assert_eq!(wrong, [""; 0]);
}

/// A ball about any place of the surface, as wide as the keratin must be thick, holds no void.
pub(super) fn keeps_its_distance(name: &str, fiber: &Fiber, least: f64, rays: u64) {
    let mut met = 0;
    for i in 0..rays {
        let mut rng = Rng::new(2, i);
        let (origin, dir) = launch(fiber, &mut rng);
        let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) else {
            continue;
        };
        met += 1;
        let p = origin + hit.t * dir;
        for _ in 0..6 {
            let (u, v) = (2.0 * rng.uniform() - 1.0, TAU * rng.uniform());
            let way = DVec3::new(
                (1.0 - u * u).sqrt() * v.cos(),
                (1.0 - u * u).sqrt() * v.sin(),
                u,
            );
            // The lowest of the cuticle is known between its lines to some hundredths of a micrometer.
            let q = p + (least - 0.05) * rng.uniform().cbrt() * way;
            assert_ne!(fiber.region_at(q), Region::Void, "{name}: {p} {q}");
        }
    }
    assert!(met > rays / 4, "{name}: {met}");
}

#[test]
fn every_void_of_the_library_keeps_its_distance_from_the_cuticle() {
    fibers().par_iter().for_each(|(name, fiber)| {
        let least = match fiber.structure().medulla.kind {
            MedullaKind::Lattice { .. } => 0.5,
            _ => 1.0,
        };
        keeps_its_distance(name, fiber, least, 8000);
    });
}

/// Mean way in the voids of lines through all of the fiber, and what Cauchy says it is, `4 V / S`: the
/// surface by how often two points a little apart differ.
pub(super) fn chords(fiber: &Fiber, lines: u64) -> (f64, f64) {
    let (mut sum, mut count) = (0.0, 0u32);
    for i in 0..lines {
        let mut rng = Rng::new(3, i);
        let radius = fiber.bounding_radius_um();
        // A cosine law on the cylinder about it: lines even in all of it.
        let (x, y) = crate::sampling::concentric_disk(rng.uniform(), rng.uniform());
        let (sin, cos) = (TAU * rng.uniform()).sin_cos();
        let inward = DVec3::new(-cos, -sin, 0.0);
        let side = DVec3::new(sin, -cos, 0.0);
        let dir = x * side + y * DVec3::Z + (1.0 - x * x - y * y).max(0.0).sqrt() * inward;
        let mut p = -radius * inward + fiber.period_um() * rng.uniform() * DVec3::Z - dir;
        let (mut region, mut from) = (Region::Outside, None);
        while let Some(hit) = fiber.next_hit(p, dir, region, from) {
            if region == Region::Void {
                sum += hit.t;
                count += 1;
            }
            p += hit.t * dir;
            (region, from) = (hit.to, Some(hit.state));
        }
        assert_eq!(region, Region::Outside);
    }
    const STEP: f64 = 0.1;
    let (mut air, mut differ) = (0u32, 0u32);
    // Pairs in the medulla, until there are enough.
    let half = 1.05 * fiber.medulla.ratio * fiber.bounding_radius_um();
    for i in 0..3_000_000 {
        let mut rng = Rng::new(4, i);
        let mut even = |scale: f64| scale * (2.0 * rng.uniform() - 1.0);
        let (x, y, z) = (even(half), even(half), even(1.0));
        let p = DVec3::new(x, y, fiber.period_um() * rng.uniform());
        let (sin, cos) = (TAU * rng.uniform()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        let q = p + STEP * DVec3::new(r * cos, r * sin, z);
        let [a, b] = [p, q].map(|p| fiber.region_at(p) == Region::Void);
        air += u32::from(a);
        differ += u32::from(a != b);
        if differ == 4000 {
            break;
        }
    }
    let expected = 2.0 * STEP * f64::from(air) / f64::from(differ);
    (sum / f64::from(count), expected)
}

#[test]
fn chords_in_every_medulla_of_the_library_follow_cauchy() {
    fibers().par_iter().for_each(|(name, fiber)| {
        if fiber.air_fraction() == 0.0 {
            return;
        }
        let (mean, expected) = chords(fiber, 4000);
        assert!(
            (mean / expected - 1.0).abs() < 0.1,
            "{name}: {mean} {expected}"
        );
    });
}
