//! Every rule at both ends.

use super::super::*;
use super::{read, refusals, set, text_of};
use crate::species::fields;
use crate::species::shape::{Field, Kind, Range, Shape};
use std::collections::BTreeSet;

/// Ranges of every number that the built-in species state, by path.
fn ranges(shape: &Shape, path: &[&str]) -> Option<(Range, bool)> {
    let (key, rest) = path.split_first()?;
    if let (true, Some(_)) = (key.parse::<usize>().is_ok(), rest.first()) {
        return ranges(shape, rest);
    }
    match &shape.field(key)?.kind {
        Kind::Table(inner) | Kind::Tables(inner, _) => ranges(inner, rest),
        Kind::Number(range) | Kind::Numbers(_, range) | Kind::Color(range) => Some((*range, false)),
        Kind::Whole(range) => Some((*range, true)),
        _ => None,
    }
}

#[test]
fn every_number_is_accepted_at_its_ends_and_refused_beyond() {
    let mut seen = BTreeSet::new();
    for id in ["every-key", "fox"] {
        let (species, origins) = parse(text_of(id), id, "test.toml", &[]).unwrap();
        for number in &origins.numbers {
            let keys: Vec<&str> = number.path.split('.').collect();
            let shape = match keys[0] {
                class if species.classes.iter().any(|c| c.name == class) => &fields::CLASS,
                _ => &fields::SPECIES,
            };
            let keys = if std::ptr::eq(shape, &fields::CLASS) {
                &keys[1..]
            } else {
                &keys
            };
            let (range, whole) = ranges(shape, keys).unwrap();
            let list = number.values.len() > 1;
            let path = if list {
                format!("{}.0", number.path)
            } else {
                number.path.clone()
            };
            let refused = |value: String| {
                let lines = refusals(set(id, &[&format!("{path}={value}")]));
                let ranged = |l: &&String| {
                    l.contains("expected a number from")
                        || l.contains("expected a whole number from")
                };
                (lines.iter().filter(ranged).count(), lines.len())
            };
            let step = if whole { 1.0 } else { 1e-6 * range.max };
            assert_eq!(
                refused(range.min.to_string()).0,
                0,
                "{id} {path} at {}",
                range.min
            );
            assert_eq!(
                refused(range.max.to_string()).0,
                0,
                "{id} {path} at {}",
                range.max
            );
            for bad in [range.min - step, range.max + step] {
                assert_eq!(refused(bad.to_string()), (1, 1), "{id} {path} at {bad}");
            }
            for bad in [
                "nan",
                "inf",
                "-inf",
                "1e999",
                "true",
                "[1]",
                "\"1\"",
                "2020-01-01",
            ] {
                assert_eq!(refused(bad.to_owned()), (1, 1), "{id} {path} at {bad}");
            }
            if whole {
                assert_eq!(refused("3.5".to_owned()), (1, 1), "{id} {path}");
            }
            seen.insert(keys.last().copied().unwrap_or_default().to_owned());
        }
    }
    let mut numbers = BTreeSet::new();
    for shape in all_shapes() {
        let number = |f: &&Field| {
            matches!(
                f.kind,
                Kind::Number(_) | Kind::Whole(_) | Kind::Numbers(..) | Kind::Color(_)
            )
        };
        numbers.extend(shape.fields.iter().filter(number).map(|f| f.key.to_owned()));
    }
    assert_eq!(seen, numbers, "every field of the description was tried");
}

fn all_shapes() -> Vec<&'static Shape> {
    fn add(shape: &'static Shape, all: &mut Vec<&'static Shape>) {
        all.push(shape);
        for field in shape.fields {
            if let Kind::Table(inner) | Kind::Tables(inner, _) = &field.kind {
                add(inner, all);
            }
        }
    }
    let mut all = Vec::new();
    add(&fields::SPECIES, &mut all);
    add(&fields::CLASS, &mut all);
    all
}

