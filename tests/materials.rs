//! Metal, Lambert, layered and colored fibers against closed forms that share no code with the
//! program.
//!
//! A ray that meets a smooth circular cylinder at inclination theta and offset `h = sin gamma` has an
//! angle of incidence whose cosine is `cos theta cos gamma`; offsets are uniform.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod closed_form;

use closed_form::{energies, over_bin};
use std::f64::consts::{FRAC_PI_2, PI};
use vair::bake::{End, Flight, Photon, Settings, Sides, bake, find_or_bake, fly};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{
    Boundary, Cuticle, CuticlePattern, Filling, Material, Materials, Medulla, MedullaKind,
    Structure,
};
use vair::table::{Provenance, StructureTable, Undyed};

const EVENTS: u32 = 1000;

fn of_cuticle(boundary: Boundary) -> Materials {
    Materials {
        cuticle: Material {
            boundary,
            ..Material::default()
        },
        ..Materials::default()
    }
}

fn cylinder(materials: Materials) -> Structure {
    Structure {
        materials,
        ..Structure::default()
    }
}

/// Scales and air: light meets walls many times.
fn shaggy(materials: Materials) -> Structure {
    Structure {
        cuticle: Cuticle {
            pattern: CuticlePattern::built_in("mosaic").unwrap(),
            pitch_um: 9.0,
            height_um: 1.5,
            around: 6,
            jitter: 1.0,
            roughness: 0.2,
            riser_roughness: 0.4,
            ..Cuticle::default()
        },
        medulla: Medulla {
            ratio: 0.6,
            kind: MedullaKind::Ladder {
                pitch_um: 9.0,
                septum_um: 3.0,
            },
            ..Medulla::default()
        },
        materials,
        ..Structure::default()
    }
}

/// Flights whose query direction has just about this inclination.
fn flights(structure: &Structure, theta: f64, count: u64) -> Vec<Flight> {
    let fiber = Fiber::build(structure, 0).unwrap();
    let sin = theta.sin();
    let photon = |stream| Photon {
        seed: 7,
        stream,
        sin_range: (sin - 1e-9, sin + 1e-9),
        sides: Sides::ALL,
    };
    (0..count)
        .map(|i| fly(&fiber, &photon(i), EVENTS))
        .collect()
}

/// Sum of what left, by a number in 0..1 that a direction has.
fn histogram<const N: usize>(flights: &[Flight], place: impl Fn(glam::DVec3) -> f64) -> [f64; N] {
    let mut bins = [0.0; N];
    for flight in flights {
        if let End::Escaped(w) = flight.end {
            let bin = (place(w) * N as f64) as usize;
            bins[bin.min(N - 1)] += flight.share / flights.len() as f64;
        }
    }
    bins
}

/// |azimuth| over pi: 0 is back to the light.
fn azimuth(w: glam::DVec3) -> f64 {
    w.y.atan2(w.x).abs() / PI
}

/// Asserts that every bin holds the integral of `density` over it, to five standard errors.
fn assert_bins(found: &[f64], photons: u64, density: impl Fn(f64) -> f64, what: &str) {
    const STEPS: usize = 200;
    let width = 1.0 / (found.len() * STEPS) as f64;
    for (bin, &share) in found.iter().enumerate() {
        let middle = |step: usize| (((bin * STEPS + step) as f64) + 0.5) * width;
        let expected: f64 = (0..STEPS).map(|s| density(middle(s)) * width).sum();
        let sigma = (expected.max(1e-6) / photons as f64).sqrt();
        assert!(
            (share - expected).abs() < 5.0 * sigma,
            "{what}, bin {bin}: {share} against {expected} +- {sigma}"
        );
    }
}

/// Raw: the filter of noise decides cell by cell, and rounding may tip a decision.
fn settings(photons: u64) -> Settings {
    Settings {
        photons,
        reconstruct: false,
        ..Settings::cone()
    }
}

fn table(structure: &Structure, photons: u64) -> StructureTable {
    let settings = settings(photons);
    let fiber = Fiber::build(structure, 0).unwrap();
    let baked = bake(
        &fiber,
        &settings,
        Provenance::default(),
        &Silent,
        &Cancel::default(),
    );
    baked.unwrap().table
}

fn undyed(structure: &Structure, photons: u64) -> Undyed {
    let settings = settings(photons);
    let cancel = Cancel::default();
    let provenance = Provenance::default();
    find_or_bake(structure, &settings, provenance, None, &Silent, &cancel)
        .unwrap()
        .table
}

