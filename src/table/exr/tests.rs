//! Round trips, reproducible bytes and refusals.

use super::*;
use crate::blame::Blame;
use crate::math::symmetry::Symmetry;
use crate::sampling::Rng;
use crate::table::Mode;
use crate::table::{Azimuths, Ledger, Nodes, PHOTON, Provenance};

/// A small table with arbitrary content that keeps every rule.
fn sample(mode: Mode, bins: usize, res: usize) -> StructureTable {
    let mut rng = Rng::new(5, bins as u64);
    let levels = vec![0.0, 0.0125, 0.1 + 0.2, 25.6];
    let texels = 6 * res * res;
    let mut table = StructureTable {
        nodes: Nodes::new(mode, bins),
        res,
        radius_um: 40.123_456_789,
        flux: Vec::new(),
        error: (0..bins * texels)
            .map(|i| {
                if i % 7 == 0 {
                    f32::INFINITY
                } else {
                    rng.uniform_f32()
                }
            })
            .collect(),
        ledger: Vec::new(),
        levels,
        provenance: Provenance {
            species: "red-fox".into(),
            class: String::new(),
            station: 0.7,
            seed: u64::MAX,
            photon_seed: 1 << 63,
            max_events: u32::MAX,
            content: "00ff".into(),
            species_text: "name = \"Füchslein 狐\"\n# two\nlines".into(),
            program: "0.1.0".into(),
        },
    };
    for node in 0..bins {
        for level in 0..table.levels.len() {
            let emitted = PHOTON * 1_000_003 + node as u64;
            let weights: Vec<f64> = (0..texels).map(|_| rng.uniform()).collect();
            let sum: f64 = weights.iter().sum();
            let escaped = (emitted as f64 * 0.9 / (1.0 + level as f64)) as u64;
            let albedo = escaped as f64 / emitted as f64;
            table
                .flux
                .extend(weights.iter().map(|w| (w / sum * albedo) as f32));
            table.ledger.push(Ledger {
                emitted,
                escaped,
                absorbed: emitted - escaped - 12,
                truncated: 5,
                lost: 7,
            });
        }
    }
    table
}

fn dyed(table: &StructureTable) -> ScatterMaps {
    let texels = table.texels();
    let bins = table.nodes.len();
    let at = |node, texel| [0, 1, 2].map(|l| table.map(node, l)[texel]);
    ScatterMaps {
        nodes: table.nodes.clone(),
        res: table.res,
        rgb: (0..bins * texels)
            .map(|i| at(i / texels, i % texels))
            .collect(),
        error: table.error.iter().map(|e| [*e, 0.5 * e, 2.0 * e]).collect(),
        absorption_per_um: [0.1, 1.0 / 3.0, 7e-5],
        radius_um: table.radius_um,
        ledger: (0..bins).map(|n| *table.ledger(n, 0)).collect(),
        provenance: table.provenance.clone(),
    }
}

#[test]
fn structure_round_trips_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    for (mode, bins, res) in [
        (Mode::Paper, 16, 4),
        (Mode::Cone, 16, 8),
        (Mode::Cone, 101, 1),
    ] {
        let path = folder.path().join("table.exr");
        let table = sample(mode, bins, res);
        table.write(&path).unwrap();
        assert_eq!(StructureTable::read(&path).unwrap(), table);
        let error = ScatterMaps::read(&path).unwrap_err();
        assert!(error.to_string().contains("dye it first"), "{error}");
    }
}

#[test]
fn scatter_round_trips_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.exr");
    let maps = dyed(&sample(Mode::Cone, 3, 4));
    maps.write(&path).unwrap();
    assert_eq!(TableFile::read(&path).unwrap(), TableFile::Scatter(maps));
    assert!(StructureTable::read(&path).is_err());
}

#[test]
fn the_same_table_gives_the_same_bytes() {
    let path = Path::new("x.exr");
    let bytes =
        || parts::encode(encode::structure(&sample(Mode::Paper, 4, 16)), ZIP, path).unwrap();
    let first = bytes();
    for _ in 0..4 {
        assert!(bytes() == first);
    }
}

