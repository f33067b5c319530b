//! What a groom promises, on plain skins.

use super::*;
use crate::progress::Silent;
use crate::skin;
use crate::species::{
    ClassGroom, Cuticle, CuticlePattern, HairClass, Medulla, MedullaKind, PigmentBand, Station,
    Structure,
};
use glam::Vec2;
use std::collections::HashMap;

fn class(name: &str, groom: ClassGroom) -> HairClass {
    HairClass {
        name: name.to_owned(),
        stations: vec![Station {
            at: 0.5,
            structure: Structure {
                diameter_um: groom.diameter_um,
                aspect: 1.0,
                ior: 1.55,
                cuticle: Cuticle {
                    pattern: CuticlePattern::Smooth,
                    pitch_um: 9.0,
                    height_um: 0.5,
                    around: 6,
                    jitter: 0.0,
                    roughness: 0.1,
                    riser_roughness: 0.3,
                    ..Default::default()
                },
                medulla: Medulla {
                    ratio: 0.0,
                    kind: MedullaKind::None,
                    void_ior: 1.0003,
                    pigment: 0.0,
                    ..Default::default()
                },
                ..Default::default()
            },
        }],
        pigment: vec![PigmentBand {
            to_mm: f64::INFINITY,
            softness_mm: 0.0,
            eumelanin: 0.1,
            pheomelanin: 0.5,
            dye: None,
        }],
        groom,
    }
}

/// A fox's coat, numbers as in the literature on canids.
pub(super) fn fox() -> Species {
    let guard = ClassGroom {
        density_per_cm2: 385.0,
        length_mm: 50.0,
        length_sigma: 0.12,
        diameter_um: 75.0,
        diameter_sigma: 0.1,
        stalk: 0.5,
        shield: [0.1, 0.6],
        taper_from: 0.7,
        emergence_deg: 40.0,
        bend_deg: 30.0,
        gravity: 1.0,
        stray_deg: 6.0,
        roll_deg: 90.0,
        crimp_mm: 0.0,
        crimp_wavelength_mm: 2.0,
        curl_mm: 0.0,
        curl_pitch_mm: 10.0,
        frizz_mm: 0.0,
        trim_mm: f64::INFINITY,
        wet: 0.0,
        clump: 0.2,
        clump_mm: 4.0,
        vary: Vec::new(),
    };
    let under = ClassGroom {
        density_per_cm2: 9615.0,
        length_mm: 30.0,
        length_sigma: 0.2,
        diameter_um: 20.0,
        stray_deg: 12.0,
        crimp_mm: 0.2,
        clump: 0.3,
        ..guard.clone()
    };
    Species {
        id: "fox".to_owned(),
        name: "Fox".to_owned(),
        latin: String::new(),
        family: String::new(),
        group: String::new(),
        synonyms: Vec::new(),
        summary: String::new(),
        classes: vec![class("guard", guard), class("under", under)],
        skin_color: [0.5; 3],
        groom: Default::default(),
        coat: None,
        text: String::new(),
    }
}

pub(super) fn grown(skin: &Skin, species: &Species, strands: usize, seed: u64) -> Groom {
    let settings = GroomSettings {
        strands: Some(strands),
        seed,
    };
    grow(skin, species, &settings, &Silent, &Cancel::default()).unwrap()
}

#[test]
fn a_thin_groom_is_a_subset_of_a_dense_one() {
    let skin = skin::load("swatch").unwrap();
    let dense = grown(&skin, &fox(), 20_000, 3);
    let thin = grown(&skin, &fox(), 2_000, 3);
    assert_eq!((dense.strands(), thin.strands()), (20_000, 2_000));
    let by_id: HashMap<u32, usize> = dense
        .id
        .iter()
        .enumerate()
        .map(|(i, &id)| (id, i))
        .collect();
    assert_eq!(by_id.len(), dense.strands(), "ids are unique");
    for i in 0..thin.strands() {
        let other = by_id[&thin.id[i]];
        assert_eq!(thin.strand(i), dense.strand(other));
        assert_eq!(thin.class[i], dense.class[other]);
    }
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let skin = skin::load("ball").unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| grown(&skin, &fox(), 30_000, 1))
    };
    let one = on(1);
    assert!(one == on(2));
    assert!(one == on(7));
    assert!(one != grown(&skin, &fox(), 30_000, 2), "the seed matters");
}

