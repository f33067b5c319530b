//! The bake keeps its books, loses no light and does not depend on threads.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{Cuticle, CuticlePattern, Medulla, MedullaKind, Structure};
use vair::table::{Provenance, StructureTable};

fn cylinder() -> Structure {
    Structure {
        diameter_um: 80.0,
        aspect: 1.0,
        ior: 1.55,
        cuticle: Cuticle {
            pattern: CuticlePattern::Smooth,
            pitch_um: 10.0,
            height_um: 0.5,
            around: 6,
            jitter: 0.0,
            roughness: 0.0,
            riser_roughness: 0.0,
            ..Default::default()
        },
        medulla: Medulla {
            ratio: 0.0,
            kind: MedullaKind::None,
            void_ior: 1.0003,
            pigment: 1.0,
            ..Default::default()
        },
        ..Default::default()
    }
}

fn run(structure: &Structure, settings: &Settings) -> StructureTable {
    let fiber = Fiber::build(structure, settings.seed).unwrap();
    bake(
        &fiber,
        settings,
        Provenance::default(),
        &Silent,
        &Cancel::default(),
    )
    .unwrap()
    .table
}

fn small(settings: Settings) -> Settings {
    Settings {
        photons: 400_000,
        ..settings
    }
}

#[test]
fn ledger_is_exact_and_texels_sum_to_what_escaped() {
    for settings in [small(Settings::paper()), small(Settings::cone())] {
        let table = run(&cylinder(), &settings);
        for node in 0..table.nodes.len() {
            for level in 0..table.levels.len() {
                let l = table.ledger(node, level);
                assert_eq!(l.emitted, l.escaped + l.absorbed + l.truncated + l.lost);
                let sum: f64 = table.map(node, level).iter().map(|&f| f64::from(f)).sum();
                assert!((sum - table.albedo(node, level)).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn a_clear_cylinder_returns_everything() {
    let table = run(&cylinder(), &small(Settings::cone()));
    for node in 0..table.nodes.len() {
        assert_eq!(table.ledger(node, 0).lost, 0);
        assert!(
            table.albedo(node, 0) > 1.0 - 1e-4,
            "{node}: {}",
            table.albedo(node, 0)
        );
    }
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let settings = Settings {
        photons: 100_000,
        ..Settings::cone()
    };
    let tables: Vec<_> = [1, 2, 7]
        .into_iter()
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| run(&cylinder(), &settings))
        })
        .collect();
    assert!(tables[0] == tables[1] && tables[1] == tables[2]);
}
