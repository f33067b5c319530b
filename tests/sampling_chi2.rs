//! Sampling agrees with its density: chi-squared tests of the table of every built-in species.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::Vec3;
use rayon::prelude::*;
use vair::bake::{Settings, bake};
use vair::bsdf::{
    AlongStrand, Bsdf, Chiang, ChiangParameters, DoubleCylinder, DoubleCylinderParameters,
    HairMaterial, Place, TableSet, Zone,
};
use vair::fiber::Fiber;
use vair::math::frame;
use vair::math::unicube::Unicube;
use vair::progress::{Cancel, Silent};
use vair::sampling::Rng;
use vair::species::{self, PigmentBand};
use vair::table::{Provenance, ScatterTable};

const SAMPLES: u64 = 300_000;

/// Cells of the histogram: a unicube of 8 x 8 a face. 384 cells of 800 samples each see an error of
/// 2 % in half of them with a probability of about 0.98; finer grids see less.
const CELLS: usize = 8;

/// Sub-points along a cell edge for the integral of the density: texels of a shifted map do not align
/// with cells, so the integral is a stratified random one. Where a sharp lobe puts many samples into
/// one cell, the integral has to be as sharp as they are: a strip of one texel along a cell's border is
/// off by a quarter at 48 points, seen in the glass cylinder.
const SUB: usize = 48;
const FINE_SUB: usize = 144;
const CROWDED: f64 = 100.0;

/// Expected samples in a cell.
fn expected(density: &impl Fn(Vec3) -> f32, cells: &Unicube, cell: usize, sub: usize) -> f64 {
    let mut rng = Rng::new(sub as u64, cell as u64);
    let mut sum = 0.0;
    for i in 0..sub * sub {
        let a = ((i % sub) as f64 + rng.uniform()) / sub as f64;
        let b = ((i / sub) as f64 + rng.uniform()) / sub as f64;
        let (w, jacobian) = cells.direction(cell, a, b);
        sum += f64::from(density(w.as_vec3())) * jacobian;
    }
    sum / (sub * sub) as f64 * SAMPLES as f64
}

fn chi_squared(bsdf: &Bsdf<'_>, seed: u64, distort: impl Fn(Vec3) -> f32 + Sync) -> f64 {
    let cells = Unicube::new(CELLS);
    let density = |w: Vec3| bsdf.pdf(w) * distort(w);
    let expected: Vec<f64> = (0..cells.texels())
        .into_par_iter()
        .map(|cell| match expected(&density, &cells, cell, SUB) {
            e if e > CROWDED => expected(&density, &cells, cell, FINE_SUB),
            e => e,
        })
        .collect();
    let mut counts = vec![0u64; cells.texels()];
    let mut rng = Rng::new(seed ^ 0xabcd, 1);
    for _ in 0..SAMPLES {
        let u = [rng.uniform_f32(), rng.uniform_f32(), rng.uniform_f32()];
        let sample = bsdf.sample(u).unwrap();
        let pdf = bsdf.pdf(sample.wi);
        assert!(
            (pdf / sample.pdf - 1.0).abs() < 1e-3,
            "pdf {pdf} but sample says {}",
            sample.pdf
        );
        counts[cells.texel(sample.wi.as_dvec3())] += 1;
    }
    // Cells of small expectation are pooled.
    let (mut chi2, mut freedom) = (0.0f64, -1.0f64);
    let (mut pooled, mut pooled_count) = (0.0, 0.0);
    for (&e, &c) in expected.iter().zip(&counts) {
        if e < 20.0 {
            pooled += e;
            pooled_count += c as f64;
        } else {
            chi2 += (c as f64 - e).powi(2) / e;
            freedom += 1.0;
        }
    }
    if pooled > 5.0 {
        chi2 += (pooled_count - pooled).powi(2) / pooled;
        freedom += 1.0;
    }
    // Wilson and Hilferty: the cube root of chi2 / n is nearly normal.
    let n = freedom.max(1.0);
    ((chi2 / n).powf(1.0 / 3.0) - (1.0 - 2.0 / (9.0 * n))) / (2.0 / (9.0 * n)).sqrt()
}

fn table(structure: &vair::species::Structure, band: &PigmentBand, photons: u64) -> ScatterTable {
    let settings = Settings {
        photons,
        ..Settings::cone()
    };
    let fiber = Fiber::build(structure, 0).unwrap();
    let table = bake(
        &fiber,
        &settings,
        Provenance::default(),
        &Silent,
        &Cancel::default(),
    );
    ScatterTable::from(table.unwrap().table.dye(band.absorption_per_um()).unwrap())
}

fn place(tip_mm: f32) -> Place {
    Place {
        at: 0.5,
        tip_mm,
        part: 0,
        across: 0.0,
    }
}

/// 4.5 sigma: the whole file makes some 40 tests, a false alarm comes once in 7000 runs.
const LIMIT: f64 = 4.5;

