//! What is packed comes back, as well as it says.

use super::*;
use crate::math::frame;
use crate::math::unicube::Unicube;
use crate::sampling::Rng;
use crate::table::{Mode, PHOTON, ScatterMaps, StructureTable, TableFile, compare};

/// A structure table of a lobe about the cone, `photons` a node, seen through levels.
fn table(res: usize, photons: f64, seed: u64, lopsided: f64) -> StructureTable {
    let nodes = Nodes::new(Mode::Cone, 8);
    let cube = Unicube::new(res);
    let levels = vec![0.0, 0.3, 1.0];
    let mut rng = Rng::new(seed, 0);
    let (mut flux, mut error, mut ledger) = (Vec::new(), Vec::new(), Vec::new());
    for &center in &nodes.centers {
        let mut clear = Vec::new();
        for texel in 0..cube.texels() {
            let (w, _) = cube.direction(texel, 0.5, 0.5);
            let off = frame::theta_of(w) + center;
            let lobe = (-30.0 * off * off).exp() + 0.05;
            let mean = 0.15 * lobe * (1.3 - w.x + lopsided * w.y) * cube.solid_angle(texel);
            // Of a binomial, near enough, with the same mean and variance.
            let sigma = (mean / photons).sqrt();
            let f = (mean + 3.4641 * sigma * (rng.uniform() - 0.5)).max(0.0);
            error.push(if f > 0.0 {
                (sigma / f) as f32
            } else {
                f32::INFINITY
            });
            clear.push((f, 1.5 + w.x));
        }
        for &level in &levels {
            let map: Vec<f32> = clear
                .iter()
                .map(|&(f, path): &(f64, f64)| (f * f64::exp(-level * path)) as f32)
                .collect();
            let sum: f64 = map.iter().map(|&f| f64::from(f)).sum();
            let emitted = PHOTON << 16;
            let escaped = (sum * emitted as f64) as u64;
            ledger.push(Ledger {
                emitted,
                escaped,
                absorbed: emitted - escaped - 7,
                truncated: 3,
                lost: 4,
            });
            flux.extend(map);
        }
    }
    StructureTable {
        nodes,
        res,
        levels,
        radius_um: 40.0,
        flux,
        error,
        ledger,
        provenance: Provenance {
            species: "made-up".into(),
            species_text: "text".into(),
            ..Provenance::default()
        },
    }
}

fn round_trip(packed: &PackedTable) -> TableFile {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("packed.exr");
    packed.write(&path).unwrap();
    assert_eq!(
        std::fs::metadata(&path).unwrap().len() as usize,
        packed.size().unwrap()
    );
    let back = PackedTable::read(&path).unwrap();
    assert_eq!(&back, packed);
    TableFile::read(&path).unwrap()
}

#[test]
fn half_floats_lose_no_more_than_they_must() {
    let table = table(16, 1e12, 1, 0.0);
    let packed = PackedTable::new(&table, Packing::default()).unwrap();
    assert!(packed.code.layout.folded);
    let TableFile::Structure(back) = round_trip(&packed) else {
        panic!("a structure table was packed");
    };
    assert_eq!(back.ledger, table.ledger);
    assert_eq!(back.provenance, table.provenance);
    let compared = compare(&back, &table, 73.0).unwrap();
    for channel in &compared.channels {
        assert!(channel.total.error < 5e-4, "{channel:?}");
        assert_eq!(channel.albedo, 0.0);
    }
}

#[test]
fn one_side_is_kept_only_of_symmetric_tables() {
    for (lopsided, folded) in [(0.0, true), (0.2, false)] {
        let table = table(16, 1e6, 1, lopsided);
        let packed = PackedTable::new(&table, Packing::default()).unwrap();
        assert_eq!(packed.code.layout.folded, folded, "{lopsided}");
    }
}

