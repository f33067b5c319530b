//! Species by any of their names, families, and the order of the library.

use super::super::*;
use super::{read, refusals, text_of};
use std::collections::BTreeMap;

fn found(name: &str) -> Result<String, String> {
    load(name, &[]).map(|s| s.id).map_err(|e| e.to_string())
}

#[test]
fn every_name_finds_its_species_and_no_other() {
    let mut owners: BTreeMap<String, &str> = BTreeMap::new();
    for (id, text) in LIBRARY {
        for name in lookup::names_of(id, text) {
            assert_eq!(found(&name).as_deref(), Ok(*id), "{name}");
            assert_eq!(found(&name.to_uppercase()).as_deref(), Ok(*id), "{name}");
            let other = owners.insert(name.clone(), id);
            assert_eq!(other, None, "{name} is {id}");
        }
    }
}

#[test]
fn a_distinctive_word_is_enough_and_several_owners_are_named() {
    for name in ["Red_Fox", "vulpes  vulpes", "fox", "VISON"] {
        assert!(found(name).is_ok(), "{name}");
    }
    for (name, owners) in [
        ("bear", "\"bear\" may be brown-bear or polar-bear"),
        ("Vulpes", "\"Vulpes\" may be red-fox or arctic-fox"),
    ] {
        assert_eq!(found(name).unwrap_err(), owners);
    }
    assert_eq!(found("neogale").as_deref(), Ok("mink"));
    let american = found("american").unwrap_err();
    assert!(american.contains("mink or "), "{american}");
    assert!(found("hair of").is_err());
    assert!(found("").is_err() && found("-").is_err());
}

#[test]
fn the_library_is_ordered_by_group_and_a_family_is_in_one_group() {
    let mut groups: Vec<String> = Vec::new();
    let mut families: BTreeMap<String, String> = BTreeMap::new();
    for id in ids() {
        let species = load(id, &[]).unwrap();
        assert!(!species.group.is_empty(), "{id}");
        assert!(text_of(id).starts_with("#:schema ../../schemas/species.schema.json\n"));
        assert_eq!(species.latin.is_empty(), species.family.is_empty(), "{id}");
        if groups.last() != Some(&species.group) {
            assert!(
                !groups.contains(&species.group),
                "{id} is apart from its group"
            );
            groups.push(species.group.clone());
        }
        if !species.family.is_empty() {
            let group = families.entry(species.family.clone());
            assert_eq!(
                *group.or_insert(species.group.clone()),
                species.group,
                "{id}"
            );
        }
    }
}

#[test]
fn synonyms_are_texts_each_once() {
    let wrong = |list: &str| {
        let text = text_of("glass-cylinder").to_owned();
        let begin = text.find("synonyms = ").unwrap();
        let end = begin + text[begin..].find('\n').unwrap();
        refusals(read(&format!(
            "{}synonyms = {list}{}",
            &text[..begin],
            &text[end..]
        )))
    };
    let many = format!(
        "[{}]",
        (0..17).map(|i| format!("\"n{i}\", ")).collect::<String>()
    );
    for list in ["3", "\"a\"", "[1]", "[\"a\", \"a\"]", "[\"\"]", &many] {
        assert_eq!(wrong(list).len(), 1, "{list}: {:?}", wrong(list));
    }
    assert!(wrong("[]").is_empty() && wrong("[\"a\", \"b\"]").is_empty());
}

#[test]
fn the_library_has_the_animals_that_it_promises() {
    let animals = [
        "alpaca",
        "arctic-fox",
        "badger",
        "bat",
        "beaver",
        "bobcat",
        "brown-bear",
        "caribou",
        "cashmere-goat",
        "cat",
        "chinchilla",
        "cow",
        "deer",
        "dog",
        "fur-seal",
        "harbor-seal",
        "hare",
        "horse",
        "human",
        "lynx",
        "mink",
        "mohair",
        "moose",
        "mouse",
        "polar-bear",
        "rabbit",
        "raccoon",
        "rat",
        "red-fox",
        "river-otter",
        "roe-deer",
        "sea-otter",
        "sheep",
        "squirrel",
        "wolf",
    ];
    let (real, made_up): (Vec<&str>, Vec<&str>) =
        ids().partition(|id| !load(id, &[]).unwrap().family.is_empty());
    let mut real = real;
    real.sort_unstable();
    assert_eq!(real, animals);
    assert_eq!(made_up, ["ember-lynx", "glass-moth", "glass-cylinder"]);
}
