//! Tests of the reader and of the built-in species.

mod overrides;
mod presets;
mod reports;
mod rules;

use super::*;

fn set(species: &str, overrides: &[&str]) -> Result<Species, SpeciesErrors> {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    match load(species, &overrides) {
        Ok(species) => Ok(species),
        Err(SpeciesError::Invalid(errors)) => Err(errors),
        Err(other) => panic!("{other}"),
    }
}

fn read(text: &str) -> Result<Species, SpeciesErrors> {
    parse(text, "test", "test.toml", &[]).map(|(species, _)| species)
}

fn text_of(id: &str) -> &'static str {
    library::text_of(id).unwrap()
}

fn refusals(result: Result<Species, SpeciesErrors>) -> Vec<String> {
    match result {
        Ok(_) => Vec::new(),
        Err(errors) => errors.problems.iter().map(|p| errors.line(p)).collect(),
    }
}
