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
        Kind::Number(range) | Kind::Numbers(_, range) => Some((*range, false)),
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
        let number =
            |f: &&Field| matches!(f.kind, Kind::Number(_) | Kind::Whole(_) | Kind::Numbers(..));
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
