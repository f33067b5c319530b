//! What the built-in species say.

use super::super::*;
use super::text_of;

#[test]
fn every_built_in_species_loads_with_all_origins() {
    for id in ids() {
        let (species, origins) = match load_with_origins(id, &[]) {
            Ok(loaded) => loaded,
            Err(error) => panic!("{id}:\n{error}"),
        };
        assert_eq!(species.id, id);
        assert_eq!(species.text, text_of(id));
        for number in &origins.numbers {
            match &number.origin {
                Origin::Source(keys) => assert!(!keys.is_empty(), "{id} {}", number.path),
                Origin::Estimate(why) => assert!(why.len() > 3, "{id} {}", number.path),
                Origin::Override => panic!("{id} {}", number.path),
            }
        }
        for reference in &origins.references {
            let cites = |c: &Cited| match &c.origin {
                Origin::Source(keys) => keys.contains(&reference.key),
                Origin::Estimate(why) => why.contains(&reference.key),
                Origin::Override => false,
            };
            let remarked = text_of(id).contains(&format!("({}", reference.key));
            let used = origins.numbers.iter().any(cites) || remarked;
            assert!(used, "{id}: nothing refers to {}", reference.key);
        }
    }
}

/// Profile of the groom: D (stalk + (1 - stalk) smoothstep), and toward the tip sqrt(1 - x^1.5) of it.
#[test]
fn stations_are_as_wide_as_the_hair_there() {
    for id in ids() {
        for class in load(id, &[]).unwrap().classes {
            let groom = &class.groom;
            for station in &class.stations {
                let [from, to] = groom.shield;
                let x = ((station.at - from) / (to - from)).clamp(0.0, 1.0);
                let smooth = x * x * (3.0 - 2.0 * x);
                let width = groom.diameter_um * (groom.stalk + (1.0 - groom.stalk) * smooth);
                let past = (station.at - groom.taper_from).max(0.0) / (1.0 - groom.taper_from);
                let width = width * (1.0 - past.powf(1.5)).sqrt();
                let ratio = station.structure.diameter_um / width;
                let place = format!("{id} {} at {}", class.name, station.at);
                assert!((0.95..1.05).contains(&ratio), "{place}: {ratio}");
                assert!(past < 0.6, "{place} is at the very tip");
            }
        }
    }
}

/// What the literature says of an animal's guard hair where it is widest: ranges over its samples.
struct Fact {
    id: &'static str,
    diameter_um: [f64; 2],
    length_mm: [f64; 2],
    /// Medullary index.
    ratio: [f64; 2],
    /// Scale patterns from the root to the tip.
    scales: &'static [&'static str],
    /// Medulla at the widest place.
    medulla: &'static str,
}

/// After the Alaska Fur ID Project, but for the sea otter (Williams and others 1992).
const FACTS: [Fact; 12] = [
    Fact {
        id: "red-fox",
        diameter_um: [40.0, 120.0],
        length_mm: [25.0, 85.0],
        ratio: [0.5, 0.77],
        scales: &["lanceolate-petal", "broad-petal", "mosaic"],
        medulla: "s-channel",
    },
    Fact {
        id: "arctic-fox",
        diameter_um: [37.0, 65.0],
        length_mm: [70.0, 85.0],
        ratio: [0.61, 0.69],
        scales: &["lanceolate-petal", "broad-petal", "irregular-wave"],
        medulla: "s-channel",
    },
    Fact {
        id: "wolf",
        diameter_um: [125.0, 150.0],
        length_mm: [60.0, 100.0],
        ratio: [0.45, 0.85],
        scales: &["lanceolate-petal", "mosaic", "irregular-wave"],
        medulla: "froth",
    },
    Fact {
        id: "dog",
        diameter_um: [60.0, 97.0],
        length_mm: [29.0, 70.0],
        ratio: [0.42, 0.6],
        scales: &["lanceolate-petal", "broad-petal", "mosaic"],
        medulla: "froth",
    },
    Fact {
        id: "lynx",
        diameter_um: [60.0, 118.0],
        length_mm: [35.0, 60.0],
        ratio: [0.63, 0.87],
        scales: &["diamond-petal", "mosaic", "irregular-wave"],
        medulla: "s-channel",
    },
    Fact {
        id: "raccoon",
        diameter_um: [70.0, 154.0],
        length_mm: [40.0, 74.0],
        ratio: [0.35, 0.47],
        scales: &["broad-petal", "regular-wave"],
        medulla: "froth",
    },
    Fact {
        id: "mink",
        diameter_um: [90.0, 100.0],
        length_mm: [25.0, 30.0],
        ratio: [0.45, 0.67],
        scales: &["lanceolate-petal", "irregular-wave"],
        medulla: "cloisonne",
    },
    Fact {
        id: "river-otter",
        diameter_um: [129.0, 185.0],
        length_mm: [20.0, 30.0],
        ratio: [0.48, 0.48],
        scales: &["diamond-petal", "torn-paper"],
        medulla: "cloisonne",
    },
    Fact {
        id: "sea-otter",
        diameter_um: [44.0, 106.0],
        length_mm: [2.6, 31.5],
        ratio: [0.0, 0.95],
        scales: &["lanceolate-petal", "mosaic"],
        medulla: "amorphous",
    },
    Fact {
        id: "brown-bear",
        diameter_um: [80.0, 175.0],
        length_mm: [40.0, 120.0],
        ratio: [0.2, 0.36],
        scales: &["mosaic", "torn-paper"],
        medulla: "globules",
    },
    Fact {
        id: "polar-bear",
        diameter_um: [100.0, 175.0],
        length_mm: [80.0, 170.0],
        ratio: [0.37, 0.37],
        scales: &["torn-paper", "torn-paper"],
        medulla: "froth",
    },
    Fact {
        id: "fur-seal",
        diameter_um: [100.0, 190.0],
        length_mm: [10.0, 20.0],
        ratio: [0.5, 0.5],
        scales: &["diamond-petal", "close-wave"],
        medulla: "froth",
    },
];

