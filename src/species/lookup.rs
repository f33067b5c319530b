//! A built-in species by any of its names.

use super::error::{SpeciesError, closest};
use super::library::{LIBRARY, ids};
use super::tree::{self, Data, Table};
use std::path::Path;

/// Id and text of the built-in species called `name`.
///
/// The id wins; then a whole name, common or scientific; then the only species that has all words of
/// `name` in one of its names. Case, hyphens and underscores do not count.
///
/// # Errors
/// No species is called so, or several are.
pub(super) fn find(name: &str) -> Result<(&'static str, &'static str), SpeciesError> {
    if let Some(entry) = LIBRARY.iter().find(|(id, _)| *id == name) {
        return Ok(*entry);
    }
    let wanted = plain(name);
    let whole = |n: &str| n == wanted;
    let words = |n: &str| has_words(n, &wanted);
    match (&called(whole)[..], &called(words)[..]) {
        ([], []) => Err(unknown(name)),
        ([one], _) | ([], [one]) => Ok(*one),
        ([], several) | (several, _) => Err(SpeciesError::Ambiguous {
            name: name.to_owned(),
            ids: several.iter().map(|(id, _)| *id).collect(),
        }),
    }
}

/// The species one of whose plain names passes `test`.
fn called(test: impl Fn(&str) -> bool) -> Vec<(&'static str, &'static str)> {
    let passes = |(id, text): &&(&str, &str)| names_of(id, text).iter().any(|n| test(n));
    LIBRARY.iter().filter(passes).copied().collect()
}

/// All names of a built-in species, plain.
pub(super) fn names_of(id: &str, text: &str) -> Vec<String> {
    let root = tree::parse(text).unwrap_or_default();
    let mut names = vec![plain(id)];
    for key in ["name", "latin", "synonyms"] {
        names.extend(texts(&root, key).into_iter().map(plain));
    }
    names.sort();
    names.dedup();
    names
}

/// The text or texts behind a key.
fn texts<'a>(root: &'a Table, key: &str) -> Vec<&'a str> {
    let items = match root.get(key).map(|n| &n.data) {
        Some(Data::Text(text)) => return vec![text],
        Some(Data::Array(items)) => items,
        _ => return Vec::new(),
    };
    let text = |data: &'a Data| match data {
        Data::Text(text) => Some(text.as_str()),
        _ => None,
    };
    items.iter().filter_map(|n| text(&n.data)).collect()
}

/// Lower case, words parted by one space.
fn plain(name: &str) -> String {
    let spaced = name.to_lowercase().replace(['-', '_'], " ");
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether every word of `wanted` is a word of `name`; both plain.
fn has_words(name: &str, wanted: &str) -> bool {
    !wanted.is_empty() && wanted.split(' ').all(|w| name.split(' ').any(|n| n == w))
}

fn unknown(name: &str) -> SpeciesError {
    let known = ids().collect::<Vec<_>>().join(", ");
    let hint = if Path::new(name).is_file() {
        format!("the name of a species file ends in .toml. Built in are {known}")
    } else {
        match closest_species(name) {
            Some(id) => format!("did you mean {id}? Built in are {known}"),
            None => format!("built in are {known}; or give the path of a .toml file"),
        }
    };
    SpeciesError::UnknownName {
        name: name.to_owned(),
        hint,
    }
}

/// The species one of whose names `name` was most likely meant to be.
fn closest_species(name: &str) -> Option<&'static str> {
    if let Some(id) = closest(name, ids()) {
        return Some(id);
    }
    let mut all: Vec<(String, &str)> = Vec::new();
    for (id, text) in LIBRARY {
        all.extend(names_of(id, text).into_iter().map(|n| (n, *id)));
    }
    let meant = closest(&plain(name), all.iter().map(|(n, _)| n.as_str()))?;
    all.iter().find(|(n, _)| n == meant).map(|(_, id)| *id)
}
