//! What the literature has measured on hair, asked of the library's fibers: the reflected lobe, the
//! light through a medulla, the white of air, the shine of mohair, the fins of an otter.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic")]

use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;
use vair::bake::{End, Flight, Photon, Sides, fly};
use vair::fiber::{Fiber, Region};
use vair::math::frame;
use vair::species::{Continuity, MedullaKind, Structure, load};

/// Events after which no photon of these fibers is still inside.
const MAX_EVENTS: u32 = 4000;

/// The structure of a class of a built-in species at its station number `index`.
fn structure(species: &str, class: &str, index: usize) -> Structure {
    let species = load(species, &[]).unwrap();
    let class = species.classes.iter().find(|c| c.name == class).unwrap();
    class.stations[index].structure.clone()
}

/// Photons whose query direction is inclined by `theta_deg`, half a degree to either side.
fn flights(structure: &Structure, theta_deg: f64, photons: u64) -> Vec<Flight> {
    let fiber = Fiber::build(structure, 3).unwrap();
    let sin = |deg: f64| deg.to_radians().sin();
    let sin_range = (sin(theta_deg - 0.5), sin(theta_deg + 0.5));
    (0..photons)
        .into_par_iter()
        .map(|stream| {
            let photon = Photon {
                seed: 5,
                stream,
                sin_range,
                sides: Sides::ALL,
            };
            fly(&fiber, &photon, MAX_EVENTS)
        })
        .collect()
}

/// Direction of a photon that left.
fn escaped(flight: &Flight) -> Option<DVec3> {
    match flight.end {
        End::Escaped(w) => Some(w),
        _ => None,
    }
}

/// Azimuth against the query direction, degrees, 0 back .. 180 forward.
fn azimuth(w: DVec3) -> f64 {
    w.y.atan2(w.x).to_degrees().abs()
}

/// What a goniometer in the plane of incidence records of the light reflected at the surface.
struct Lobe {
    /// Inclination of the peak against the mirror's, `theta_o + theta_i`; negative toward the root.
    shift_deg: f64,
    /// Full width at half of the peak.
    width_deg: f64,
    /// Share of the incident light at the peak, per degree of inclination and radian of azimuth.
    peak: f64,
}

/// The lobe R at 40 degrees of incidence (Wortmann et al. 2003), the slit 15 degrees to either side.
fn reflected(structure: &Structure, photons: u64) -> Lobe {
    const BIN: f64 = 1.0;
    const BINS: usize = 80;
    const SLIT_DEG: f64 = 15.0;
    let mut bins = [0.0f64; BINS];
    for flight in flights(structure, 40.0, photons) {
        let Some(w) = escaped(&flight) else { continue };
        if azimuth(w) > SLIT_DEG {
            continue;
        }
        let shift = (frame::theta_of(w) + flight.theta()).to_degrees();
        let bin = shift / BIN + 0.5 * BINS as f64;
        if flight.events == 1 && (0.0..BINS as f64).contains(&bin) {
            bins[bin as usize] += 1.0;
        }
    }
    // A window of three bins: the statistical jitter of the peak's bin would bias its height.
    let smooth = |i: usize| (bins[i - 1] + bins[i] + bins[i + 1]) / 3.0;
    let top = (1..BINS - 1)
        .max_by(|&a, &b| smooth(a).total_cmp(&smooth(b)))
        .unwrap();
    let height = smooth(top);
    let at = |i: f64| (i + 0.5 - 0.5 * BINS as f64) * BIN;
    let crossing = |inner: usize, outer: usize| {
        let (a, b) = (smooth(inner), smooth(outer));
        let f = (a - 0.5 * height) / (a - b);
        at(inner as f64 + f * (outer as f64 - inner as f64))
    };
    let mut lo = top;
    while smooth(lo - 1) > 0.5 * height {
        lo -= 1;
    }
    let mut hi = top;
    while smooth(hi + 1) > 0.5 * height {
        hi += 1;
    }
    let (lo, hi) = (crossing(lo, lo - 1), crossing(hi, hi + 1));
    Lobe {
        // The middle of the upper half is steadier than the top bin.
        shift_deg: 0.5 * (lo + hi),
        width_deg: hi - lo,
        peak: height / BIN / (SLIT_DEG.to_radians() * 2.0) / photons as f64,
    }
}

fn tilt_deg(structure: &Structure) -> f64 {
    let cuticle = &structure.cuticle;
    (cuticle.height_um / cuticle.pitch_um).atan().to_degrees()
}

/// Twice the tilt toward the root, which is 2 to 2.5 degrees from reflection and 3.4 from the size of
/// the scales; 8 to 11.5 degrees wide (Wortmann et al. 2003).
#[test]
fn human_hair_reflects_a_lobe_of_8_to_12_degrees_moved_to_the_root() {
    let human = structure("human", "guard", 0);
    let lobe = reflected(&human, 300_000);
    let shift = -2.0 * tilt_deg(&human);
    assert!((-7.0..-4.0).contains(&lobe.shift_deg), "{}", lobe.shift_deg);
    assert!(
        (lobe.shift_deg - shift).abs() < 0.7,
        "{} for {shift}",
        lobe.shift_deg
    );
    assert!((8.0..12.0).contains(&lobe.width_deg), "{}", lobe.width_deg);
}