/// Distance of each root to its nearest neighbor of the same class.
pub(super) fn nearest_distances(roots: &[Vec3], reach: f32) -> Vec<f32> {
    let cell = |p: Vec3| (p / reach).floor().as_ivec3();
    let mut grid: HashMap<glam::IVec3, Vec<usize>> = HashMap::new();
    for (i, p) in roots.iter().enumerate() {
        grid.entry(cell(*p)).or_default().push(i);
    }
    let around = |i: usize| {
        let home = cell(roots[i]);
        (0..27)
            .map(move |k| home + glam::IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1))
            .filter_map(|c| grid.get(&c))
            .flatten()
            .filter(move |&&j| j != i)
            .map(move |&j| roots[i].distance(roots[j]))
            .fold(f32::INFINITY, f32::min)
    };
    (0..roots.len()).map(around).collect()
}

fn roots(groom: &Groom, class: u8) -> Vec<Vec3> {
    (0..groom.strands())
        .filter(|&i| groom.class[i] == class)
        .map(|i| groom.strand(i)[0])
        .collect()
}

/// Blue noise: no two roots close together, no holes, for the whole and for every prefix. Of random
/// points some pair is at 0.01 of the hexagonal distance, and the mean is at 0.47.
#[test]
fn roots_are_blue_noise_at_every_density() {
    let skin = skin::load("swatch").unwrap();
    let groom = grown(&skin, &fox(), 40_000, 5);
    let under = roots(&groom, 1);
    for count in [1_000, 3_700, 12_345, under.len()] {
        let hexagonal = (2.0 / 3f64.sqrt() * skin.area() / count as f64).sqrt() as f32;
        let distances = nearest_distances(&under[..count], 1.5 * hexagonal);
        let least = distances.iter().fold(f32::INFINITY, |a, &b| a.min(b)) / hexagonal;
        let mean = distances.iter().sum::<f32>() / count as f32 / hexagonal;
        let most = distances.iter().fold(0.0f32, |a, &b| a.max(b)) / hexagonal;
        assert!(least > 0.6, "{count}: least {least}");
        assert!((0.7..0.85).contains(&mean), "{count}: mean {mean}");
        assert!(most < 1.7, "{count}: most {most}");
    }
}

/// As many roots per area as the density factor says, in every part of the skin.
#[test]
fn roots_follow_the_density_map() {
    let mut skin = skin::load("swatch").unwrap();
    let side = |uv: Vec2| if uv.x < 0.5 { 0 } else { 1 };
    for (density, uv) in skin.density.iter_mut().zip(&skin.uvs) {
        *density = 0.25 + 0.75 * uv.x;
    }
    let groom = grown(&skin, &fox(), 30_000, 8);
    // The integral of 1/4 + 3/4 u over each half.
    let expected = [0.25 * 0.5 + 0.75 * 0.125, 0.25 * 0.5 + 0.75 * 0.375];
    let mut counts = [0.0, 0.0];
    for uv in &groom.root_uv {
        counts[side(*uv)] += 1.0;
    }
    for k in 0..2 {
        let share = counts[k] / groom.strands() as f64;
        let expected = expected[k] / (expected[0] + expected[1]);
        assert!(
            (share / expected - 1.0).abs() < 0.02,
            "half {k}: {share} for {expected}"
        );
    }
    skin.density.fill(0.0);
    let refused = grow(
        &skin,
        &fox(),
        &GroomSettings::default(),
        &Silent,
        &Cancel::default(),
    );
    assert!(matches!(refused, Err(GroomError::BareSkin { .. })));
}

#[test]
fn a_full_coat_has_the_species_density() {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    for class in &mut species.classes {
        class.groom.density_per_cm2 *= 0.02;
    }
    let groom = grow(
        &skin,
        &species,
        &GroomSettings::default(),
        &Silent,
        &Cancel::default(),
    )
    .unwrap();
    for (k, class) in species.classes.iter().enumerate() {
        let count = roots(&groom, k as u8).len() as f64;
        let density = count / (skin.area() * 1e4);
        assert!((density / class.groom.density_per_cm2 - 1.0).abs() < 0.02);
        assert!(groom.width_scale[k] < 1.005, "nothing to compensate");
    }
}

