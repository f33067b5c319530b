//! The bake of a bare glass cylinder against the closed form, in every bin.
//!
//! Photons are independent trials with stratified entries, so binomial and Poisson deviations are
//! upper bounds and chi-squared per degree of freedom is at most about 1. Weights under absorption:
//! a photon that counts `w` at optical depth `tau` counts `w^2` at `2 tau`, so the variance of a sum
//! is at most its expectation at twice the depth, divided by the number of photons.

mod closed_form;

use closed_form::{LobeMaps, Ray, caustic, direction, energies, over_bin, over_width};
use rayon::prelude::*;
use std::sync::OnceLock;
use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{Cuticle, CuticlePattern, Medulla, MedullaKind, Structure};
use vair::table::{PHOTON, Provenance, StructureTable};

const ETA: f64 = 1.55;
const MAX_EVENTS: u32 = 16;
/// Points of the expected maps, two for each photon of a bin.
const RAYS: u32 = 250_000;
/// Level of optical depth 0.16 and the last level, at which only R is left.
const DYED: usize = 2;
const LAST: usize = 11;

fn glass(settings: &Settings) -> StructureTable {
    let structure = Structure {
        diameter_um: 80.0,
        aspect: 1.0,
        ior: ETA,
        cuticle: Cuticle {
            pattern: CuticlePattern::Smooth,
            pitch_um: 10.0,
            height_um: 0.0,
            around: 1,
            jitter: 0.0,
            roughness: 0.0,
            riser_roughness: 0.0,
            ..Default::default()
        },
        medulla: Medulla {
            ratio: 0.0,
            kind: MedullaKind::None,
            void_ior: 1.0,
            pigment: 0.0,
            ..Default::default()
        },
        ..Default::default()
    };
    let fiber = Fiber::build(&structure, 0).expect("a cylinder is a fiber");
    let baked = bake(
        &fiber,
        settings,
        Provenance::default(),
        &Silent,
        &Cancel::default(),
    );
    baked.expect("the settings are valid").table
}

/// The paper's bake, 250,000 photons a bin.
fn paper() -> &'static StructureTable {
    static TABLE: OnceLock<StructureTable> = OnceLock::new();
    TABLE.get_or_init(|| {
        glass(&Settings {
            photons: 4_000_000,
            ..Settings::paper()
        })
    })
}

fn photons(table: &StructureTable, node: usize) -> f64 {
    table.ledger(node, 0).emitted as f64 / PHOTON as f64
}

fn bin(table: &StructureTable, node: usize) -> (f64, f64) {
    (table.nodes.edges[node], table.nodes.edges[node + 1])
}

/// Asserts that a mean over `n` photons is within `limit` standard errors of the expectation.
fn within(limit: f64, found: f64, expected: f64, second_moment: f64, n: f64, what: &str) {
    let sigma = ((second_moment - expected * expected).max(1e-12) / n).sqrt();
    let z = (found - expected) / sigma;
    assert!(
        z.abs() < limit,
        "{what}: {found} against {expected}, {z:.1} sigma"
    );
}

#[test]
fn energy_is_one_less_the_reported_truncation() {
    let table = paper();
    for node in 0..table.nodes.len() {
        let ledger = table.ledger(node, 0);
        assert_eq!(ledger.lost, 0);
        assert_eq!(ledger.absorbed, 0);
        assert_eq!(ledger.escaped + ledger.truncated, ledger.emitted);
        let sum: f64 = table.map(node, 0).iter().map(|&f| f64::from(f)).sum();
        let reported = 1.0 - ledger.truncated as f64 / ledger.emitted as f64;
        assert!((sum - reported).abs() < 1e-6);
        // And the truncation is what sixteen events leave inside.
        let (from, to) = bin(table, node);
        let expected = over_bin(from, to, |theta| {
            over_width(ETA, theta, |ray: &Ray| ray.inside_after(MAX_EVENTS))
        });
        let n = photons(table, node);
        within(
            4.0,
            1.0 - reported,
            expected,
            expected + 1.0 / n,
            n,
            "truncation",
        );
    }
}

