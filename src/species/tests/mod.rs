//! Tests of the reader and of the built-in species.

mod comb;
mod names;
mod overrides;
mod presets;
mod reports;
mod rules;
mod vary;

use super::*;

/// Files of the tests: what they say changes with the tests only, not with the library.
const FILES: [(&str, &str); 2] = [
    ("fox", include_str!("files/fox.toml")),
    ("every-key", include_str!("files/every-key.toml")),
];

fn set(species: &str, overrides: &[&str]) -> Result<Species, SpeciesErrors> {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    parse(text_of(species), species, "test.toml", &overrides).map(|(species, _)| species)
}

fn read(text: &str) -> Result<Species, SpeciesErrors> {
    parse(text, "test", "test.toml", &[]).map(|(species, _)| species)
}

/// Text of a test file or a built-in species.
fn text_of(id: &str) -> &'static str {
    let all = FILES.iter().chain(LIBRARY);
    all.copied().find(|(known, _)| *known == id).unwrap().1
}

fn refusals(result: Result<Species, SpeciesErrors>) -> Vec<String> {
    match result {
        Ok(_) => Vec::new(),
        Err(errors) => errors.problems.iter().map(|p| errors.line(p)).collect(),
    }
}
