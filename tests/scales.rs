//! Explicit scales bend lobes as they must and stay reciprocal.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use rayon::prelude::*;
use vair::bake::{End, Flight, Photon, Sides, fly};
use vair::fiber::Fiber;
use vair::math::frame;
use vair::species::{
    Cuticle, CuticlePattern, Medulla, MedullaKind, Section, Structure, pattern_names,
};

fn scaled(pattern: &str, height_um: f64, medulla: Medulla) -> Structure {
    Structure {
        diameter_um: 80.0,
        aspect: 1.0,
        ior: 1.55,
        cuticle: Cuticle {
            pattern: CuticlePattern::built_in(pattern).unwrap(),
            pitch_um: 9.0,
            height_um,
            around: 6,
            jitter: 0.2,
            roughness: 0.0,
            riser_roughness: 0.3,
            ..Default::default()
        },
        medulla,
        ..Default::default()
    }
}

fn no_medulla() -> Medulla {
    Medulla::default()
}

fn flights(fiber: &Fiber, sin_range: (f64, f64), photons: u64) -> Vec<Flight> {
    (0..photons)
        .into_par_iter()
        .map(|stream| {
            fly(
                fiber,
                &Photon {
                    seed: 11,
                    stream,
                    sin_range,
                    sides: Sides::ALL,
                },
                1000,
            )
        })
        .collect()
}

/// Mean of `theta_o + theta_q`, in degrees, of the photons that `keep` selects, with its error.
fn shift(flights: &[Flight], keep: impl Fn(&Flight, f64) -> bool) -> (f64, f64) {
    let shifts: Vec<f64> = flights
        .iter()
        .filter_map(|f| match f.end {
            End::Escaped(w) => {
                let phi = w.y.atan2(w.x).to_degrees().abs();
                let shift = (frame::theta_of(w) + f.theta()).to_degrees();
                (keep(f, phi) && shift.abs() < 40.0).then_some(shift)
            }
            _ => None,
        })
        .collect();
    let n = shifts.len() as f64;
    let mean = shifts.iter().sum::<f64>() / n;
    let variance = shifts.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n;
    (mean, (variance / n).sqrt())
}

/// R moves by 2 tilt cos(phi / 2) toward the root, TT by 2 (eta - 1) tilt and TRT by (4 eta - 2)
/// tilt toward the tip, to first order and up to risers and shadowing.
#[test]
fn tilted_scales_move_r_to_the_root_and_trt_to_the_tip() {
    let structure = scaled("coronal", 0.47, no_medulla());
    let tilt = (0.47f64 / 9.0).atan().to_degrees();
    let fiber = Fiber::build(&structure, 1).unwrap();
    let flights = flights(&fiber, (-0.02, 0.02), 1_000_000);
    let (back, e) = shift(&flights, |f, phi| f.events == 1 && phi < 30.0);
    assert!(
        (back + 2.0 * tilt).abs() < 0.35 * 2.0 * tilt + 4.0 * e,
        "R back: {back} +- {e}"
    );
    let (side, _) = shift(&flights, |f, phi| {
        f.events == 1 && (80.0..110.0).contains(&phi)
    });
    let (through, _) = shift(&flights, |f, phi| f.events == 1 && phi > 160.0);
    assert!(
        back < side && side < through,
        "cos(phi/2) law: {back} {side} {through}"
    );
    assert!(through.abs() < tilt, "R through: {through}");
    let (tt, e) = shift(&flights, |f, _| f.events == 2);
    assert!(tt > 0.5 * tilt && tt < 2.5 * tilt, "TT: {tt} +- {e}");
    let (trt, e) = shift(&flights, |f, _| f.events == 3);
    assert!(trt > 2.5 * tilt && trt < 6.5 * tilt, "TRT: {trt} +- {e}");
}