fn assert_balance(table: &StructureTable) {
    for l in &table.ledger {
        assert_eq!(l.emitted, l.escaped + l.absorbed + l.truncated + l.lost);
    }
}

/// Reflectance of a conductor by Snell's law in complex numbers: `q = sqrt((n + ik)^2 - sin^2)`.
fn conductor(cos: f64, n: f64, k: f64) -> f64 {
    let mul = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let norm = |a: (f64, f64)| a.0 * a.0 + a.1 * a.1;
    let square = mul((n, k), (n, k));
    let under = (square.0 - (1.0 - cos * cos), square.1);
    let (length, angle) = (norm(under).sqrt().sqrt(), 0.5 * under.1.atan2(under.0));
    let q = (length * angle.cos(), length * angle.sin());
    let s = norm((cos - q.0, -q.1)) / norm((cos + q.0, q.1));
    let e = (square.0 * cos, square.1 * cos);
    let p = norm((e.0 - q.0, e.1 - q.1)) / norm((e.0 + q.0, e.1 + q.1));
    0.5 * (s + p)
}

#[test]
fn a_metal_cylinder_reflects_by_fresnel_in_every_direction() {
    // Gold, green.
    let (n, k) = (0.43, 2.46);
    let gold = cylinder(of_cuticle(Boundary::Metal {
        index: [n; 3],
        extinction: [k; 3],
    }));
    let count = 200_000;
    for degrees in [0.0f64, 40.0, 75.0] {
        let theta = degrees.to_radians();
        let all = flights(&gold, theta, count);
        for flight in &all {
            let End::Escaped(w) = flight.end else {
                panic!("{flight:?}");
            };
            assert_eq!(flight.events, 1);
            assert!((w.z.asin() + theta).abs() < 1e-6);
        }
        // At phi the ray was at offset sin(phi / 2): both signs, d|phi| / pi.
        let density = |x: f64| {
            let half = 0.5 * PI * x;
            0.5 * PI * half.cos() * conductor(theta.cos() * half.cos(), n, k)
        };
        let bins: [f64; 24] = histogram(&all, azimuth);
        assert_bins(&bins, count, density, &format!("gold at {degrees}"));
    }
    let table = table(&gold, 800_000);
    assert_balance(&table);
    for node in 0..table.nodes.len() {
        let (from, to) = (table.nodes.edges[node], table.nodes.edges[node + 1]);
        let expected = over_bin(from, to, |theta| {
            let mut sum = 0.0;
            const STEPS: usize = 400;
            for i in 0..STEPS {
                let gamma = FRAC_PI_2 * (i as f64 + 0.5) / STEPS as f64;
                sum += conductor(theta.cos() * gamma.cos(), n, k) * gamma.cos();
            }
            sum * FRAC_PI_2 / STEPS as f64
        });
        let found = table.albedo(node, 0);
        assert!(
            (found - expected).abs() < 1e-3,
            "node {node}: {found} {expected}"
        );
    }
}

#[test]
fn a_lambert_cylinder_has_the_known_lobe() {
    let white = cylinder(of_cuticle(Boundary::Diffuse { albedo: [0.5; 3] }));
    let count = 400_000;
    for degrees in [0.0f64, 50.0] {
        let all = flights(&white, degrees.to_radians(), count);
        assert!(all.iter().all(|f| f.share == 0.5 && f.events == 1));
        let bins: [f64; 16] = histogram(&all, azimuth);
        // ((pi - phi) cos phi + sin phi) / 8 on both sides, times the albedo.
        let across = |x: f64| {
            let phi = PI * x;
            0.5 * PI * ((PI - phi) * phi.cos() + phi.sin()) / 4.0
        };
        assert_bins(&bins, count, across, "azimuth");
        // And 2 / pi cos^2 along, whatever the incidence.
        let bins: [f64; 16] = histogram(&all, |w| 0.5 + w.z.asin() / PI);
        let along = |x: f64| 0.5 * PI * (2.0 / PI) * ((x - 0.5) * PI).cos().powi(2);
        assert_bins(&bins, count, along, "inclination");
    }
}

