//! Medullae in sections that are no ellipse have the section's shape, and no void is nearer to the
//! cuticle for it.

use super::super::surface::Surface;
use super::super::{Fiber, Region};
use super::library::{chords, keeps_its_distance, somewhere};
use super::structure;
use super::walk::launch;
use crate::sampling::Rng;
use crate::species::{self, Continuity, MedullaKind, Section, Structure};
use glam::DVec3;
use std::f64::consts::TAU;

const DUMB_BELL: (Section, f64) = (Section::DumbBell, 2.2);
const BENT: (Section, f64) = (Section::ConcavoConvex { bend: 0.25 }, 1.6);
const OBLONG: (Section, f64) = (Section::Superellipse { squareness: 3.5 }, 2.0);
const BEAN: (Section, f64) = (Section::Bean { dent: 0.15 }, 1.5);

/// Kinds in sections, as animals have them and as they do not.
pub(super) fn structures() -> Vec<(&'static str, Structure)> {
    let multiserial = MedullaKind::Multiserial {
        cell_um: 12.5,
        pitch_um: 10.0,
        septum_um: 1.5,
    };
    let froth = MedullaKind::Froth {
        radius_um: 4.0,
        radius_sigma: 0.4,
        air_fraction: 0.4,
    };
    let ladder = MedullaKind::Ladder {
        pitch_um: 9.0,
        septum_um: 2.0,
    };
    let cloisonne = MedullaKind::Cloisonne {
        columns: 4,
        pitch_um: 6.0,
        height_um: 3.5,
    };
    let medium = MedullaKind::Medium {
        scattering_per_um: 0.05,
        asymmetry: 0.5,
    };
    let tread = MedullaKind::TireTread {
        pitch_um: 8.5,
        cell_um: 14.5,
        septum_um: 1.6,
    };
    let channel = MedullaKind::SChannel { pitch_um: 7.0 };
    let scales = ("irregular-wave", 9.0, 0.5, 5);
    let of = |name, (section, aspect), ratio, kind| {
        let s = Structure {
            section,
            ..structure(90.0, aspect, scales, (ratio, kind))
        };
        (name, s)
    };
    let mut pieces = of("dumb-bell, medium in pieces", DUMB_BELL, 0.7, medium);
    pieces.1.medulla.continuity = Continuity::Interrupted;
    let mut fusi = of("dumb-bell, fusi", DUMB_BELL, 0.5, froth);
    fusi.1.cortex.fusi_per_mm = 200.0;
    vec![
        of("dumb-bell, multiserial", DUMB_BELL, 0.8, multiserial),
        of("dumb-bell, froth", DUMB_BELL, 0.7, froth),
        of("dumb-bell, ladder", DUMB_BELL, 0.7, ladder),
        of("dumb-bell, cloisonne", DUMB_BELL, 0.7, cloisonne),
        of("dumb-bell, S channel", DUMB_BELL, 0.7, channel),
        of("dumb-bell, medium", DUMB_BELL, 0.8, medium),
        of("bent, multiserial", BENT, 0.8, multiserial),
        of("bent, medium", BENT, 0.7, medium),
        of("oblong, tire tread", OBLONG, 0.7, tread),
        of("oblong, ladder", OBLONG, 0.6, ladder),
        of("bean, froth", BEAN, 0.7, froth),
        of("bean, S channel", BEAN, 0.7, channel),
        pieces,
        fusi,
    ]
}

