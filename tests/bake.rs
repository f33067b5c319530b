//! The bake keeps its books, loses no light and does not depend on threads.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::time::{Duration, Instant};
use vair::bake::{Bake, Ended, Goal, Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{Cuticle, CuticlePattern, Medulla, MedullaKind, Structure};
use vair::table::{Provenance, StructureTable, Undyed};

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
fn a_photon_seed_changes_the_photons_and_not_the_fiber() {
    let structure = vair::species::load("human", &[]).unwrap().classes[0].stations[0]
        .structure
        .clone();
    let settings = |seed, photon_seed| Settings {
        photons: 20_000,
        face: 8,
        bins: 4,
        seed,
        photon_seed,
        ..Settings::cone()
    };
    let whole = |settings: &Settings| {
        let bake = Bake::new(&structure, settings).unwrap();
        bake.run(&Goal::default(), &Silent, &Cancel::default());
        match bake.snapshot().unwrap() {
            Undyed::Gray(table) => table.flux.clone(),
            Undyed::Colored(_) => unreachable!("gray"),
        }
    };
    let through = |fiber: u64, settings: &Settings| {
        let fiber = Fiber::build(&structure, fiber).unwrap();
        let (origin, cancel) = (Provenance::default(), Cancel::default());
        bake(&fiber, settings, origin, &Silent, &cancel)
            .unwrap()
            .table
            .flux
    };
    let other = whole(&settings(0, 1));
    assert!(other == through(0, &settings(0, 1)));
    assert!(other != through(1, &settings(0, 1)));
    assert!(other != whole(&settings(0, 0)) && other != whole(&settings(1, 0)));
    // Another fiber meets other photons: its noise is its own.
    assert!(through(0, &settings(1, 0)) != whole(&settings(0, 0)));
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

/// Passes are cut by the clock, so no two of these runs fly the same ones.
#[test]
fn passes_and_pauses_do_not_matter() {
    let settings = Settings {
        photons: 300_001,
        face: 16,
        ..Settings::cone()
    };
    let whole = run(&cylinder(), &settings);
    let bake = Bake::new(&cylinder(), &settings).unwrap();
    let cancel = Cancel::default();
    let mut passes = 0;
    let ended = loop {
        // A time limit that is over at once makes passes small.
        let goal = Goal {
            until: (passes % 2 == 1).then(|| Instant::now() + Duration::from_millis(5)),
            ..Goal::default()
        };
        match bake.refine(&goal, &Silent, &cancel) {
            None => passes += 1,
            Some(Ended::Time) => passes += 1,
            Some(ended) => break ended,
        }
    };
    assert_eq!(ended, Ended::Photons);
    assert!(passes > 2, "{passes}");
    assert!(bake.photons() == 300_001);
    assert!(bake.snapshot().unwrap() == Undyed::Gray(Box::new(whole)));
}

#[test]
fn a_stopped_bake_is_a_shorter_one() {
    let settings = Settings {
        photons: u64::MAX >> 20,
        bins: 4096,
        ..Settings::cone()
    };
    assert!(Bake::new(&cylinder(), &settings).is_err());
    let settings = Settings {
        photons: 60_000_000_000,
        ..Settings::cone()
    };
    let bake = Bake::new(&cylinder(), &settings).unwrap();
    let cancel = Cancel::default();
    assert!(bake.snapshot().is_err());
    // Polled from another thread while it runs.
    let polled = std::thread::scope(|scope| {
        let bake = &bake;
        let flying = scope.spawn(|| bake.run(&Goal::default(), &Silent, &cancel));
        while bake.photons() == 0 {
            std::thread::sleep(Duration::from_millis(2));
        }
        let polled = bake.snapshot().unwrap();
        cancel.cancel();
        assert_eq!(flying.join().unwrap(), Ended::Cancelled);
        polled
    });
    let polled = &polled.tables()[0];
    let photons: u64 = (0..polled.nodes.len())
        .map(|node| polled.ledger(node, 0).emitted >> 32)
        .sum();
    assert!(photons < 100_000_000);
    let again = run(
        &cylinder(),
        &Settings {
            photons,
            ..settings
        },
    );
    assert!(*polled == again);
}

#[test]
fn an_error_goal_is_met_by_the_same_photons_every_time() {
    // Filtered maps of a bare cylinder have less error than this from the first look on.
    let settings = Settings {
        reconstruct: false,
        ..Settings::cone()
    };
    let goal = Goal {
        error: Some(0.1),
        until: None,
    };
    let counts: Vec<u64> = [1, 3]
        .into_iter()
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let bake = Bake::new(&cylinder(), &settings).unwrap();
            let ended = pool
                .build()
                .unwrap()
                .install(|| bake.run(&goal, &Silent, &Cancel::default()));
            assert_eq!(ended, Ended::Error);
            assert!(
                bake.error() <= 0.1 && bake.error() > 0.08,
                "{}",
                bake.error()
            );
            bake.photons()
        })
        .collect();
    assert_eq!(counts[0], counts[1]);
}