#[test]
fn rules_between_values_hold_at_both_ends() {
    let cases: &[(&str, &[&str], &str)] = &[
        // Fox shield: diameter 75, aspect 1.2, thin radius 34.23 um.
        ("fox", &["guard.stations.1.cuticle.height_um=4.5"], ""),
        (
            "fox",
            &["guard.stations.1.cuticle.height_um=4.6"],
            "half of the pitch",
        ),
        ("fox", &["under.stations.0.cuticle.height_um=2.4"], ""),
        (
            "fox",
            &["under.stations.0.cuticle.height_um=2.45"],
            "quarter of the fiber's",
        ),
        ("fox", &["guard.stations.1.cuticle.around=2"], ""),
        (
            "fox",
            &["guard.stations.1.cuticle.around=1"],
            "at least 2 tiles",
        ),
        (
            "every-key",
            &[
                "structure.cuticle.around=1",
                "structure.cuticle.pattern=coronal",
            ],
            "",
        ),
        ("every-key", &["groom.pores.density_per_cm2=200"], ""),
        (
            "every-key",
            &["groom.pores.density_per_cm2=200.1"],
            "at most 200: all hairs",
        ),
        ("fox", &["guard.stations.1.medulla.septum_um=6.9"], ""),
        (
            "fox",
            &["guard.stations.1.medulla.septum_um=7"],
            "less than the pitch",
        ),
        ("fox", &["guard.stations.1.medulla.ratio=0.01"], ""),
        (
            "fox",
            &["guard.stations.1.medulla.ratio=0"],
            "expected more with a medulla",
        ),
        ("every-key", &["under.stations.4.medulla.ratio=0"], ""),
        (
            "every-key",
            &["under.stations.4.medulla.ratio=0.01"],
            "expected 0 without",
        ),
        (
            "every-key",
            &["under.stations.2.medulla.radius_um=20.4"],
            "",
        ),
        (
            "every-key",
            &["under.stations.2.medulla.radius_um=20.5"],
            "medulla's thin radius",
        ),
        ("fox", &["guard.stations.1.at=0.16"], ""),
        (
            "fox",
            &["guard.stations.1.at=0.15"],
            "of the station before",
        ),
        ("fox", &["guard.pigment.1.to_mm=5.5"], ""),
        ("fox", &["guard.pigment.1.to_mm=2.5"], "of the band before"),
        ("fox", &["guard.pigment.0.softness_mm=5"], ""),
        (
            "fox",
            &["guard.pigment.0.softness_mm=5.1"],
            "twice the band's width",
        ),
        ("fox", &["guard.pigment.2.to_mm=40"], "last band"),
        ("fox", &["guard.groom.length_mm=1.5"], ""),
        (
            "fox",
            &["guard.groom.length_mm=1.49"],
            "20 times the diameter",
        ),
        ("fox", &["guard.groom.shield.1=0.11"], ""),
        (
            "fox",
            &["guard.groom.shield.1=0.1"],
            "two ascending numbers",
        ),
        ("fox", &["guard.groom.taper_from=0.6"], ""),
        (
            "fox",
            &["guard.groom.taper_from=0.59"],
            "at least the shield's",
        ),
        ("fox", &["under.groom.crimp_mm=1.25"], ""),
        (
            "fox",
            &["under.groom.crimp_mm=1.26"],
            "half of the wavelength",
        ),
    ];
    for (species, overrides, expected) in cases {
        let lines = refusals(set(species, overrides));
        if expected.is_empty() {
            assert!(lines.is_empty(), "{overrides:?}: {lines:?}");
        } else {
            assert_eq!(lines.len(), 1, "{overrides:?}: {lines:?}");
            assert!(lines[0].contains(expected), "{overrides:?}: {lines:?}");
        }
    }
}

#[test]
fn numbers_without_origin_are_refused() {
    let text = text_of("glass-cylinder").replace(
        "roughness = { value = 0, estimate = \"by definition\" }",
        "roughness = 0",
    );
    let lines = refusals(read(&text));
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].contains("`structure.cuticle.roughness` does not say where it comes from"));
}

#[test]
fn parameters_of_another_choice_are_refused() {
    let text = text_of("fox").replacen(
        "septum_um = { value = 3",
        "radius_um = 2\nseptum_um = { value = 3",
        1,
    );
    let text = text.replacen(
        "radius_um = 2",
        "radius_um = { value = 2, estimate = \"x\" }",
        1,
    );
    let lines = refusals(read(&text));
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(
        lines[0].contains("has no meaning with kind \"ladder\" (it belongs to amorphous, froth)")
    );
}