#[test]
fn budgets_are_kept_and_more_bytes_are_less_error() {
    let table = table(32, 1e9, 1, 0.0);
    let mut last = 1.0;
    for bytes in [8_000, 14_000, 40_000] {
        for rank in [None, Some(4)] {
            let packing = Packing {
                rank,
                bytes: Some(bytes),
            };
            let packed = PackedTable::new(&table, packing).unwrap();
            assert!(packed.size().unwrap() <= bytes);
            let compared = compare(
                &round_trip(&packed),
                &TableFile::Structure(table.clone()),
                73.0,
            )
            .unwrap();
            let error = compared.channels[0].total.error;
            if rank.is_none() {
                assert!(error < 0.8 * last, "{bytes}: {error} after {last}");
                last = error;
            }
            assert!(compared.channels.iter().all(|c| c.albedo < 1e-9));
        }
    }
    assert!(last < 0.03, "{last}");
    let tiny = Packing {
        rank: None,
        bytes: Some(1000),
    };
    let error = PackedTable::new(&table, tiny).unwrap_err().to_string();
    assert!(error.contains("1000 bytes"), "{error}");
}

#[test]
fn packing_takes_noise_out() {
    let (noisy, truth) = (table(32, 3e4, 1, 0.0), table(32, 1e12, 2, 0.0));
    let before = compare(&noisy, &truth, 73.0).unwrap().channels[0]
        .total
        .error;
    let packing = Packing {
        rank: None,
        bytes: Some(60_000),
    };
    let packed = PackedTable::new(&noisy, packing).unwrap().unpack().unwrap();
    let after = compare(&packed, &TableFile::Structure(truth.clone()), 73.0).unwrap();
    let after = after.channels[0].total.error;
    assert!(after < 0.8 * before, "{before} before, {after} after");
}

#[test]
fn dyed_tables_keep_their_albedo() {
    let maps = table(16, 1e9, 1, 0.0).dye([0.001, 0.005, 0.02]).unwrap();
    let packing = Packing {
        rank: None,
        bytes: Some(12_000),
    };
    let TableFile::Scatter(back) = round_trip(&PackedTable::new(&maps, packing).unwrap()) else {
        panic!("a dyed table was packed");
    };
    for node in 0..maps.nodes.len() {
        let (a, b): ([f64; 3], [f64; 3]) = (back.albedo(node), ScatterMaps::albedo(&maps, node));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-5), "{a:?} {b:?}");
    }
    assert!(back.provenance.species_text.is_empty());
}

#[test]
fn impossible_wishes_are_refused() {
    let table = table(16, 1e6, 1, 0.0);
    for rank in [0, 25] {
        let packing = Packing {
            rank: Some(rank),
            bytes: None,
        };
        assert!(matches!(
            PackedTable::new(&table, packing),
            Err(TableError::Request(_))
        ));
    }
}

#[test]
fn damaged_files_are_refused_and_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.exr");
    let packing = Packing {
        rank: None,
        bytes: Some(9000),
    };
    PackedTable::new(&table(16, 1e9, 1, 0.0), packing)
        .unwrap()
        .write(&path)
        .unwrap();
    let good = std::fs::read(&path).unwrap();
    let try_read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        TableFile::read(&path)
    };
    assert!(try_read(&good).is_ok());
    for cut in (0..good.len()).step_by(97) {
        assert!(try_read(&good[..cut]).is_err());
    }
    let mut rng = Rng::new(1, 2);
    for _ in 0..600 {
        let mut bytes = good.clone();
        let at = (rng.uniform() * bytes.len() as f64) as usize;
        bytes[at] ^= 1 << (rng.bits() % 8);
        if let Err(error) = try_read(&bytes) {
            assert_eq!(error.blame(), crate::blame::Blame::Input, "{error}");
            assert!(error.to_string().contains("damaged.exr"), "{error}");
        }
    }
    // What contradicts itself is named.
    let mut packed = PackedTable::new(&table(16, 1e9, 1, 0.0), packing).unwrap();
    packed.code.trees.bits.pop();
    packed.write(&path).unwrap();
    let message = TableFile::read(&path).unwrap_err().to_string();
    assert!(message.contains("trees"), "{message}");
}