#[test]
fn paper_parts_count_from_the_tip() {
    let table = sample(Mode::Paper, 16, 1);
    let parts = encode::structure(&table);
    assert_eq!(parts[0].name, "bin00");
    let theta = parts[0].attributes.get_double("theta_to_deg").unwrap();
    assert!((theta - 90.0).abs() < 1e-9);
    assert_eq!(parts[0].channels[0].1, table.map(15, 0));
}

#[test]
fn tables_that_contradict_themselves_are_refused() {
    let table = sample(Mode::Cone, 4, 2);
    let refused = |change: &dyn Fn(&mut StructureTable), words: &str| {
        let mut table = table.clone();
        change(&mut table);
        let error = table.check().unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(&|t| t.ledger[3].lost += 1, "does not balance");
    refused(&|t| t.ledger[3].lost = u64::MAX, "does not balance");
    refused(&|t| t.flux[5] += 0.01, "the texels sum to");
    refused(&|t| t.flux[5] = f32::NAN, "flux of NaN");
    refused(&|t| t.flux[5] = -1.0, "flux of -1");
    refused(&|t| t.levels[0] = 0.1, "first absorption level");
    refused(&|t| t.levels.swap(1, 2), "ascend");
    refused(&|t| t.radius_um = 0.0, "mean radius");
    refused(&|t| t.res = 3, "powers of two");
    refused(&|t| t.nodes.centers[2] = 9.0, "outside its bin");
    refused(&|t| t.error[1] = f32::NAN, "not a number");
    refused(&|t| t.flux.truncate(9), "9 flux values");
}

#[test]
fn files_that_contradict_themselves_are_refused() {
    let path = Path::new("some/table.exr");
    let table = sample(Mode::Cone, 4, 2);
    let parts = encode::structure(&table);
    let refused = |change: &dyn Fn(&mut Vec<parts::Part>), words: &str| {
        let mut parts = parts.clone();
        change(&mut parts);
        let bytes = parts::encode(parts, ZIP, path).unwrap();
        let error = parts::decode(&bytes, path)
            .and_then(decode::table)
            .map_err(|e| e.of_file(path))
            .unwrap_err();
        let message = error.to_string();
        assert!(message.contains(words), "{message}");
        assert!(message.contains("some/table.exr"), "{message}");
        assert_eq!(error.blame(), Blame::Input);
    };
    refused(&|p| drop(p.pop()), "claims 4");
    refused(&|p| p.swap(1, 2), "expected bin01");
    refused(&|p| p[0].attributes.int("format", 2), "format version 2");
    refused(
        &|p| drop(p[0].attributes.0.remove("mode")),
        "vair:mode is missing",
    );
    refused(&|p| p[0].attributes.text("mode", "x"), "mode is \"x\"");
    refused(&|p| p[0].attributes.text("kind", "x"), "kind is \"x\"");
    refused(
        &|p| p[0].attributes.text("warp", "cube"),
        "warp is \"cube\"",
    );
    refused(
        &|p| p[0].attributes.text("levels", "0 1"),
        "4 numbers, not 2",
    );
    refused(&|p| p[0].attributes.text("levels", "0 one"), "\"one\"");
    refused(
        &|p| p[2].attributes.text("lost", "1 2 3"),
        "3 numbers, not 4",
    );
    refused(&|p| p[2].attributes.text("lost", "1 2 3 -4"), "\"-4\"");
    refused(
        &|p| p[2].attributes.double("theta_to_deg", 80.0),
        "begins at",
    );
    refused(
        &|p| p[0].attributes.double("radius_um", f64::NAN),
        "radius_um is NaN",
    );
    refused(&|p| drop(p[1].channels.pop()), "4 channels");
    refused(&|p| p[1].channels[4].0 = "z".into(), "no channel error");
}

#[test]
fn damaged_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.exr");
    let good = parts::encode(encode::structure(&sample(Mode::Cone, 2, 2)), ZIP, &path).unwrap();
    let try_read = |bytes: &[u8]| {
        let parts = parts::decode(bytes, &path)?;
        decode::table(parts).map_err(|e| e.of_file(&path))
    };
    assert!(try_read(&good).is_ok());
    for cut in (0..good.len()).step_by(7) {
        assert!(try_read(&good[..cut]).is_err());
    }
    let mut rng = Rng::new(1, 2);
    for _ in 0..3000 {
        let mut bytes = good.clone();
        let at = (rng.uniform() * bytes.len() as f64) as usize;
        bytes[at] ^= 1 << (rng.bits() % 8);
        if let Err(error) = try_read(&bytes) {
            assert_eq!(error.blame(), Blame::Input, "{error}");
        }
    }
    let missing = folder.path().join("missing.exr");
    assert_eq!(TableFile::read(&missing).unwrap_err().blame(), Blame::Input);
}