#[test]
fn strands_start_on_the_skin_and_leave_it() {
    for name in ["ball", "swatch", "body"] {
        let skin = skin::load(name).unwrap();
        let groom = grown(&skin, &fox(), 8_000, 2);
        let surface = Surface::new(&skin).unwrap();
        for class in 0..2u8 {
            let count = roots(&groom, class).len();
            let seed = follicle::class_seed(2, class as usize);
            let follicles = surface.scatter(seed, count, &Silent, &Cancel::default());
            let strands = (0..groom.strands()).filter(|&i| groom.class[i] == class);
            for (i, follicle) in strands.zip(follicles.unwrap().follicles) {
                let root = surface.root(&follicle);
                let strand = groom.strand(i);
                assert_eq!(strand[0], root.position);
                let first = strand[1] - strand[0];
                // Spread and tufts tilt a hair, but it stays outside. Under the paws the ground
                // leaves no room.
                let pressed = skin.floor.is_some_and(|floor| strand[0].y < floor + 0.005);
                assert!(
                    pressed || first.dot(root.normal) > 0.0,
                    "{name}: strand {i} dives"
                );
                assert!(strand.iter().all(|p| p.is_finite()));
            }
        }
        // Roots lie on the triangles: within the rounding of a coordinate.
        for i in (0..groom.strands()).step_by(97) {
            let distance = distance_to(&skin, groom.strand(i)[0]);
            assert!(distance < 1e-6, "{name}: {distance}");
        }
    }
}