#[test]
fn materials_are_read_and_their_rules_hold() {
    let gold = set(
        "fox",
        &[
            "structure.materials.cuticle.boundary=metal",
            "structure.materials.cuticle.metal=gold",
            "guard.structure.materials.riser.boundary=diffuse",
            "guard.structure.materials.riser.albedo=[0.1, 0.2, 0.3]",
            "under.structure.materials.void.index=1.33",
            "guard.stations.0.materials.cortex.index=[1.54, 1.55, 1.56]",
        ],
    )
    .unwrap();
    let materials =
        |class: usize, station: usize| gold.classes[class].stations[station].structure.materials;
    let Boundary::Metal { index, extinction } = materials(0, 1).cuticle.boundary else {
        panic!("{:?}", materials(0, 1));
    };
    assert!(index[0] < 0.3 && index[2] > 1.2 && extinction[0] > extinction[2]);
    let albedo = [0.1, 0.2, 0.3];
    assert_eq!(materials(0, 0).riser, Some(Boundary::Diffuse { albedo }));
    assert_eq!(materials(1, 0).riser, None);
    assert_eq!(materials(1, 0).void.filling.index, Some([1.33; 3]));
    let cortex = materials(0, 0).cortex.filling;
    assert_eq!(cortex.index, Some([1.54, 1.55, 1.56]));
    assert_eq!(materials(0, 1).cortex.filling, Filling::default());

    let m = "structure.materials";
    let cases: &[(&[&str], &str)] = &[
        (&["void.boundary=metal"], "expected one of `metal`"),
        (
            &["void.boundary=metal", "void.index=0.2"],
            "materials.void.extinction` is missing",
        ),
        (
            &[
                "void.boundary=metal",
                "void.metal=gold",
                "void.index=0.2",
                "void.extinction=3",
            ],
            "expected one of `metal`",
        ),
        (&["void.boundary=diffuse"], "void.albedo` is missing"),
        (&["void.boundary=slab"], "void.layers` is missing"),
        (&["void.albedo=0.5"], "has no meaning without a `boundary`"),
        (&["riser.layers=2"], "has no meaning without a `boundary`"),
        (&["void.index=0.5"], "expected 1 to 3 for what light"),
        (&["void.index_file=nowhere.csv"], "no table of a refractive"),
        (&["cuticle.index=1.6"], "write it into the cortex"),
        (
            &["cortex.boundary=dielectric"],
            "a boundary that the fiber does not have",
        ),
    ];
    for (overrides, expected) in cases {
        let overrides: Vec<String> = overrides.iter().map(|o| format!("{m}.{o}")).collect();
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let lines = refusals(set("fox", &overrides));
        assert_eq!(lines.len(), 1, "{overrides:?}: {lines:?}");
        assert!(lines[0].contains(expected), "{overrides:?}: {lines:?}");
    }
    let absent = "under.stations.0.materials.medulla.scattering_per_um=0.1";
    let lines = refusals(set("fox", &[absent]));
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].contains("has no meaning with a medulla of kind"));
}

#[test]
fn measured_indices_are_read_beside_the_species_file() {
    let folder = tempfile::tempdir().unwrap();
    let fox = folder.path().join("my-fox.toml");
    std::fs::write(&fox, text_of("fox")).unwrap();
    std::fs::write(
        folder.path().join("glass.csv"),
        "nm,n\n400,1.60\n700,1.54\n",
    )
    .unwrap();
    let set = ["structure.materials.cortex.index_file=glass.csv".to_owned()];
    let fox = load(fox.to_str().unwrap(), &set).unwrap();
    let structure = &fox.classes[0].stations[0].structure;
    assert!(structure.is_colored());
    let index = structure.materials.cortex.filling.index.unwrap();
    assert!(index[0] < index[1] && index[1] < index[2], "{index:?}");
}

/// The text that a table keeps holds the recipes in files beside the species': with the marks taken
/// away they are those files again.
#[test]
fn recipes_in_files_are_kept_with_the_text() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = include_str!("../../../procedural/patterns/diamond-petal.toml");
    std::fs::write(folder.path().join("mine.toml"), recipe).unwrap();
    let file = folder.path().join("animal.toml");
    std::fs::write(&file, text_of("fox")).unwrap();
    let file = file.to_string_lossy();
    let set = ["guard.stations.0.cuticle.pattern=mine.toml".to_owned()];
    let species = load(&file, &set).unwrap();
    let station = &species.classes[0].stations[0];
    assert_eq!(station.structure.cuticle.pattern.name(), "mine");

    let (_, kept) = species.text.split_once("\n# Pattern mine.toml:\n").unwrap();
    let lines = kept.lines().map(|line| match line.strip_prefix("# ") {
        Some(line) => line,
        None => line.strip_prefix('#').unwrap(),
    });
    let kept: Vec<&str> = lines.collect();
    assert_eq!(kept, recipe.lines().collect::<Vec<_>>());
    // The whole is a species file still, for one who puts the recipe back.
    let again = parse(&species.text, "fox", &file, &set).unwrap().0;
    assert_eq!(again.classes[0].stations, species.classes[0].stations);

    // Recipes that are none: refused where they are named, by what is wrong in them.
    for (bad, expected) in [
        ("", "missing"),
        ("generator = \"rows\"\nrise = \"x\"\n", "rise"),
        ("\u{1}", "not TOML"),
        (&"[".repeat(200_000), "mine.toml"),
    ] {
        std::fs::write(folder.path().join("mine.toml"), bad).unwrap();
        let errors = load(&file, &set).unwrap_err().to_string();
        assert!(errors.contains(expected), "{expected}: {errors:.300}");
    }
    let gone = ["guard.stations.0.cuticle.pattern=gone.toml".to_owned()];
    assert!(
        load(&file, &gone)
            .unwrap_err()
            .to_string()
            .contains("gone.toml")
    );
}