#[test]
fn every_species_samples_what_its_density_says() {
    for name in ["red-fox", "polar-bear", "mink", "human", "glass-cylinder"] {
        let species = species::load(name, &[]).unwrap();
        for class in &species.classes {
            let structure = &class.stations.last().unwrap().structure;
            let tables: Vec<_> = class.pigment[..1]
                .iter()
                .map(|band| table(structure, band, 500_000))
                .collect();
            let zone = Zone {
                to_mm: f32::INFINITY,
                softness_mm: 0.0,
            };
            let set = TableSet::new(vec![1.0], vec![zone], tables).unwrap();
            let material = HairMaterial::Tables(set);
            for (i, theta) in [-1.45, -0.5, 0.11, 0.9].into_iter().enumerate() {
                let wo = frame::direction(theta, 0.0).as_vec3();
                let bsdf = material.at(place(3.0), wo, || 0.0, 0.5);
                let z = chi_squared(&bsdf, i as u64, |_| 1.0);
                assert!(
                    z < LIMIT,
                    "{name} {} theta {theta}: {z:.1} sigma",
                    class.name
                );
            }
        }
    }
}

/// Lobes of a flat hair at some azimuths, two of them seen mirrored.
#[test]
fn azimuths_sample_what_their_density_says() {
    let species = species::load("harbor-seal", &[]).unwrap();
    let class = &species.classes[0];
    let settings = Settings {
        photons: 200_000,
        azimuths: 3,
        bins: 8,
        face: 32,
        reconstruct: false,
        ..Settings::cone()
    };
    let fiber = Fiber::build(&class.stations[1].structure, 0).unwrap();
    let origin = Provenance::default();
    let baked = bake(&fiber, &settings, origin, &Silent, &Cancel::default()).unwrap();
    let maps = baked.table.dye(class.pigment[0].absorption_per_um());
    let table = ScatterTable::from(maps.unwrap());
    for (i, (theta, azimuth)) in [(0.11, 0.3), (0.9, 1.0), (-0.5, 2.0), (-1.2, -0.4)]
        .into_iter()
        .enumerate()
    {
        let wo = frame::direction(theta, 0.0).as_vec3();
        let bsdf = Bsdf::Table(table.lobe_at(wo, azimuth, 0.9));
        let z = chi_squared(&bsdf, i as u64, |_| 1.0);
        assert!(z < LIMIT, "theta {theta} azimuth {azimuth}: {z:.1} sigma");
        if azimuth == 2.0 {
            // The lobe of the other side would be found out.
            let other = Bsdf::Table(table.lobe_at(wo, -azimuth, 0.9));
            let mirrored = |w: Vec3| other.pdf(w) / bsdf.pdf(w).max(1e-9);
            let z = chi_squared(&bsdf, i as u64, mirrored);
            assert!(z > LIMIT, "mirrored: only {z:.1} sigma");
        }
    }
}

#[test]
fn a_density_off_by_two_percent_is_caught() {
    let species = species::load("human", &[]).unwrap();
    let class = &species.classes[0];
    let table = table(&class.stations[0].structure, &class.pigment[0], 500_000);
    let zone = Zone {
        to_mm: f32::INFINITY,
        softness_mm: 0.0,
    };
    let material = HairMaterial::Tables(TableSet::new(vec![0.0], vec![zone], vec![table]).unwrap());
    let wo = frame::direction(0.3, 0.0).as_vec3();
    let checker = |w: Vec3| {
        if (w.x > 0.0) ^ (w.y > 0.0) {
            1.02
        } else {
            0.98
        }
    };
    let z = chi_squared(&material.at(place(1.0), wo, || 0.0, 0.5), 9, checker);
    assert!(z > LIMIT, "only {z:.1} sigma");
}

#[test]
fn the_hair_model_samples_what_its_density_says() {
    for (beta_m, beta_n, sigma) in [(0.3, 0.3, 0.1), (0.12, 0.6, 1.0), (0.8, 0.15, 0.0)] {
        let model = Chiang::new(&ChiangParameters {
            sigma_a: Vec3::new(sigma, 2.0 * sigma, 4.0 * sigma),
            beta_m,
            beta_n,
            ..ChiangParameters::default()
        });
        let material = HairMaterial::Chiang(AlongStrand::uniform(model));
        agrees(&material, &format!("{beta_m} {beta_n}"));
    }
}

#[test]
fn the_double_cylinder_samples_what_its_density_says() {
    // Medulla, its scattering, share and mean cosine of what goes back.
    for (kappa, sigma_m_s, back_s, rho) in [
        (0.7, 2.0, 0.5, 0.3),
        (0.95, 9.0, 0.1, 0.9),
        (0.3, 0.5, 1.0, 0.0),
    ] {
        let model = DoubleCylinder::new(&DoubleCylinderParameters {
            kappa,
            sigma_m_s,
            back_s,
            rho_s: rho,
            rho_b: 0.5 * rho,
            ..DoubleCylinderParameters::default()
        });
        let material = HairMaterial::DoubleCylinder(AlongStrand::uniform(model));
        agrees(&material, &format!("{kappa} {sigma_m_s}"));
    }
}

/// A material's samples agree with its density from some directions, at some places across the strand.
fn agrees(material: &HairMaterial, name: &str) {
    let seen = [(0.1f64, 0.3), (-0.8, -0.9), (1.2, 0.0)];
    for (i, (theta, across)) in seen.into_iter().enumerate() {
        let wo = frame::direction(theta, 0.0).as_vec3();
        let at = Place {
            across,
            ..place(1.0)
        };
        let z = chi_squared(&material.at(at, wo, || 0.0, 0.5), i as u64, |_| 1.0);
        assert!(z < LIMIT, "{name} {theta} {across}: z = {z}");
    }
}