#[test]
fn totals_agree_at_every_absorption_level() {
    let table = paper();
    for node in 0..table.nodes.len() {
        let (from, to) = bin(table, node);
        // Sixteen events let out at most fifteen crossings; later light is truncated.
        let total = |tau: f64| {
            let escaped = |ray: &Ray| (0..16).map(|p| ray.attenuation(p, tau)).sum();
            over_bin(from, to, |theta| over_width(ETA, theta, escaped))
        };
        for level in 1..table.levels.len() {
            let tau = table.levels[level];
            let found = table.albedo(node, level);
            let what = format!("node {node}, level {level}");
            within(
                4.0,
                found,
                total(tau),
                total(2.0 * tau),
                photons(table, node),
                &what,
            );
        }
    }
}

#[test]
fn lobe_energies_agree() {
    let table = paper();
    (0..table.nodes.len()).into_par_iter().for_each(|node| {
        let (from, to) = bin(table, node);
        let n = photons(table, node);
        let energy = |p: usize| over_bin(from, to, |theta| energies(ETA, theta, 0.0)[p]);
        // At the last level a single crossing leaves e^-17 of the light: what is left is R.
        let r = energy(0);
        within(
            4.0,
            table.albedo(node, LAST),
            r,
            r,
            n,
            &format!("R of node {node}"),
        );

        // Below 45 degrees TT leaves behind an azimuth that TRT does not reach.
        let steepest = from.abs().max(to.abs());
        if steepest > 45.1f64.to_radians() {
            return;
        }
        let rim = Ray::new(ETA, steepest, 1.0);
        let split =
            0.5 * (rim.azimuth(1).abs() + (rim.azimuth(2) - 2.0 * std::f64::consts::PI).abs());
        let behind = |texel: usize| {
            let w = direction(table.res, texel, 0.5, 0.5);
            w[1].atan2(w[0]).abs() > split
        };
        let maps = LobeMaps::new(ETA, 0.0, from, to, table.res, MAX_EVENTS - 1, RAYS);
        let sum = |map: &[f64], back: bool| -> f64 {
            let texels = map.iter().enumerate().filter(|(i, _)| behind(*i) == back);
            texels.map(|(_, f)| f).sum()
        };
        let (tt_here, trt_here) = (sum(&maps.maps[1], true), sum(&maps.maps[2], false));
        assert!(
            tt_here > 0.995 * energy(1) && trt_here > 0.99 * energy(2),
            "{node}"
        );
        let refracted: Vec<f64> = table
            .map(node, 0)
            .iter()
            .zip(table.map(node, LAST))
            .map(|(&all, &r)| f64::from(all) - f64::from(r))
            .collect();
        for (name, back) in [("TT", true), ("TRT", false)] {
            let expected: f64 = maps.maps[1..].iter().map(|m| sum(m, back)).sum();
            let found = sum(&refracted, back);
            within(
                4.0,
                found,
                expected,
                expected,
                n,
                &format!("{name} of node {node}"),
            );
        }
    });
}

#[test]
fn light_leaves_on_its_cone_and_where_it_should() {
    let table = paper();
    for (level, tau) in [(0, 0.0), (DYED, 0.16)] {
        assert!((table.levels[level] - tau).abs() < 1e-12);
        (0..table.nodes.len()).into_par_iter().for_each(|node| {
            let (from, to) = bin(table, node);
            let maps = |tau| LobeMaps::new(ETA, tau, from, to, table.res, MAX_EVENTS - 1, RAYS);
            let (expected, squared) = (maps(tau).total(), maps(2.0 * tau).total());
            let what = format!("node {node}, level {level}");
            cone(table, node, level, &what);
            azimuths(table, node, level, &expected, &squared, &what);
            texels(table, node, level, &expected, &squared, &what);
        });
    }
}

/// No light on texels that the cones of the bin do not touch.
fn cone(table: &StructureTable, node: usize, level: usize, what: &str) {
    let (from, to) = bin(table, node);
    for (texel, &flux) in table.map(node, level).iter().enumerate() {
        let inclination = |a, b| direction(table.res, texel, a, b)[2].asin();
        let steps = [0.0, 0.25, 0.5, 0.75, 1.0];
        let grid = || {
            steps
                .iter()
                .flat_map(|&a| steps.iter().map(move |&b| (a, b)))
        };
        let lo = grid()
            .map(|(a, b)| inclination(a, b))
            .fold(f64::MAX, f64::min);
        let hi = grid()
            .map(|(a, b)| inclination(a, b))
            .fold(f64::MIN, f64::max);
        // A twentieth of a degree for what a texel holds between the points of the grid.
        let slack = 1e-3;
        if hi < -to - slack || lo > -from + slack {
            assert_eq!(
                flux,
                0.0,
                "{what}: light off the cone at {:?}",
                direction(table.res, texel, 0.5, 0.5)
            );
        }
    }
}