/// Distance from `p` to the nearest triangle, by looking at all of them.
fn distance_to(skin: &Skin, p: Vec3) -> f64 {
    let to_segment = |a: glam::DVec3, b: glam::DVec3, p: glam::DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + t * (b - a))
    };
    (0..skin.triangles.len())
        .map(|i| {
            let [a, b, c] = skin.corners(i).map(|v| v.as_dvec3());
            let p = p.as_dvec3();
            let n = (b - a).cross(c - a);
            let inside = |u: glam::DVec3, v: glam::DVec3| n.dot((v - u).cross(p - u)) >= 0.0;
            if inside(a, b) && inside(b, c) && inside(c, a) {
                (p - a).dot(n).abs() / n.length()
            } else {
                to_segment(a, b, p)
                    .min(to_segment(b, c, p))
                    .min(to_segment(c, a, p))
            }
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn the_coat_stays_outside_the_body_and_above_the_ground() {
    let skin = skin::load("body").unwrap();
    let groom = grown(&skin, &fox(), 20_000, 4);
    let field = field::Field::new(&skin);
    let (mut inside, mut known) = (0, 0);
    for p in &groom.points {
        assert!(p.y > -0.002, "{p} is below the ground");
        if let Some(above) = field.above(*p) {
            known += 1;
            inside += usize::from(above.height < -0.001);
        }
    }
    assert!(inside * 100 < known, "{inside} of {known} points inside");
}

#[test]
fn lengths_and_widths_have_the_species_distribution() {
    let skin = skin::load("swatch").unwrap();
    let mut species = fox();
    for class in &mut species.classes {
        class.groom.clump = 0.0;
        class.groom.crimp_mm = 0.0;
    }
    let groom = grown(&skin, &species, 20_000, 6);
    for (k, class) in species.classes.iter().enumerate() {
        let of_class = || (0..groom.strands()).filter(|&i| groom.class[i] as usize == k);
        let lengths: Vec<f64> = of_class().map(|i| f64::from(groom.length[i])).collect();
        let n = lengths.len() as f64;
        let mean = lengths.iter().sum::<f64>() / n * 1e3;
        // Tufts and drift add their own variation; a swatch holds few tufts.
        let expected = class.groom.length_mm;
        assert!((mean / expected - 1.0).abs() < 0.04, "{mean} mm");
        let logs: Vec<f64> = lengths.iter().map(|l| (l * 1e3 / expected).ln()).collect();
        let middle = logs.iter().sum::<f64>() / n;
        let sigma = (logs.iter().map(|l| (l - middle).powi(2)).sum::<f64>() / n).sqrt();
        let low = class.groom.length_sigma;
        assert!(
            (0.9 * low..low + 0.06).contains(&sigma),
            "{sigma} for {low}"
        );

        let widest = |i: usize| {
            let range = groom.offsets[i] as usize..groom.offsets[i + 1] as usize;
            groom.widths[range].iter().fold(0.0f32, |a, &b| a.max(b))
        };
        let mean = of_class().map(|i| f64::from(widest(i))).sum::<f64>() / n * 1e6;
        let expected = class.groom.diameter_um * f64::from(groom.width_scale[k]);
        // Control points need not hit the widest place.
        assert!(
            (0.93..1.02).contains(&(mean / expected)),
            "{mean} um for {expected}"
        );
        for i in of_class().step_by(50) {
            let (from, to) = (groom.offsets[i] as usize, groom.offsets[i + 1] as usize);
            let widths = &groom.widths[from..to];
            assert!(widths.iter().all(|&w| w > 0.0));
            let (root, tip) = (widths[0] / widest(i), widths[widths.len() - 1] / widest(i));
            assert!(
                (root - class.groom.stalk as f32).abs() < 0.08,
                "stalk {root}"
            );
            assert!(tip < 0.15, "tip {tip}");
        }
    }
}

#[test]
fn what_cannot_grow_is_refused_in_words() {
    let swatch = skin::load("swatch").unwrap();
    let refuse = |skin: &Skin, species: &Species, strands: Option<usize>| {
        let settings = GroomSettings { strands, seed: 0 };
        let result = grow(skin, species, &settings, &Silent, &Cancel::default());
        let error = result.unwrap_err();
        assert_eq!(error.blame(), crate::blame::Blame::Input);
        error.to_string()
    };
    assert!(refuse(&swatch, &fox(), Some(0)).contains("0 strands"));
    assert!(refuse(&swatch, &fox(), Some(60_000_000)).contains("at most 50000000"));
    let mut bad = fox();
    bad.classes[1].groom.length_mm = 0.0;
    let message = refuse(&swatch, &bad, None);
    assert!(
        message.contains("`under`") && message.contains("length_mm is 0"),
        "{message}"
    );
    bad.classes[1].groom.length_mm = f64::NAN;
    assert!(refuse(&swatch, &bad, None).contains("NaN"));
    // All strands in one point: refused, not ground through.
    let mut point = swatch.clone();
    for p in &mut point.positions {
        *p = Vec3::splat(0.1) + *p * 1e-6;
    }
    assert!(refuse(&point, &fox(), Some(10_000_000)).contains("apart"));
    let cancel = Cancel::default();
    cancel.cancel();
    let stopped = grow(&swatch, &fox(), &GroomSettings::default(), &Silent, &cancel);
    assert_eq!(
        stopped.unwrap_err().blame(),
        crate::blame::Blame::Interrupted
    );
}

#[test]
fn flat_hairs_lie_with_their_flat_side_to_the_skin() {
    let skin = crate::skin::load("ball").unwrap();
    for (roll_deg, flat) in [(0.0, true), (10.0, true), (90.0, false)] {
        let mut species = fox();
        for class in &mut species.classes {
            class.groom.roll_deg = roll_deg;
        }
        let groom = grown(&skin, &species, 2000, 1);
        assert_eq!(groom.normal.len(), groom.strands());
        let mut up = 0.0;
        for (i, normal) in groom.normal.iter().enumerate() {
            let points = groom.strand(i);
            let along = (points[1] - points[0]).normalize();
            assert!(normal.is_normalized() && normal.dot(along).abs() < 1e-5);
            // The skin's normal across the hair. The ball is round about the height of its center.
            let out = points[0].normalize_or(along);
            let out = (out - along * out.dot(along)).normalize_or(along);
            up += normal.dot(out).abs() / groom.strands() as f32;
        }
        // Any way round the mean is 2 / pi; a spread of 10 degrees leaves 0.985.
        assert_eq!(up > 0.95, flat, "{roll_deg}: {up}");
        assert!(
            flat || (up - 2.0 / std::f32::consts::PI).abs() < 0.03,
            "{up}"
        );
    }
}

#[test]
fn roots_know_their_triangle_and_the_forecast_its_size() {
    let (skin, fox) = (skin::load("ball").unwrap(), fox());
    let groom = grown(&skin, &fox, 2_000, 3);
    for i in 0..groom.strands() {
        let [a, b, c] = skin.corners(groom.root_triangle[i] as usize);
        let [u, v] = groom.root_barycentric[i].to_array();
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0);
        let root = a * (1.0 - u - v) + b * u + c * v;
        assert!(root.distance(groom.strand(i)[0]) < 1e-5, "strand {i}");
    }
    let forecast = forecast(&skin, &fox, Some(2_000)).unwrap();
    assert_eq!(forecast.strands, groom.strands());
    assert_eq!(forecast.points, groom.points.len());
}