#[test]
fn guard_hairs_are_what_their_literature_says() {
    for fact in FACTS {
        let id = fact.id;
        let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
        let guard = &load(id, &[]).unwrap().classes[0];
        let stations = guard.stations.iter();
        let scales: Vec<&str> = stations
            .map(|s| s.structure.cuticle.pattern.name())
            .collect();
        assert_eq!(scales, fact.scales, "{id}");
        let width = |s: &&Station| s.structure.diameter_um;
        let wider = |a: &&Station, b: &&Station| width(a).total_cmp(&width(b));
        let shield = &guard.stations.iter().max_by(wider).unwrap().structure;
        assert!(within(fact.diameter_um, shield.diameter_um), "{id}");
        assert!(within(fact.diameter_um, guard.groom.diameter_um), "{id}");
        assert!(within(fact.length_mm, guard.groom.length_mm), "{id}");
        assert!(within(fact.ratio, shield.medulla.ratio), "{id}");
        assert_eq!(shield.medulla.kind.name(), fact.medulla, "{id}");
    }
}

#[test]
fn underhairs_are_what_their_literature_says() {
    let under = |id: &str| load(id, &[]).unwrap().classes.swap_remove(1);
    for id in ["river-otter", "sea-otter", "harbor-seal", "fur-seal"] {
        let kind = under(id).stations[0].structure.medulla.kind;
        assert_eq!(
            kind,
            MedullaKind::None,
            "{id}: water animals, Weisel and others 2005"
        );
    }
    let otter = under("river-otter")
        .stations
        .swap_remove(0)
        .structure
        .cuticle;
    assert_eq!((otter.pattern.name(), otter.around), ("otter-fin", 4));
    // 20 um wide and 5 thick, 3 to 4 scales per 100 um (hair standards of Cargille and McCrone).
    let seal = under("harbor-seal").stations.swap_remove(0).structure;
    assert!((seal.diameter_um * seal.aspect.sqrt() - 20.0).abs() < 1e-9);
    assert!((seal.diameter_um / seal.aspect.sqrt() - 5.0).abs() < 1e-9);
    assert!((100.0 / 4.0..=100.0 / 3.0).contains(&seal.cuticle.pitch_um));
    // 60 000 to 80 000 hairs per cm2, 78 under-hairs to a guard hair (Kuhn and others 2010).
    let otter = load("river-otter", &[]).unwrap();
    let [guard, under] = [0, 1].map(|k| otter.classes[k].groom.density_per_cm2);
    assert!((60e3..=80e3).contains(&(guard + under)));
    assert!((under / guard - 78.0).abs() < 0.5);
}

#[test]
fn coats_have_the_color_that_their_literature_says() {
    let bands = |id: &str| load(id, &[]).unwrap().classes.swap_remove(0).pigment;
    // A coat of it is darker than a mid brown: light goes some 300 um through hair of 130 um.
    let dark = |b: &PigmentBand| b.absorption_per_um()[1] > 0.006;
    // From the tip: which bands are dark.
    for (id, expected) in [
        ("wolf", &[true, false, true, false][..]),
        ("raccoon", &[true, false, true, false]),
        ("badger", &[false, true, false]),
        ("red-fox", &[true, true, true]),
        ("mink", &[true]),
        ("arctic-fox", &[false]),
    ] {
        let found: Vec<bool> = bands(id).iter().map(dark).collect();
        assert_eq!(found, expected, "{id}");
    }
    for id in ["polar-bear", "arctic-fox"] {
        for class in load(id, &[]).unwrap().classes {
            assert!(
                class
                    .pigment
                    .iter()
                    .all(|b| b.absorption_per_um() == [0.0; 3])
            );
        }
    }
    // The base of a red fox's hair is never white or yellow, its tip is dark for less than 6 mm.
    let fox = bands("red-fox");
    assert!(fox[0].to_mm < 6.0 && fox[2].eumelanin > fox[2].pheomelanin);
    // Polar bears have black skin.
    assert!(
        load("polar-bear", &[])
            .unwrap()
            .skin_color
            .iter()
            .all(|c| *c < 0.05)
    );
}

#[test]
fn overrides_stand_at_the_end_of_the_text() {
    let glass = load("glass-cylinder", &["structure.ior=1.5".to_owned()]).unwrap();
    let fiber = &glass.classes[0].stations[0].structure;
    assert_eq!(
        (fiber.ior, fiber.aspect, fiber.cuticle.roughness),
        (1.5, 1.0, 0.0)
    );
    assert_eq!(fiber.cuticle.pattern, CuticlePattern::Smooth);
    assert!(
        glass
            .text
            .ends_with("# Overrides:\n# --set structure.ior=1.5\n")
    );
}
