//! A fiber exported as glTF and baked as a mesh scatters like the fiber it came from: two tracers that
//! share nothing but the physics at boundaries.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use vair::bake::{Settings, bake};
use vair::fiber::Fiber;
use vair::progress::{Cancel, Silent};
use vair::species::{self, Structure};
use vair::table::{Provenance, StructureTable};

const SEED: u64 = 3;

fn structure(name: &str, class: usize, set: &[String]) -> Structure {
    let species = species::load(name, set).unwrap();
    let station = species.classes[class].stations.last().unwrap();
    station.structure.clone()
}

/// Whole photons, counted: what chi-squared is about. A filter would take out just what it measures.
fn table(fiber: &Fiber, seed: u64, photons: u64) -> StructureTable {
    let settings = Settings {
        photons,
        bins: 4,
        face: 8,
        seed,
        levels: vec![0.0],
        fold: false,
        fork: false,
        reconstruct: false,
        ..Settings::cone()
    };
    let (progress, cancel) = (Silent, Cancel::default());
    let baked = bake(fiber, &settings, Provenance::default(), &progress, &cancel);
    baked.unwrap().table
}

/// The fiber written as a .glb file and read back by the two lines that the command prints.
fn remodeled(fiber: &Fiber, name: &str, class: usize, more: &[&str]) -> Fiber {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fiber.glb");
    std::fs::write(&path, fiber.to_glb(name)).unwrap();
    let mut set = vec![
        format!("structure.mesh.file={}", path.display()),
        format!("structure.mesh.period_um={}", fiber.period_um()),
    ];
    set.extend(more.iter().map(|s| (*s).to_owned()));
    let fiber = Fiber::build(&structure(name, class, &set), 0).unwrap();
    assert_eq!(fiber.warnings(), [""; 0], "{name}");
    fiber
}

/// Deviation of chi-squared from its mean, in standard deviations, over all texels of all nodes that
/// have enough photons, mirror images together, and one group for the rest of a node.
fn deviation(a: &StructureTable, b: &StructureTable) -> f64 {
    let (mut chi2, mut groups) = (0.0, 0.0);
    let cube = vair::math::unicube::Unicube::new(a.res);
    for node in 0..a.nodes.len() {
        let photons = [a, b].map(|t| t.ledger(node, 0).photons());
        let mut add = |n: [f64; 2]| {
            if n[0] + n[1] > 0.0 {
                let share = (n[0] + n[1]) / (photons[0] + photons[1]);
                chi2 += (0..2)
                    .map(|i| (n[i] - share * photons[i]).powi(2) / (share * photons[i]))
                    .sum::<f64>();
                groups += 1.0;
            }
        };
        let mut rest = [0.0; 2];
        for texel in 0..a.texels() {
            let mirror = cube.mirrored(texel);
            if mirror < texel {
                continue;
            }
            let both = if mirror == texel { 1 } else { 2 };
            let texels = &[texel, mirror][..both];
            let count = |t: &StructureTable, photons: f64| -> f64 {
                let map = t.map(node, 0);
                texels.iter().map(|&i| f64::from(map[i])).sum::<f64>() * photons
            };
            let n = [count(a, photons[0]), count(b, photons[1])];
            if n[0] + n[1] >= 40.0 {
                add(n);
            } else {
                rest = [rest[0] + n[0], rest[1] + n[1]];
            }
        }
        add(rest);
    }
    (chi2 - groups) / (2.0 * groups).sqrt()
}

fn compare(name: &str, class: usize, photons: u64, more: &[&str]) {
    let fiber = Fiber::build(&structure(name, class, &[]), SEED).unwrap();
    let truth = table(&fiber, 1, photons);
    let mesh = table(&remodeled(&fiber, name, class, more), 2, photons);
    let lost: u64 = (0..4).map(|node| mesh.ledger(node, 0).lost).sum();
    let emitted: u64 = (0..4).map(|node| mesh.ledger(node, 0).emitted).sum();
    assert!(lost as f64 <= 1e-5 * emitted as f64, "{name}: {lost} lost");
    let off = deviation(&truth, &mesh);
    eprintln!("{name} {class}: {off:.2} sigma");
    assert!(off < 4.0, "{name}: {off} standard deviations");
}

#[test]
fn human() {
    compare("human", 0, 400_000, &[]);
}

/// Diamond petals and a ladder.
#[test]
fn mink_underhair() {
    compare("mink", 1, 400_000, &[]);
}

/// Bubbles.
#[test]
fn polar_bear() {
    compare("polar-bear", 0, 400_000, &[]);
}

/// Gaps between wedge discs, joined by a channel: bodies that overlap.
#[test]
fn red_fox() {
    compare("red-fox", 0, 120_000, &[]);
}

/// Letters of ovals that overlap.
#[test]
fn mink() {
    compare("mink", 0, 120_000, &[]);
}

/// Islands of keratin in films of air.
#[test]
fn brown_bear() {
    compare("brown-bear", 0, 120_000, &[]);
}

/// Cells with edges, in a waisted section.
#[test]
fn hare() {
    compare("hare", 0, 120_000, &[]);
}

/// A medium in pieces, by the lines that the command prints.
#[test]
fn cow() {
    let fiber = Fiber::build(&structure("cow", 0, &[]), SEED).unwrap();
    let medium = fiber.medium(vair::fiber::Region::Medulla);
    let set = [
        "kind=medium".to_owned(),
        format!("scattering_per_um={}", medium.scattering_per_um),
        format!("asymmetry={}", medium.asymmetry),
        format!("pigment={}", medium.pigment),
    ];
    let last = species::load("cow", &[]).unwrap().classes[0].stations.len() - 1;
    let set = set.map(|s| format!("guard.stations.{last}.medulla.{s}"));
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    compare("cow", 0, 120_000, &set);
}

/// The comparison sees an index that is off by a thirtieth.
#[test]
fn a_wrong_index_is_seen() {
    let fiber = Fiber::build(&structure("human", 0, &[]), SEED).unwrap();
    let wrong = remodeled(&fiber, "human", 0, &["structure.ior=1.5"]);
    let off = deviation(&table(&fiber, 1, 400_000), &table(&wrong, 2, 400_000));
    eprintln!("index 1.50: {off:.2} sigma");
    assert!(off > 20.0, "{off}");
}