fn fibers() -> Vec<(&'static str, Fiber)> {
    let build = |(name, s): (&'static str, Structure)| (name, Fiber::build(&s, 7).unwrap());
    structures().into_iter().map(build).collect()
}

/// Radius at which something begins on the way in, by halving.
fn radius(fiber: &Fiber, phi: f64, z: f64, inside: impl Fn(DVec3) -> bool) -> f64 {
    let (sin, cos) = phi.sin_cos();
    let (mut lo, mut hi) = (0.0, fiber.bounding_radius_um() * 1.01);
    while hi - lo > 1e-3 {
        let r = 0.5 * (lo + hi);
        if inside(DVec3::new(r * cos, r * sin, z)) {
            lo = r;
        } else {
            hi = r;
        }
    }
    lo
}

/// `R_m = MI R` at every angle, scales apart.
#[test]
fn the_outline_is_the_sections_in_the_small() {
    for (name, fiber) in fibers() {
        if fiber.medulla.pieces.is_some() {
            continue;
        }
        let ratio = fiber.structure().medulla.ratio;
        let height = fiber.structure().cuticle.height_um;
        for i in 0..200 {
            let mut rng = Rng::new(5, i);
            let (phi, z) = (TAU * rng.uniform(), fiber.period_um() * rng.uniform());
            let outer = radius(&fiber, phi, z, |p| fiber.region_at(p) != Region::Outside);
            let core = radius(&fiber, phi, z, |p| fiber.is_in_medulla(p));
            assert!(
                (core - ratio * outer).abs() < 1.5 * height + 0.01 * outer,
                "{name} at {phi}: {core} of {outer}"
            );
        }
    }
}

/// Voids reach to where the outline is, all round, bulges included.
#[test]
fn voids_fill_the_outline() {
    for (name, fiber) in fibers() {
        if fiber.medulla.medium.is_some() || fiber.medulla.pieces.is_some() {
            continue;
        }
        const SECTORS: usize = 24;
        let (mut all, mut air) = ([0.0; SECTORS], [0.0; SECTORS]);
        for i in 0..200_000 {
            let p = somewhere(&fiber, &mut Rng::new(6, i));
            if !fiber.is_in_medulla(p) {
                continue;
            }
            let turn = p.y.atan2(p.x) / TAU;
            let sector = (turn.rem_euclid(1.0) * SECTORS as f64) as usize % SECTORS;
            all[sector] += 1.0;
            air[sector] += f64::from(u8::from(fiber.region_at(p) == Region::Void));
        }
        let mean = air.iter().sum::<f64>() / all.iter().sum::<f64>();
        let told = fiber.air_fraction();
        assert!((told - mean).abs() < 0.012, "{name}: {told} {mean}");
        for (sector, (air, all)) in air.iter().zip(all).enumerate() {
            let share = air / all;
            assert!(
                (share / mean - 1.0).abs() < 0.6,
                "{name}: {share:.3} of sector {sector} is air, {mean:.3} of all"
            );
        }
    }
}

#[test]
fn voids_keep_their_distance_from_a_waist() {
    for (name, fiber) in fibers() {
        let has_fusi = fiber.structure().cortex.fusi_per_mm > 0.0;
        if fiber.medulla.medium.is_none() && !has_fusi {
            keeps_its_distance(name, &fiber, 1.0, 20_000);
            // As wide as it may be.
            let mut wide = fiber.structure().clone();
            wide.medulla.ratio = 0.93;
            let wide = Fiber::build(&wide, 3).unwrap();
            keeps_its_distance(name, &wide, 1.0, 20_000);
        }
    }
}

#[test]
fn chords_follow_cauchy_in_every_shape() {
    for (name, fiber) in fibers() {
        if fiber.air_fraction() == 0.0 {
            continue;
        }
        let (mean, expected) = chords(&fiber, 6000);
        assert!(
            (mean / expected - 1.0).abs() < 0.06,
            "{name}: {mean} {expected}"
        );
    }
}

/// Rays that know when they are far from the surface meet what rays do that march all the way.
#[test]
fn knowing_the_way_clear_changes_no_hit() {
    for (name, mut structure) in structures() {
        // So that pigment tells where rays cross the medulla's outline.
        structure.medulla.pigment = 0.3;
        let fiber = Fiber::build(&structure, 7).unwrap();
        let mut marching = fiber.clone();
        if let Surface::Scales(scales) = &mut marching.surface {
            scales.clearance = None;
        }
        if let Some(rim) = &mut marching.medulla.rim {
            rim.march_all_the_way();
        }
        let (mut hits, mut leaving) = (0, 0);
        for path in 0..1000 {
            let mut rng = Rng::new(9, path);
            let (mut p, mut dir) = launch(&fiber, &mut rng);
            let (mut region, mut from) = (Region::Outside, None);
            for _ in 0..30 {
                let ask = |fiber: &Fiber| fiber.next_hit(p, dir, region, from);
                let (Some(hit), Some(other)) = (ask(&fiber), ask(&marching)) else {
                    assert!(ask(&fiber).is_none() && ask(&marching).is_none(), "{name}");
                    break;
                };
                let near = (hit.t - other.t).abs() < 1e-9 * (1.0 + other.t);
                let same = hit.to == other.to && hit.state == other.state;
                assert!(near && same, "{name}: {hit:?}, marching {other:?}");
                assert!(
                    (hit.pigment_um - other.pigment_um).abs() < 1e-8 * (1.0 + other.t),
                    "{name}: {hit:?}, marching {other:?}"
                );
                hits += 1;
                leaving += u32::from(hit.to == Region::Outside);
                p += hit.t * dir;
                // Through it, or back from it as often.
                if rng.uniform() < 0.5 {
                    dir -= 2.0 * dir.dot(hit.normal) * hit.normal;
                } else {
                    region = hit.to;
                }
                from = Some(hit.state);
            }
        }
        assert!(hits > 2000 && leaving > 250, "{name}: {hits} {leaving}");
    }
}

/// What is said to be clear is, up to the surface.
#[test]
fn clearances_are_kept() {
    for (name, fiber) in fibers() {
        let Surface::Scales(scales) = &fiber.surface else {
            panic!("{name} is no ellipse");
        };
        let clearance = scales.clearance.as_ref().unwrap();
        let (mut inside, mut all) = (0, 0);
        for i in 0..40_000 {
            let mut rng = Rng::new(10, i);
            let mut even = |reach: f64| reach * (2.0 * rng.uniform() - 1.0);
            let [x, y] = [0; 2].map(|_| even(1.2 * scales.rho_max));
            let (clear, turn) = (clearance.at(x, y), even(TAU));
            let (sin, cos) = turn.sin_cos();
            let z = even(fiber.period_um());
            // Without the clearance itself.
            let depth = |p: DVec3| {
                let cell = scales.locate(p);
                scales.radius(cell, scales.across(cell.sector, p.x, p.y), p.z) - p.x.hypot(p.y)
            };
            let start = DVec3::new(x, y, z);
            let end = depth(start + clear.abs() * DVec3::new(cos, sin, 0.0));
            assert!(
                clear == 0.0 || clear.signum() * end > 0.0,
                "{name} at {start}: {clear}, {end}"
            );
            let at_start = depth(start) > 0.0;
            all += u32::from(at_start);
            inside += u32::from(clear > 0.0);
        }
        // Most of it is far from the surface.
        let share = f64::from(inside) / f64::from(all);
        assert!(share > 0.8, "{name}: {share}");
    }
}

/// Rabbit and hare: air in both bulges, farther from the flat axis than the waist is wide.
#[test]
fn rabbit_and_hare_have_dumb_bell_medullae() {
    for id in ["rabbit", "hare"] {
        let species = species::load(id, &[]).unwrap();
        let stations = species.classes[0].stations.iter();
        let mut waisted = 0;
        for station in stations.filter(|s| s.structure.section == Section::DumbBell) {
            let fiber = Fiber::build(&station.structure, 0).unwrap();
            let waist = radius(&fiber, 0.25 * TAU, 0.0, |p| fiber.is_in_medulla(p));
            // Of the ellipse through the waist, as far as voids of one shape for all would reach.
            let across = waist * fiber.structure().aspect;
            let (mut left, mut right, mut beyond, mut all) = (0, 0, 0, 0);
            for i in 0..40_000 {
                let p = somewhere(&fiber, &mut Rng::new(8, i));
                if fiber.region_at(p) == Region::Void {
                    let reach = 0.8 * fiber.structure().medulla.ratio * fiber.semi_axes_um()[0];
                    right += u32::from(p.x > reach);
                    left += u32::from(p.x < -reach);
                    beyond += u32::from((p.x / across).hypot(p.y / waist) > 1.0);
                    all += 1;
                }
            }
            assert!(left > 100 && right > 100, "{id}: {left} {right}");
            let share = f64::from(beyond) / f64::from(all);
            assert!(share > 0.05, "{id}: {share} beyond a waist of {waist}");
            waisted += 1;
        }
        assert!(waisted > 0);
    }
}