/// Light that leaves forward, as shares of all.
#[derive(Debug)]
struct Forward {
    /// Within 15 degrees of azimuth, whatever its inclination.
    side: f64,
    /// As well within 15 degrees of the specular cone.
    lobe: f64,
    /// Of that, in and out and nothing between.
    straight: f64,
}

fn forward(structure: &Structure) -> Forward {
    const PHOTONS: u64 = 20_000;
    let flights = flights(structure, 20.0, PHOTONS);
    let share = |counts: &dyn Fn(&Flight, f64) -> bool| {
        let counted = flights.iter().filter(|f| {
            escaped(f).is_some_and(|w| {
                let off_cone = (frame::theta_of(w) + f.theta()).to_degrees().abs();
                azimuth(w) > 165.0 && counts(f, off_cone)
            })
        });
        counted.count() as f64 / PHOTONS as f64
    };
    Forward {
        side: share(&|_, _| true),
        lobe: share(&|_, off_cone| off_cone < 15.0),
        straight: share(&|f, off_cone| off_cone < 15.0 && f.events == 2),
    }
}

/// "TT nearly gone" with a medulla of 0.8 or more, and what light there is goes everywhere (after Yan et
/// al. 2015). The light that meets no void, straight through, is told from what is scattered forward:
/// of light with no memory an even share of a twelfth comes within 15 degrees of azimuth.
#[test]
fn a_wide_medulla_puts_the_forward_lobe_out() {
    // Beyond its root, where the medulla is in pieces and light goes through the gaps.
    let mut froth = structure("polar-bear", "guard", 1);
    froth.medulla.ratio = 0.8;
    let fibers = [
        ("froth", froth),
        ("hare", structure("hare", "guard", 1)),
        ("deer", structure("deer", "guard", 0)),
    ];
    for (name, fiber) in fibers {
        assert!(fiber.medulla.ratio >= 0.8, "{name}");
        assert_eq!(fiber.medulla.continuity, Continuity::Continuous, "{name}");
        let solid = Structure {
            medulla: Default::default(),
            ..fiber.clone()
        };
        // The same cells full of keratin: it is the air that does it, not the shape of the fiber.
        let mut full = fiber.clone();
        full.medulla.void_ior = full.ior;
        let [air, full, solid] = [&fiber, &full, &solid].map(forward);
        eprintln!("{name}: {air:?} of {solid:?}, full {full:?}");
        // Straight through: past walls and between bubbles.
        let straight = air.straight / solid.straight;
        assert!(straight < 0.04, "{name}: {straight}");
        let lobe = air.lobe / solid.lobe;
        assert!(lobe < 0.15, "{name}: {lobe}");
        assert!(
            (air.side / (1.0 / 12.0) - 1.0).abs() < 0.5,
            "{name}: {air:?}"
        );
        assert!(
            (full.lobe / solid.lobe - 1.0).abs() < 0.05,
            "{name}: {full:?}"
        );
    }
}

/// Albedo of single hairs with a lattice, and how evenly they throw light around.
#[test]
fn white_hair_with_a_lattice_returns_nearly_all_light_all_around() {
    /// Keratin of white hair: pale yellow, per micrometer of R, G, B (an estimate).
    const KERATIN: [f64; 3] = [1e-4, 2e-4, 4e-4];
    const SECTORS: usize = 6;
    for (species, class) in [("caribou", "guard"), ("deer", "guard")] {
        let fiber = structure(species, class, 0);
        assert!(matches!(fiber.medulla.kind, MedullaKind::Lattice { .. }));
        let flights = flights(&fiber, 20.0, 20_000);
        let mut albedo = [0.0; 3];
        let mut sectors = [0.0; SECTORS];
        for flight in &flights {
            let Some(w) = escaped(flight) else { continue };
            for (sum, absorption) in albedo.iter_mut().zip(KERATIN) {
                *sum += (-absorption * flight.path_um).exp();
            }
            let sector = (azimuth(w) / 180.0 * SECTORS as f64) as usize;
            sectors[sector.min(SECTORS - 1)] += 1.0;
        }
        let n = flights.len() as f64;
        let albedo = albedo.map(|sum| sum / n);
        assert!(albedo[1] >= 0.97, "{species}: {albedo:?}");
        let even = n / SECTORS as f64;
        for sector in sectors {
            let ratio = sector / even;
            assert!((0.6..2.0).contains(&ratio), "{species}: {sectors:?}");
        }
    }
}