/// G4: the flux matrix over (inclination in, inclination out, azimuth) is symmetric. Photons leave
/// query directions uniform in solid angle and carry cos(theta_q): then both ways have the measure
/// S cos cos dw dw.
#[test]
fn explicit_geometry_is_reciprocal() {
    let ladder = Medulla {
        ratio: 0.6,
        kind: MedullaKind::Ladder {
            pitch_um: 9.0,
            septum_um: 2.0,
        },
        void_ior: 1.0003,
        pigment: 1.0,
        ..Default::default()
    };
    for (name, structure) in [
        ("scales", scaled("coronal", 0.5, no_medulla())),
        ("mosaic and ladder", scaled("mosaic", 0.5, ladder)),
        ("petals", scaled("lanceolate-petal", 0.5, no_medulla())),
        ("rows", scaled("pectinate", 0.5, no_medulla())),
    ] {
        let fiber = Fiber::build(&structure, 1).unwrap();
        const N: usize = 10;
        let bin = |theta: f64| (((theta.sin() + 1.0) * 0.5 * N as f64) as usize).min(N - 1);
        let mut sum = vec![(0.0f64, 0.0f64); N * N * 4];
        for flight in flights(&fiber, (-1.0, 1.0), 3_000_000) {
            let End::Escaped(w) = flight.end else {
                continue;
            };
            let phi = ((w.y.atan2(w.x).abs() / std::f64::consts::PI * 4.0) as usize).min(3);
            let cell = (bin(flight.theta()) * N + bin(frame::theta_of(w))) * 4 + phi;
            let weight = flight.theta().cos();
            sum[cell].0 += weight;
            sum[cell].1 += weight * weight;
        }
        let (mut chi2, mut freedom, mut difference, mut total, mut noise) =
            (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..N {
            for o in 0..i {
                for phi in 0..4 {
                    let (a, va) = sum[(i * N + o) * 4 + phi];
                    let (b, vb) = sum[(o * N + i) * 4 + phi];
                    if va + vb > 50.0 {
                        chi2 += (a - b).powi(2) / (va + vb);
                        freedom += 1.0;
                    }
                    difference += (a - b).powi(2);
                    noise += va + vb;
                    total += 0.5 * (a * a + b * b);
                }
            }
        }
        let excess = ((difference - noise).max(0.0) / total).sqrt();
        println!(
            "{name}: chi2 per cell {:.2}, excess {:.4}",
            chi2 / freedom,
            excess
        );
        assert!(
            excess < 0.01,
            "{name}: relative asymmetry {excess:.4} above the noise"
        );
    }
}

/// A clear fiber gives back every photon, whatever its scales: none absorbed, at most one in a
/// million lost.
#[test]
fn no_pattern_loses_light() {
    let shapes = [
        Section::Ellipse,
        Section::DumbBell,
        Section::ConcavoConvex { bend: 0.4 },
    ];
    let (mut photons, mut lost, mut truncated) = (0u64, 0u64, 0u64);
    for (i, name) in pattern_names().enumerate() {
        let mut structure = scaled(name, 0.5, no_medulla());
        structure.section = shapes[i % shapes.len()];
        structure.aspect = 1.8;
        structure.cuticle.around = 5;
        structure.cuticle.jitter = 1.0;
        structure.cuticle.roughness = 0.1;
        structure.cuticle.wear = 0.2;
        structure.cuticle.lifted = 0.05;
        let fiber = Fiber::build(&structure, 2).unwrap();
        for flight in flights(&fiber, (-1.0, 1.0), 60_000) {
            // A beam past the fiber is no photon.
            photons += u64::from(flight.end != End::Missed);
            lost += u64::from(flight.end == End::Lost);
            truncated += u64::from(flight.end == End::Truncated);
        }
    }
    println!("{photons} photons, {lost} lost, {truncated} beyond 1000 events");
    assert!(photons > 1_000_000);
    assert!(lost as f64 <= 1e-6 * photons as f64, "{lost} of {photons}");
    assert!(truncated as f64 <= 1e-4 * photons as f64, "{truncated}");
}
