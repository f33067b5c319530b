//! Sections that are no ellipse: closed forms of their shapes, and rays that meet them.

use super::super::section::Section as Frame;
use super::super::{Fiber, FiberError, Region};
use super::walk::launch;
use crate::sampling::Rng;
use crate::species::{Section, Structure};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const SHAPES: [(Section, f64); 5] = [
    (Section::Superellipse { squareness: 4.0 }, 2.0),
    (Section::DumbBell, 2.0),
    (Section::DumbBell, 2.8),
    (Section::ConcavoConvex { bend: 0.4 }, 1.8),
    (Section::Bean { dent: 0.25 }, 1.5),
];

fn bare(section: Section, aspect: f64) -> Structure {
    Structure {
        section,
        aspect,
        ..super::glass()
    }
}

/// The area of the polygon through the lines is that of the circle of `diameter_um`.
#[test]
fn every_shape_has_the_area_of_its_diameter() {
    for (section, aspect) in SHAPES {
        let structure = bare(section, aspect);
        let frame = Frame::of(&structure).unwrap();
        let lines = frame.lines(2000);
        let point = |i: usize| {
            let line = lines[i % lines.len()];
            glam::DVec2::new(frame.a * line.cos, frame.b * line.sin) * line.rho
        };
        let area: f64 = (0..lines.len())
            .map(|i| 0.5 * point(i).perp_dot(point(i + 1)))
            .sum();
        let step = |i: usize| point(i).distance(point(i + 1));
        let expected = PI * (0.5 * structure.diameter_um).powi(2);
        assert!((area / expected - 1.0).abs() < 1e-4, "{section:?}: {area}");
        let mean = frame.circumference() / lines.len() as f64;
        let even = (0..lines.len()).all(|i| (step(i) / mean - 1.0).abs() < 0.02);
        assert!(even, "{section:?}");
    }
}

/// Superellipse: area `4 a b G(1 + 1/q)^2 / G(1 + 2/q)`, at q = 4 it is 3.708149 a b. Cassini's oval:
/// axes `sqrt(b^2 +- c^2)`, area `2 b^2 E(c^4 / b^4)` with the complete elliptic integral E.
#[test]
fn axes_follow_from_area_and_aspect() {
    let [x, y] = extents(Section::Superellipse { squareness: 4.0 }, 2.0);
    let b = 40.0 * (PI / (3.708_149_354_602_744 * 2.0)).sqrt();
    assert!((y - b).abs() < 1e-3 * b && (x - 2.0 * b).abs() < 2e-3 * b);

    // Without a waist: 1.6 < sqrt 3.
    let aspect = 1.6f64;
    let c2 = (aspect.powi(2) - 1.0) / (aspect.powi(2) + 1.0);
    let n = 1000;
    let integral: f64 = (0..n)
        .map(|i| {
            let sin = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(n)).sin();
            (1.0 - (c2 * sin).powi(2)).sqrt()
        })
        .sum();
    let area = 2.0 * integral * FRAC_PI_2 / f64::from(n);
    let scale = 40.0 * (PI / area).sqrt();
    let [x, y] = extents(Section::DumbBell, aspect);
    assert!((x - scale * (1.0 + c2).sqrt()).abs() < 1e-3 * x);
    assert!((y - scale * (1.0 - c2).sqrt()).abs() < 1e-3 * y);

    // Waisted: thicker beside the middle than in it.
    let frame = Frame::of(&bare(Section::DumbBell, 2.4)).unwrap();
    assert!(frame.half_extents()[1] > 1.05 * frame.b * frame.rho(FRAC_PI_2));
    // Sheared along y: as wide as its ellipse.
    let [x, _] = extents(Section::ConcavoConvex { bend: 0.3 }, 1.6);
    assert!((x / (40.0 * 1.6f64.sqrt()) - 1.0).abs() < 1e-3);
}

fn extents(section: Section, aspect: f64) -> [f64; 2] {
    Fiber::build(&bare(section, aspect), 0)
        .unwrap()
        .semi_axes_um()
}

/// Without scales hits lie on the curve, within what 320 lines resolve, and the bounding cylinder
/// holds them and touches.
#[test]
fn rays_meet_the_curve() {
    for (section, aspect) in SHAPES {
        let fiber = Fiber::build(&bare(section, aspect), 0).unwrap();
        let (mut hits, mut farthest) = (0, 0.0f64);
        for i in 0..3000 {
            let (origin, dir) = launch(&fiber, &mut Rng::new(2, i));
            let Some(hit) = fiber.next_hit(origin, dir, Region::Outside, None) else {
                continue;
            };
            let p = origin + hit.t * dir;
            let unit = fiber.section.unit_point(p);
            let rho = fiber.section.rho(unit.y.atan2(unit.x));
            let off = unit.x.hypot(unit.y) / rho - 1.0;
            assert!(off.abs() < 1e-3, "{section:?}: {off}");
            assert_eq!(hit.normal.z, 0.0);
            farthest = farthest.max(p.x.hypot(p.y));
            hits += 1;
        }
        let bound = fiber.bounding_radius_um();
        assert!(hits > 1000 && farthest <= bound, "{section:?}");
        assert!(farthest > 0.97 * bound, "{section:?}: {farthest} {bound}");
    }
}

#[test]
fn a_section_that_folds_is_refused() {
    let folded = bare(Section::ConcavoConvex { bend: 0.6 }, 5.0);
    assert!(matches!(
        Fiber::build(&folded, 0),
        Err(FiberError::SectionFolds)
    ));
    // The circle in all its guises.
    for section in [
        Section::Superellipse { squareness: 2.0 },
        Section::DumbBell,
        Section::ConcavoConvex { bend: 0.0 },
        Section::Bean { dent: 0.0 },
    ] {
        let frame = Frame::of(&bare(section, 1.0)).unwrap();
        for i in 0..100 {
            assert!((frame.rho(TAU * f64::from(i) / 100.0) - 1.0).abs() < 1e-9);
        }
    }
}

/// Parallel lines take an even sample of the volume: however the pigment leans, its mean over the
/// cortex is 1, beyond the ellipse of the section too.
#[test]
fn leaning_pigment_keeps_its_mean_in_every_shape() {
    for (section, aspect) in SHAPES {
        let mut structure = bare(section, aspect);
        structure.cortex.toward_medulla = 0.6;
        structure.cortex.clear_rim = 0.1;
        let fiber = Fiber::build(&structure, 0).unwrap();
        let (mut pigment, mut way) = (0.0, 0.0);
        let radius = fiber.bounding_radius_um();
        let count = 4000;
        for i in 0..count {
            let dir = glam::DVec3::new(0.8, 0.6, 0.0);
            let h = radius * (2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0);
            let mut p = glam::DVec3::new(-0.6 * h, 0.8 * h, 3.0) - 3.0 * radius * dir;
            let (mut region, mut from) = (Region::Outside, None);
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
        assert!((mean - 1.0).abs() < 2e-3, "{section:?}: {mean}");
    }
}