#[test]
fn white_walls_keep_all_light() {
    let white = Boundary::Diffuse { albedo: [1.0; 3] };
    let surface = shaggy(of_cuticle(white));
    let voids = shaggy(Materials {
        void: Material {
            boundary: white,
            ..Material::default()
        },
        ..Materials::default()
    });
    let mirror = shaggy(of_cuticle(Boundary::Metal {
        index: [1.0; 3],
        extinction: [1e6; 3],
    }));
    for structure in [surface, voids, mirror] {
        let table = table(&structure, 400_000);
        assert_balance(&table);
        for node in 0..table.nodes.len() {
            let albedo = table.albedo(node, 0);
            assert!((albedo - 1.0).abs() < 1e-3, "node {node}: {albedo}");
        }
    }
}

#[test]
fn dark_walls_balance_the_books() {
    let dark = |albedo: f64| {
        let boundary = Boundary::Diffuse {
            albedo: [albedo; 3],
        };
        let table = table(&shaggy(of_cuticle(boundary)), 200_000);
        assert_balance(&table);
        table
    };
    let (half, black) = (dark(0.5), dark(0.0));
    for node in 0..half.nodes.len() {
        assert_eq!(black.albedo(node, 0), 0.0);
        assert_eq!(
            black.ledger(node, 0).absorbed,
            black.ledger(node, 0).emitted
        );
        // Scales overlap: some light is reflected twice or more.
        let albedo = half.albedo(node, 0);
        assert!((0.35..0.5).contains(&albedo), "node {node}: {albedo}");
    }
}

#[test]
fn layers_pass_straight_or_reflect() {
    // Layers of keratin round air: what passes both walls goes on undeflected.
    for layers in [1.0, 0.5, 3.0] {
        let shell = Structure {
            ior: 1.0,
            ..cylinder(of_cuticle(Boundary::Slab {
                layers,
                index: [1.55; 3],
            }))
        };
        let stack = |r: f64| {
            let slab = r + (1.0 - r).powi(2) * r / (1.0 - r * r);
            layers * slab / (1.0 + (layers - 1.0) * slab)
        };
        let reflectance = |cos: f64| {
            let sin_t = (1.0 - cos * cos).sqrt() / 1.55;
            let cos_t = (1.0 - sin_t * sin_t).sqrt();
            let s = ((cos - 1.55 * cos_t) / (cos + 1.55 * cos_t)).powi(2);
            let p = ((1.55 * cos - cos_t) / (1.55 * cos + cos_t)).powi(2);
            0.5 * (stack(s) + stack(p))
        };
        let theta = 0.4f64;
        let count = 200_000;
        let all = flights(&shell, theta, count);
        let mut straight = 0.0;
        for flight in &all {
            let End::Escaped(w) = flight.end else {
                panic!("{flight:?}");
            };
            straight += f64::from(u8::from(azimuth(w) > 1.0 - 1e-9)) / count as f64;
        }
        const STEPS: usize = 4000;
        let mut expected = 0.0;
        for i in 0..STEPS {
            let gamma = FRAC_PI_2 * (i as f64 + 0.5) / STEPS as f64;
            let pass = 1.0 - reflectance(theta.cos() * gamma.cos());
            expected += pass * pass * gamma.cos() * FRAC_PI_2 / STEPS as f64;
        }
        let sigma = (expected * (1.0 - expected) / count as f64).sqrt();
        assert!(
            (straight - expected).abs() < 4.0 * sigma,
            "{layers} layers: {straight} {expected}"
        );
    }
}

#[test]
fn dispersion_moves_the_lobes_of_each_channel() {
    let index = [1.45, 1.55, 1.7];
    let prism = cylinder(Materials {
        cortex: Material {
            filling: Filling {
                index: Some(index),
                ..Filling::default()
            },
            ..Material::default()
        },
        ..Materials::default()
    });
    let Undyed::Colored(tables) = undyed(&prism, 800_000) else {
        panic!("it is colored");
    };
    let last = tables[0].levels.len() - 1;
    let photons = 50_000.0;
    for (table, eta) in tables.iter().zip(index) {
        let plain = Structure {
            ior: eta,
            ..Structure::default()
        };
        assert_eq!(table.flux, self::table(&plain, 800_000).flux);
        for node in 2..14 {
            let (from, to) = (table.nodes.edges[node], table.nodes.edges[node + 1]);
            // Only R is left at the last level.
            let expected = over_bin(from, to, |theta| energies(eta, theta, 0.0)[0]);
            let found = table.albedo(node, last);
            let sigma = (expected / photons).sqrt();
            assert!(
                (found - expected).abs() < 4.0 * sigma,
                "{eta} {node}: {found}"
            );
        }
    }
    // The caustic of TRT narrows with the index: more of its light comes straight back.
    let maps = undyed(&prism, 800_000).dye([0.0; 3]).unwrap();
    assert_eq!((maps.bakes(), maps.ledger.len()), (3, 48));
    maps.check().unwrap();
    let back = |c: usize| -> f64 {
        let mut sum = 0.0;
        for (texel, rgb) in maps.map(8).iter().enumerate() {
            let w = closed_form::direction(maps.res, texel, 0.5, 0.5);
            if w[1].atan2(w[0]).abs() < 10f64.to_radians() {
                sum += f64::from(rgb[c]);
            }
        }
        sum
    };
    assert!(
        back(0) < back(1) && back(1) < back(2),
        "{} {} {}",
        back(0),
        back(1),
        back(2)
    );
}