/// The azimuth histogram in 72 classes of 5 degrees (a texel belongs to the class of its center).
fn azimuths(
    table: &StructureTable,
    node: usize,
    level: usize,
    expected: &[f64],
    squared: &[f64],
    what: &str,
) {
    let class = |texel: usize| {
        let w = direction(table.res, texel, 0.5, 0.5);
        ((w[1].atan2(w[0]).to_degrees() + 180.0) / 5.0) as usize % 72
    };
    let mut sums = [[0.0; 3]; 72];
    for (texel, &flux) in table.map(node, level).iter().enumerate() {
        let sum = &mut sums[class(texel)];
        *sum = [
            sum[0] + f64::from(flux),
            sum[1] + expected[texel],
            sum[2] + squared[texel],
        ];
    }
    let n = photons(table, node);
    let mut chi2 = 0.0;
    for (i, [found, expected, squared]) in sums.into_iter().enumerate() {
        let z2 = (found - expected).powi(2) * n / squared;
        let degrees = 5 * i as i32 - 180;
        // 72 x 16 x 2 classes: beyond 4.5 sigma one in 60 runs of another seed.
        assert!(
            z2 < 4.5f64.powi(2),
            "{what}: {found} against {expected} at {degrees} degrees"
        );
        chi2 += z2;
    }
    assert!(
        chi2 / 72.0 < 1.6,
        "{what}: azimuth chi2 per class {}",
        chi2 / 72.0
    );
}

/// Every texel that expects at least 20 photons.
fn texels(
    table: &StructureTable,
    node: usize,
    level: usize,
    expected: &[f64],
    squared: &[f64],
    what: &str,
) {
    let n = photons(table, node);
    let (mut chi2, mut count) = (0.0, 0.0);
    for (texel, &flux) in table.map(node, level).iter().enumerate() {
        if expected[texel] * n < 20.0 {
            continue;
        }
        let z2 = (f64::from(flux) - expected[texel]).powi(2) * n / squared[texel];
        // Some 40,000 texels in all, Poisson tails at 20 photons: 6 sigma.
        assert!(
            z2 < 36.0,
            "{what}, texel {texel}: {flux} against {}",
            expected[texel]
        );
        chi2 += z2;
        count += 1.0;
    }
    assert!(count > 100.0, "{what}: only {count} texels");
    assert!(
        chi2 / count < 1.2,
        "{what}: chi2 per texel {} of {count}",
        chi2 / count
    );
}

/// The edge of TRT light in fine texels: it piles up at the caustic and ends there.
#[test]
fn the_caustic_of_trt_is_where_it_belongs() {
    let table = glass(&Settings {
        photons: 6_400_000,
        bins: 64,
        face: 128,
        levels: vec![0.0, 12.8],
        ..Settings::paper()
    });
    for degrees in [0.5f64, 20.0, 31.0] {
        let node = table.nodes.bin(degrees.to_radians());
        let (from, to) = bin(&table, node);
        let edge = |theta| caustic(ETA, theta, 2).map_or(f64::NAN, f64::to_degrees);
        let (near, far) = (edge(to.abs()), edge(from.abs()));
        // Refracted light by |azimuth| in classes of half a degree; TT has not begun there.
        let mut classes = [0.0; 80];
        for texel in 0..table.texels() {
            let flux = table.map(node, 0)[texel] - table.map(node, 1)[texel];
            let w = direction(table.res, texel, 0.5, 0.5);
            let class = (w[1].atan2(w[0]).to_degrees().abs() / 0.5) as usize;
            if class < classes.len() {
                classes[class] += f64::from(flux);
            }
        }
        let drop = |i: usize| classes[i] - classes[i + 1];
        let steepest = (0..79)
            .max_by(|&a, &b| drop(a).total_cmp(&drop(b)))
            .unwrap_or(0);
        let found = 0.5 * (steepest + 1) as f64;
        assert!(
            (near - 0.75..=far + 0.75).contains(&found),
            "at {degrees} degrees TRT ends at {found}, expected {near:.2} to {far:.2}"
        );
    }
}
