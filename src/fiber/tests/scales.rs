//! The scaled surface: closed, tilted by the right angle, as thick as asked.

use super::super::pattern::Pattern;
use super::super::section::Section;
use super::super::surface::Surface;
use super::super::{Fiber, Part, Region};
use crate::math::frame::direction;
use crate::sampling::Rng;
use crate::species::{CuticlePattern, pattern_names};
use glam::DVec3;

#[test]
fn height_closes_round_the_fiber_and_along_the_period() {
    for pattern in pattern_names() {
        let mut s = super::fox_guard();
        s.cuticle.pattern = CuticlePattern::built_in(pattern).unwrap();
        let fiber = Fiber::build(&s, 1).unwrap();
        let torn = torn(&fiber, 4000);
        assert!(torn <= 2, "{pattern}: {torn}");
    }
}

/// Places of `count` at which the height differs from both sides of a line or a few periods on.
fn torn(fiber: &Fiber, count: u64) -> u32 {
    let Surface::Scales(scales) = &fiber.surface else {
        return 0;
    };
    let radius = |p: DVec3| {
        let cell = scales.locate(p);
        scales.radius(cell, scales.across(cell.sector, p.x, p.y), p.z)
    };
    let mut torn = 0;
    for i in 0..count {
        let mut rng = Rng::new(3, i);
        let z = 300.0 * (rng.uniform() - 0.5);
        let sector = (rng.bits() as usize) % scales.sectors.len();
        let plane = scales.sectors[sector].planes[0];
        let on = |e: f64| DVec3::new(plane.cos - e * plane.sin, plane.sin + e * plane.cos, z);
        // A margin exactly here steps; anything else must agree from both sides.
        torn += u32::from((radius(on(1e-9)) - radius(on(-1e-9))).abs() > 1e-7);
        let p = direction(0.0, 6.3 * rng.uniform()) + DVec3::Z * z;
        let q = p + DVec3::Z * 3.0 * fiber.period_um();
        torn += u32::from((radius(p) - radius(q)).abs() > 1e-9);
    }
    torn
}

/// Mean inclination of the faces that rays across the axis meet, degrees toward the root, and the
/// share of rays that meet a face.
fn mean_tilt(fiber: &Fiber, count: u64) -> (f64, f64) {
    let (mut tilt, mut faces) = (0.0, 0u32);
    let far = 2.0 * fiber.bounding_radius_um();
    for i in 0..count {
        let mut rng = Rng::new(4, i);
        let out = direction(0.0, std::f64::consts::TAU * rng.uniform());
        let from = out * far + DVec3::Z * fiber.period_um() * rng.uniform();
        let hit = fiber.next_hit(from, -out, Region::Outside, None).unwrap();
        if hit.part == Part::Scale {
            tilt -= hit.normal.z.asin().to_degrees();
            faces += 1;
        }
    }
    let faces = f64::from(faces);
    (tilt / faces, faces / count as f64)
}

/// Faces rise toward the tip: seen from outside their normals lean to the root by the tilt.
#[test]
fn faces_lean_to_the_root_by_the_tilt() {
    for pattern in pattern_names() {
        for (height, pitch) in [(0.5, 9.0), (0.5, 14.0)] {
            let mut s = super::fox_guard();
            s.cuticle.pattern = CuticlePattern::built_in(pattern).unwrap();
            s.cuticle.height_um = height;
            s.cuticle.pitch_um = pitch;
            let fiber = Fiber::build(&s, 1).unwrap();
            let (mean, faces) = mean_tilt(&fiber, 20_000);
            let expected = (height / pitch).atan().to_degrees();
            assert!(
                (mean - expected).abs() < 0.3,
                "{pattern}: {mean} {expected}"
            );
            assert!(faces > 0.95, "{pattern}: {faces}");
        }
    }
}

/// Every station of the library: closed, and tilted as its numbers say.
#[test]
fn every_hair_of_the_library_is_closed_and_tilted() {
    let (mut fibers, mut worst) = (0, 0.0f64);
    for id in crate::species::ids() {
        for class in crate::species::load(id, &[]).unwrap().classes {
            for station in &class.stations {
                let fiber = Fiber::build(&station.structure, 0).unwrap();
                let place = format!("{id} {} at {}", class.name, station.at);
                let torn = torn(&fiber, 500);
                assert!(torn <= 2, "{place}: {torn}");
                let cuticle = &station.structure.cuticle;
                let pattern = cuticle.pattern.name();
                if cuticle.pattern == CuticlePattern::Smooth || cuticle.lifted > 0.0 {
                    continue;
                }
                let (mean, _) = mean_tilt(&fiber, 6000);
                let expected = (cuticle.height_um / cuticle.pitch_um).atan().to_degrees();
                let off = (mean - expected).abs();
                worst = worst.max(off);
                assert!(off < 0.3, "{place}, {pattern}: {mean} {expected}");
                fibers += 1;
            }
        }
    }
    eprintln!("{fibers} fibers, the worst tilt is {worst:.3} degrees off");
    assert!(fibers > 50);
}

#[test]
fn mean_radius_stays_the_structures() {
    for pattern in pattern_names() {
        let mut s = super::fox_guard();
        s.cuticle.pattern = CuticlePattern::built_in(pattern).unwrap();
        let section = Section::new(s.diameter_um, s.aspect);
        let lines = section.lines(section.line_count(false));
        let around = section.circumference();
        let pattern = Pattern::new(&s.cuticle, &lines, around, 3).unwrap();
        let (mut sum, mut length) = (0.0, 0.0);
        pattern.for_each_span(|(height, slope), lo, hi| {
            assert!(hi >= lo);
            sum += (height + slope * 0.5 * (lo + hi)) * (hi - lo);
            length += hi - lo;
        });
        assert!((length / lines.len() as f64 / pattern.period_um - 1.0).abs() < 1e-12);
        assert!((sum / length).abs() < 1e-12);
    }
}

/// A ray that skims the crests enters and leaves a scale: pairs of hits that end signs alone would miss.
#[test]
fn grazing_rays_find_both_crossings() {
    let fiber = Fiber::build(&super::fox_guard(), 2).unwrap();
    let Surface::Scales(scales) = &fiber.surface else {
        panic!("no scales")
    };
    let (mut hits, mut dense) = (0u32, 0u32);
    for i in 0..4000 {
        let mut rng = Rng::new(8, i);
        let rho = scales.rho_min + (scales.rho_max - scales.rho_min) * rng.uniform();
        let phi = std::f64::consts::TAU * rng.uniform();
        let dir = direction(0.0, phi + std::f64::consts::FRAC_PI_2);
        let dir = (dir * DVec3::new(fiber.section.a, fiber.section.b, 1.0)).normalize();
        let at = direction(0.0, phi) * rho * DVec3::new(fiber.section.a, fiber.section.b, 1.0);
        let origin = at - 200.0 * dir + DVec3::Z * 500.0 * rng.uniform();
        let hit = fiber.next_hit(origin, dir, Region::Outside, None);
        // The truth by brute force: steps of a hundredth of a micrometer through the shell.
        let inside = (0..4000).any(|k| {
            let t = 200.0 + 0.01 * (f64::from(k) - 2000.0);
            fiber.region_at(origin + t * dir) != Region::Outside
        });
        hits += u32::from(hit.is_some());
        dense += u32::from(inside);
        assert!(hit.is_some() || !inside, "ray {i} passes through a scale");
    }
    assert!(hits >= dense && hits < dense + 20, "{hits} {dense}");
    assert!(hits > 1000 && hits < 3900);
}