#[test]
fn absorption_of_the_cortex_is_what_dye_makes_of_pigment() {
    let a = 0.012;
    let absorbing = |rgb: [f64; 3]| Materials {
        cortex: Material {
            filling: Filling {
                absorption_per_um: rgb,
                ..Filling::default()
            },
            ..Material::default()
        },
        ..Materials::default()
    };
    let plain = undyed(&shaggy(Materials::default()), 400_000);
    let dyed = plain.dye([a, 0.0, 2.0 * a]).unwrap();
    let colored = undyed(&shaggy(absorbing([a, 0.0, 2.0 * a])), 400_000);
    assert!(matches!(colored, Undyed::Colored(_)));
    let colored = colored.dye([0.0; 3]).unwrap();
    for node in 0..dyed.nodes.len() {
        let (found, expected) = (colored.albedo(node), dyed.albedo(node));
        for c in 0..3 {
            // The same paths; what is left is the error of dyeing between levels, below half a percent.
            let off = (found[c] - expected[c]).abs();
            assert!(off < 2e-3, "node {node} {c}: {} {}", found[c], expected[c]);
        }
    }
    // A color that cannot be told from gray: three bakes give what one gives.
    let gray = undyed(&shaggy(absorbing([a; 3])), 100_000);
    let nearly = undyed(&shaggy(absorbing([a, a, a + 1e-12])), 100_000);
    assert!(matches!(gray, Undyed::Gray(_)) && matches!(nearly, Undyed::Colored(_)));
    let pigment = [0.001, 0.004, 0.02];
    let (gray, nearly) = (gray.dye(pigment).unwrap(), nearly.dye(pigment).unwrap());
    for (a, b) in gray.rgb.iter().flatten().zip(nearly.rgb.iter().flatten()) {
        assert!((a - b).abs() <= 1e-6 * a.max(1e-6), "{a} {b}");
    }
}

#[test]
fn fog_in_any_part_loses_nothing() {
    let fog = |scattering: f64| Material {
        filling: Filling {
            scattering_per_um: Some([scattering; 3]),
            asymmetry: Some(0.4),
            ..Filling::default()
        },
        ..Material::default()
    };
    let foggy = shaggy(Materials {
        cortex: fog(0.02),
        void: fog(0.05),
        ..Materials::default()
    });
    let outline = Structure {
        medulla: Medulla {
            ratio: 0.6,
            kind: MedullaKind::Medium {
                scattering_per_um: 0.1,
                asymmetry: 0.5,
            },
            ..Medulla::default()
        },
        ..shaggy(Materials {
            cortex: fog(0.02),
            medulla: Material {
                filling: Filling {
                    index: Some([1.2; 3]),
                    ..Filling::default()
                },
                ..Material::default()
            },
            ..Materials::default()
        })
    };
    for structure in [foggy, outline] {
        let table = table(&structure, 400_000);
        assert_balance(&table);
        for node in 0..table.nodes.len() {
            let ledger = table.ledger(node, 0);
            let albedo = table.albedo(node, 0);
            assert!(ledger.lost <= ledger.emitted / 1_000_000, "{ledger:?}");
            assert!(albedo > 1.0 - 1e-3, "node {node}: {albedo}");
        }
    }
}

#[test]
fn the_example_species_are_sound_and_colored() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/species");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let species = vair::species::load(path.to_str().unwrap(), &[]).unwrap();
            let structure = &species.classes[0].stations[0].structure;
            assert!(structure.is_colored(), "{}", path.display());
            Fiber::build(structure, 0).unwrap();
            seen += 1;
        }
    }
    assert_eq!(seen, 3);
}