/// The sample at two azimuths, a table more to each side.
fn sides(symmetry: Symmetry) -> StructureTable {
    let (a, b) = (sample(Mode::Cone, 6, 2), sample(Mode::Cone, 3, 2));
    StructureTable {
        nodes: b.nodes.at_azimuths(Azimuths { count: 2, symmetry }),
        ..a
    }
}

#[test]
fn azimuths_round_trip_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.exr");
    for symmetry in [Symmetry::None, Symmetry::MinorAxis, Symmetry::BothAxes] {
        let table = sides(symmetry);
        table.write(&path).unwrap();
        assert_eq!(StructureTable::read(&path).unwrap(), table);
        let maps = dyed(&table);
        maps.write(&path).unwrap();
        assert_eq!(ScatterMaps::read(&path).unwrap(), maps);
    }
    let table = sides(Symmetry::BothAxes);
    let parts = encode::structure(&table);
    let number = |part: usize, name| parts[part].attributes.get_double(name).unwrap();
    assert_eq!(parts[4].name, "azimuth01-bin01");
    assert_eq!(number(4, "azimuth_deg"), 67.5);
    assert_eq!(number(4, "theta_deg"), number(1, "theta_deg"));
}

#[test]
fn azimuths_that_contradict_themselves_are_refused() {
    let table = sides(Symmetry::BothAxes);
    let parts = encode::structure(&table);
    let refused = |change: &dyn Fn(&mut Vec<parts::Part>), words: &str| {
        let mut parts = parts.clone();
        change(&mut parts);
        let message = decode::table(parts).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    refused(&|p| p[0].attributes.int("format", 1), "claims 3");
    refused(&|p| p[0].attributes.int("azimuths", 1), "1 azimuths");
    refused(&|p| p[0].attributes.int("azimuths", 3), "each of 3");
    refused(
        &|p| p[0].attributes.text("symmetry", "x"),
        "symmetry is \"x\"",
    );
    refused(
        &|p| p[0].attributes.text("symmetry", "none"),
        "vair:azimuth_deg of part azimuth00-bin00 is 22.5, not 90",
    );
    refused(&|p| p[4].attributes.double("theta_deg", 1.0), "theta_deg");
    refused(&|p| p[0].attributes.text("mode", "paper"), "azimuth");
}

const ZIP: exr::prelude::Compression = exr::prelude::Compression::ZIP16;

/// Lines that are copied to the file as they lie make the file that the encoder makes.
#[test]
fn smooth_maps_are_written_as_the_encoder_would() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("smooth.exr");
    for (bins, res) in [(2, 1), (16, 16), (3, 64)] {
        let mut table = sample(Mode::Cone, bins, res);
        if res == 16 {
            // As long as the text of a species may be.
            table.provenance.species_text = "# so long\n".repeat((4 << 20) / 10);
        }
        let plain = exr::prelude::Compression::Uncompressed;
        let expected = parts::encode(encode::structure(&table), plain, &path).unwrap();
        table.write(&path).unwrap();
        assert!(std::fs::read(&path).unwrap() == expected, "{bins} {res}");
    }
}
