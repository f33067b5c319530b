//! Species presets: what an animal's hairs are made of, and where each number comes from.
//!
//! A file is read in two passes that collect every problem: types, ranges and origins against the
//! field descriptions, then the rules that join several values. Overrides change the document before
//! the first pass, so they meet the same rules.

pub(crate) mod build;
pub(crate) mod check;
mod coat;
mod dye;
pub(crate) mod error;
pub(crate) mod fields;
mod library;
mod lookup;
mod materials;
pub mod model;
mod origin;
mod overrides;
mod pattern;
pub(crate) mod recipe;
mod schema;
pub(crate) mod shape;
mod spectrum;
mod start;
mod stations;
pub(crate) mod tree;
mod words;

pub use coat::{
    COAT_LIBRARY, CoatLayer, CoatLimit, CoatPattern, CoatRecipe, CoatZone, Extent, Join, Lay,
    MAX_ZONES, Side, Turing, coat_names,
};
pub use dye::Dye;
pub(crate) use dye::coat_color;
pub use error::{Place, Problem, SpeciesError, SpeciesErrors};
pub use library::{LIBRARY, ids};
pub use materials::{Boundary, Filling, Material, Materials, Rgb};
pub use model::*;
pub use origin::{Cited, Origin, Origins, Reference};
pub use pattern::{
    CuticlePattern, CyclesPer, MarginTerm, MarginWave, PATTERN_LIBRARY, PatternLayout,
    PatternRecipe, RowPhase, pattern_names,
};
pub use schema::{coat_schema, json_schema, pattern_schema, scene_schema};
pub use start::{is_id, start_from};

use crate::io::{FileError, read_bounded};
use error::Problems;
use std::io::{Error, ErrorKind};
use std::path::Path;

/// Longest species file, bytes. The built-in ones have about 10 kB.
const FILE_LIMIT: u64 = 4 << 20;

/// Loads a species.
///
/// * `name_or_path`: a built-in species by its id, a common or scientific name or one distinctive
///   word of them (`fox`, `Vulpes vulpes`), in any case; or a path that ends in `.toml`.
/// * `overrides`: `key.path=value` each, applied in order.
///
/// # Errors
/// An unknown or ambiguous name, an unreadable file, or everything that is wrong with the file and the overrides.
pub fn load(name_or_path: &str, overrides: &[String]) -> Result<Species, SpeciesError> {
    load_with_origins(name_or_path, overrides).map(|(species, _)| species)
}

/// As [`load`], with the origin of every number.
pub fn load_with_origins(
    name_or_path: &str,
    overrides: &[String],
) -> Result<(Species, Origins), SpeciesError> {
    let path = Path::new(name_or_path);
    let is_file = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if !is_file {
        let (id, text) = lookup::find(name_or_path)?;
        return Ok(parse(text, id, &format!("{id}.toml"), overrides)?);
    }
    let bytes = read_bounded(path, FILE_LIMIT)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let byte = e.utf8_error().valid_up_to();
        let reason = format!("it is not UTF-8 text: byte {byte} is no character");
        FileError::new("read", path, Error::new(ErrorKind::InvalidData, reason))
    })?;
    let id = path
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    Ok(parse(&text, &id, name_or_path, overrides)?)
}

impl Species {
    /// Gives it another coat: a built-in one by its name, one from the file at a path that ends in `.toml`,
    /// or `none`.
    ///
    /// # Errors
    /// An unknown name, an unreadable file, or everything that is wrong with it.
    pub fn wear(&mut self, coat: &str) -> Result<(), SpeciesError> {
        if coat == "none" {
            self.coat = None;
            return Ok(());
        }
        let (recipe, text) = coat::coat_of(coat, Path::new(""))?;
        self.text.push_str(&build::as_comment(coat, &text));
        self.coat = Some(recipe);
        self.estimate_dyes();
        Ok(())
    }
}

/// Reads the text of a species file.
///
/// * `id`: id of the species; `file`: name of the file for messages; its folder is where relative
///   paths in it begin.
///
/// # Errors
/// Everything that is wrong with the text and the overrides.
pub fn parse(
    text: &str,
    id: &str,
    file: &str,
    overrides: &[String],
) -> Result<(Species, Origins), SpeciesErrors> {
    let mut problems = Problems::default();
    let refuse = |problems: Problems| match problems.finish(file, text, overrides) {
        Err(errors) => errors,
        Ok(()) => SpeciesErrors::unexplained(file, text, overrides),
    };
    let mut root = match tree::parse(text) {
        Ok(root) => root,
        Err((message, span)) => {
            problems.push(&Place::File(span), format!("not TOML: {message}"), None);
            return Err(refuse(problems));
        }
    };
    overrides::apply(&mut root, overrides, &mut problems);
    let (checked, origins) = check::check(&root, &mut problems);
    let full_text = format!("{text}{}", overrides::as_comments(overrides));
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    match build::build(&checked, id, full_text, folder, &mut problems) {
        Some(species) if problems.is_empty() => Ok((species, origins)),
        _ => Err(refuse(problems)),
    }
}

#[cfg(test)]
mod tests;