/// Wool and mohair have the same index and no medulla; their scales tilt by 4.6 and 0.9 degrees. The
/// lobe of the flatter scales is narrower, higher and nearer to the mirror direction, whichever
/// fiber bears them.
#[test]
fn mohair_outshines_wool_because_its_scales_lie_flat() {
    let wool = structure("sheep", "guard", 0);
    let mohair = structure("mohair", "guard", 0);
    assert!((tilt_deg(&wool) - 4.6).abs() < 0.1 && (tilt_deg(&mohair) - 0.9).abs() < 0.1);
    let with_scales_of = |fiber: &Structure, other: &Structure| {
        let mut traded = fiber.clone();
        traded.cuticle.pitch_um = other.cuticle.pitch_um;
        traded.cuticle.height_um = other.cuticle.height_um;
        traded
    };
    let traded = [
        with_scales_of(&mohair, &wool),
        with_scales_of(&wool, &mohair),
    ];
    for (steep, flat) in [(&wool, &mohair), (&traded[0], &traded[1])] {
        let lobes = [steep, flat].map(|fiber| reflected(fiber, 500_000));
        for (lobe, fiber) in lobes.iter().zip([steep, flat]) {
            let shift = lobe.shift_deg + 2.0 * tilt_deg(fiber);
            assert!(shift.abs() < 0.9, "{} off by {shift}", lobe.shift_deg);
        }
        let [steep, flat] = lobes;
        let peak = flat.peak / steep.peak;
        assert!(peak > 1.12, "peak {peak}");
        assert!(
            flat.width_deg < steep.width_deg,
            "width {} and {}",
            flat.width_deg,
            steep.width_deg
        );
    }
}

/// Radius of the surface at an azimuth and height, micrometers.
fn radius(fiber: &Fiber, turn: f64, z: f64) -> f64 {
    let (sin, cos) = (TAU * turn).sin_cos();
    let (mut inside, mut outside) = (0.0, 1.01 * fiber.bounding_radius_um());
    while outside - inside > 1e-3 {
        let r = 0.5 * (inside + outside);
        match fiber.region_at(DVec3::new(r * cos, r * sin, z)) {
            Region::Outside => outside = r,
            _ => inside = r,
        }
    }
    0.5 * (inside + outside)
}

/// Cosine and sine part of the `n`-th harmonic of a closed profile, over its mean.
fn harmonic(profile: &[f64], n: usize) -> [f64; 2] {
    let count = profile.len() as f64;
    let mean = profile.iter().sum::<f64>() / count;
    let part = |wave: fn(f64) -> f64| {
        let sum = (profile.iter().enumerate()).map(|(i, r)| r * wave(TAU * (n * i) as f64 / count));
        2.0 * sum.sum::<f64>() / count / mean
    };
    [part(f64::cos), part(f64::sin)]
}

/// Four fins a level, the next level turned by 45 degrees (Weisel et al. 2005).
#[test]
fn otter_wool_has_four_fins_a_level_and_turns_them_by_45_degrees() {
    const TURNS: usize = 96;
    const HEIGHTS_A_PITCH: usize = 8;
    let mut otter = structure("river-otter", "under", 0);
    otter.aspect = 1.0; // An oval section has a second harmonic of its own.
    assert_eq!(otter.cuticle.pattern.name(), "otter-fin");
    let fiber = Fiber::build(&otter, 3).unwrap();
    let pitch = otter.cuticle.pitch_um;
    let levels = (fiber.period_um() / pitch).round() as usize;
    let profiles: Vec<Vec<f64>> = (0..levels * HEIGHTS_A_PITCH)
        .into_par_iter()
        .map(|i| {
            let z = pitch * i as f64 / HEIGHTS_A_PITCH as f64;
            let turn = |k| k as f64 / TURNS as f64;
            (0..TURNS).map(|k| radius(&fiber, turn(k), z)).collect()
        })
        .collect();

    let all = || profiles.iter().flatten().copied();
    let mean = all().sum::<f64>() / all().count() as f64;
    let relief = (all().fold(0.0, f64::max) - all().fold(f64::INFINITY, f64::min)) / mean;

    let power = |n: usize| {
        let of = |p: &Vec<f64>| harmonic(p, n).iter().map(|x| x * x).sum::<f64>();
        profiles.iter().map(of).sum::<f64>()
    };
    let powers: Vec<f64> = (1..=8).map(power).collect();

    // A turn of 45 degrees reverses the fourth harmonic: levels next to each other are opposite.
    let fourth: Vec<[f64; 2]> = profiles.iter().map(|p| harmonic(p, 4)).collect();
    let correlation = |lag: usize| {
        let n = fourth.len();
        let product = |i: usize| {
            let (a, b) = (fourth[i], fourth[(i + lag * HEIGHTS_A_PITCH) % n]);
            a[0] * b[0] + a[1] * b[1]
        };
        (0..n).map(product).sum::<f64>() / powers[3]
    };
    assert!((0.2..0.35).contains(&relief), "{relief}");
    for (n, power) in (1..).zip(&powers) {
        assert!(
            n == 4 || *power < 0.3 * powers[3],
            "harmonic {n}: {powers:?}"
        );
    }
    assert!(correlation(1) < -0.5, "{}", correlation(1));
    assert!(correlation(2) > 0.5, "{}", correlation(2));
}
