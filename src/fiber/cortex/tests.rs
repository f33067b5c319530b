//! The integral of the pigment against the density it is defined by.

use super::*;
use crate::fiber::section::Section;
use crate::math::frame::direction;
use crate::sampling::Rng;
use crate::species::{Cortex, Medulla, MedullaKind};
use glam::DVec3;

const RATIO: f64 = 0.4;

fn pigment(cortex: Cortex) -> (Section, Pigment) {
    let structure = Structure {
        cortex,
        medulla: Medulla {
            ratio: RATIO,
            kind: MedullaKind::Ladder {
                pitch_um: 9.0,
                septum_um: 2.0,
            },
            pigment: 1.5,
            ..Default::default()
        },
        ..Default::default()
    };
    let section = Section::new(80.0, 1.3);
    let semi = [section.a, section.b];
    let pigment = Pigment::new(&structure, (semi, &[1.0]), RATIO, 120.0, 9);
    (section, pigment)
}

/// Integral and what the density's definition says, over all chords of a fiber: along one, and the
/// means of both.
fn compare(cortex: Cortex, tolerance: f64) {
    let (section, pigment) = pigment(cortex);
    let (b, clear) = (cortex.toward_medulla, cortex.clear_rim);
    let density = |rho: f64| {
        let u = (rho - RATIO) / (1.0 - RATIO);
        if u > 1.0 - clear {
            0.0
        } else {
            1.0 + b * (1.0 - 2.0 * u)
        }
    };
    let n = 20_000;
    let rings = (0..n).map(|i| RATIO + (1.0 - RATIO) * (f64::from(i) + 0.5) / f64::from(n));
    let (mass, area) = rings.fold((0.0, 0.0), |(m, a), rho| (m + rho * density(rho), a + rho));
    let mean = mass / area;
    for i in 0..60 {
        let mut rng = Rng::new(2, i);
        let dir = direction(1.2 * (2.0 * rng.uniform() - 1.0), 6.3 * rng.uniform());
        let h = 2.0 * rng.uniform() - 1.0;
        let side = DVec3::new(-dir.y, dir.x, 0.0).normalize() * h;
        let at = DVec3::new(side.x * section.a, side.y * section.b, 50.0);
        let ray = section.unit_ray(at - 300.0 * dir, dir);
        let Some((t0, t1)) = ray.inside_circle(1.0) else {
            continue;
        };
        let ray = section.unit_ray(at + (t0 - 300.0) * dir, dir);
        let t = (t1 - t0) * (0.3 + 0.7 * rng.uniform());
        let sum: f64 = (0..n)
            .map(|k| {
                let p = ray.at(t * (f64::from(k) + 0.5) / f64::from(n));
                let rho = p.x.hypot(p.y);
                if rho < RATIO {
                    1.5
                } else {
                    density(rho) / mean
                }
            })
            .sum();
        let (got, expected) = (pigment.along(&ray, t, None), sum * t / f64::from(n));
        assert!(
            (got - expected).abs() < tolerance * t,
            "{cortex:?} {got} {expected}"
        );
    }
}

#[test]
fn the_integral_is_that_of_the_density_whose_mean_is_one() {
    for (toward_medulla, clear_rim) in [(0.0, 0.0), (0.6, 0.0), (-0.4, 0.0), (1.0, 0.3), (0.0, 0.2)]
    {
        let cortex = Cortex {
            toward_medulla,
            clear_rim,
            ..Default::default()
        };
        compare(cortex, 1e-3);
        // Streaks without contrast take the other way to the same, but for the density within a
        // streak's width.
        let streaks = 1e-9;
        compare(Cortex { streaks, ..cortex }, 0.01);
    }
}

#[test]
fn streaks_scatter_about_the_mean_and_close_after_a_period() {
    let (section, pigment) = pigment(Cortex {
        streaks: 0.5,
        ..Default::default()
    });
    let (mut sum, mut length, mut unlike) = (0.0, 0.0, 0);
    for i in 0..4000 {
        let mut rng = Rng::new(4, i);
        let dir = direction(0.0, 6.3 * rng.uniform());
        let z = 120.0 * rng.uniform();
        let off = DVec3::new(-dir.y, dir.x, 0.0) * 60.0 * (rng.uniform() - 0.5);
        let along = |z: f64| {
            let ray = section.unit_ray(off + DVec3::Z * z, dir);
            let (_, leave) = ray.inside_circle(RATIO).unwrap_or((0.0, 0.0));
            let (_, out) = ray.inside_circle(1.0)?;
            let ray = section.unit_ray(off + DVec3::Z * z + leave.max(0.0) * dir, dir);
            let t = out - leave.max(0.0);
            Some((pigment.along(&ray, t, None), t))
        };
        if let (Some((p, t)), Some((q, _))) = (along(z), along(z + 120.0)) {
            assert!((p - q).abs() < 1e-6, "{p} {q}");
            sum += p;
            length += t;
            unlike += u32::from((p / t - 1.0).abs() > 0.02);
        }
    }
    assert!((sum / length - 1.0).abs() < 0.03, "{}", sum / length);
    assert!(unlike > 1000, "{unlike}");
}
