//! Tables that tell azimuths apart: their mean is the table without, symmetry is what it is taken for,
//! and a flat hair looks different from its sides.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::math::symmetry::Symmetry;
use vair::progress::{Cancel, Silent};
use vair::species;
use vair::table::{Azimuths, Comparison, Provenance, StructureTable, compare};

const THETA_MAX_DEG: f64 = 73.0;

fn settings(azimuths: usize, photons: u64) -> Settings {
    Settings {
        bins: 4,
        face: 8,
        levels: vec![0.0],
        reconstruct: false,
        azimuths,
        photons,
        ..Settings::cone()
    }
}

/// A table of the thickest station of a hair class.
fn table(name: &str, class: &str, settings: &Settings) -> StructureTable {
    let species = species::load(name, &[]).unwrap();
    let class = species.classes.iter().find(|c| c.name == class).unwrap();
    let fiber = Fiber::build(&class.widest().unwrap().structure, settings.seed).unwrap();
    let origin = Provenance::default();
    let baked = bake(&fiber, settings, origin, &Silent, &Cancel::default()).unwrap();
    baked.table.check().unwrap();
    baked.table
}

/// Distance at the clear level over what noise makes of it.
fn beyond_noise(compared: &Comparison) -> f64 {
    let total = compared.channels[0].total;
    total.error / total.noise
}

#[test]
fn the_mean_over_azimuths_is_the_averaged_table() {
    // Bent sections have one mirror plane, ellipses two; without folding there is none.
    for (name, symmetry, fold) in [
        ("harbor-seal", Symmetry::BothAxes, true),
        ("mouse", Symmetry::MinorAxis, true),
        ("harbor-seal", Symmetry::None, false),
    ] {
        let of = |azimuths, seed| {
            let settings = Settings {
                fold,
                seed,
                ..settings(azimuths, 120_000)
            };
            table(name, "guard", &settings)
        };
        let sides = of(3, 0);
        assert_eq!(sides.nodes.azimuths, Azimuths { count: 3, symmetry });
        assert_eq!(sides.nodes.len(), 12);
        let averaged = of(1, 0);
        let noise =
            beyond_noise(&compare(&sides.averaged().unwrap(), &averaged, THETA_MAX_DEG).unwrap());
        assert!((0.8..1.25).contains(&noise), "{name}: {noise} times noise");
        // A side is not the mean: else this test could not fail. (A mouse's hair is too round for so
        // few photons.)
        let side = beyond_noise(&compare(&sides.at_azimuth(0), &averaged, THETA_MAX_DEG).unwrap());
        assert!(
            name == "mouse" || side > 1.2,
            "{name}: one side is only {side} times noise off"
        );
    }
}

/// Maps of all azimuths, each by itself, against those that stand for them by symmetry. The fiber is one
/// of many that the species could have: its scales are not symmetric, its statistics are.
#[test]
fn symmetry_is_what_it_is_taken_for() {
    for (name, count) in [("harbor-seal", 3), ("rat", 3), ("mouse", 6)] {
        let folded = table(name, "guard", &settings(count, 60_000));
        let azimuths = folded.nodes.azimuths;
        let all = 12;
        let each = table(
            name,
            "guard",
            &Settings {
                fold: false,
                ..settings(all, 240_000)
            },
        );
        let cube = vair::math::unicube::Unicube::new(8);
        let (mut off, mut noise, mut wrong) = (0.0, 0.0, 0.0);
        for bin in 0..all {
            let [.., middle] = each.nodes.azimuths.range(bin);
            let at = azimuths.bin(middle);
            let (own, other) = (each.at_azimuth(bin), folded.at_azimuth(at.bin));
            for node in 0..4 {
                for texel in 0..cube.texels() {
                    let read = |mirrored: bool| match mirrored {
                        true => cube.mirrored(texel),
                        false => texel,
                    };
                    let pick = |table: &StructureTable, texel: usize| {
                        let i = node * cube.texels() + texel;
                        let flux = f64::from(table.flux[i]);
                        let error = f64::from(table.error[i]);
                        (
                            flux,
                            if flux > 0.0 {
                                (flux * error).powi(2)
                            } else {
                                0.0
                            },
                        )
                    };
                    let (a, b) = (pick(&own, texel), pick(&other, read(at.mirrored)));
                    off += (a.0 - b.0).powi(2);
                    noise += a.1 + b.1;
                    let (b, _) = pick(&other, read(!at.mirrored));
                    wrong += (a.0 - b).powi(2);
                }
            }
        }
        let [off, wrong] = [off, wrong].map(|sum: f64| (sum / noise).sqrt());
        println!("{name}: {off:.2} times noise, {wrong:.2} if mirrored the wrong way");
        assert!(off < 1.1, "{name}: {off} times noise");
        assert!(wrong > 1.15 * off, "{name}: mirroring matters, {wrong}");
    }
}

/// What averaging over azimuths loses of a seal's hair, and that tables compare azimuth by azimuth.
#[test]
fn a_flat_hair_differs_from_its_average() {
    let sides = table("harbor-seal", "guard", &settings(4, 200_000));
    let averaged = table("harbor-seal", "guard", &settings(1, 200_000));
    let compared = compare(&averaged, &sides, THETA_MAX_DEG).unwrap();
    let channel = &compared.channels[0];
    let azimuths: Vec<f64> = channel.azimuths.iter().map(|a| a.azimuth_deg).collect();
    assert_eq!(azimuths, [11.25, 33.75, 56.25, 78.75]);
    for side in &channel.azimuths {
        let debiased = side.difference.debiased;
        println!("{} degrees: {debiased:.3}", side.azimuth_deg);
        assert!(debiased > 0.2, "{}: {debiased}", side.azimuth_deg);
    }
    assert!(
        compare(&sides, &sides, THETA_MAX_DEG).unwrap().channels[0]
            .total
            .error
            == 0.0
    );
    let other = table("harbor-seal", "guard", &settings(2, 10_000));
    let error = compare(&sides, &other, THETA_MAX_DEG)
        .unwrap_err()
        .to_string();
    assert!(error.contains("4 azimuths from 0 to 90"), "{error}");
}
