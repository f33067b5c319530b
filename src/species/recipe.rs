//! Recipes: small files beside species files, read in the same two passes.

use super::check::{Checked, Value, check_table};
use super::error::{Place, Problems, SpeciesErrors};
use super::shape::Shape;
use super::tree;
use crate::io::{FileError, read_bounded};
use std::io::{Error, ErrorKind};
use std::path::Path;

/// Longest recipe, bytes. The built-in ones have some kB.
const FILE_LIMIT: u64 = 256 << 10;

/// The text of a recipe's file.
pub(super) fn read(path: &Path) -> Result<String, FileError> {
    let refuse =
        |reason: String| FileError::new("read", path, Error::new(ErrorKind::InvalidData, reason));
    // A pipe or a device would never end or never begin.
    if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return Err(refuse("it is no regular file".to_owned()));
    }
    String::from_utf8(read_bounded(path, FILE_LIMIT)?)
        .map_err(|e| refuse(format!("it is not UTF-8 text: {}", e.utf8_error())))
}

/// Checks the text of a recipe against its shape and builds it.
///
/// * `file`: for messages.
/// * `build`: gives `None` only if a problem was reported.
///
/// # Errors
/// Everything that is wrong with it.
pub(super) fn parse<T>(
    text: &str,
    file: &str,
    shape: &'static Shape,
    build: impl FnOnce(&Checked, &mut Problems) -> Option<T>,
) -> Result<T, SpeciesErrors> {
    let mut problems = Problems::default();
    let recipe = match tree::parse(text) {
        Ok(root) => {
            let (checked, _) = check_table(&root, shape, &mut problems);
            build(&checked, &mut problems)
        }
        Err((message, span)) => {
            problems.push(&Place::File(span), format!("not TOML: {message}"), None);
            None
        }
    };
    problems.finish(file, text, &[])?;
    recipe.ok_or_else(|| SpeciesErrors::unexplained(file, text, &[]))
}

/// A number that this recipe has to state.
pub(super) fn need(table: &Checked, key: &str, problems: &mut Problems) -> Option<f64> {
    if table.get(key).is_none() {
        missing(table, key, problems);
    }
    super::build::number(table, key)
}

/// Reports a key that has to be there, unless it is under another spelling.
pub(super) fn missing(table: &Checked, key: &str, problems: &mut Problems) {
    if !table.is_misspelt(key) {
        let message = format!("`{}` is missing", table.path_of(key));
        problems.push(&table.place, message, None);
    }
}

/// A text.
pub(super) fn text(table: &Checked, key: &str) -> Option<String> {
    match &table.get(key)?.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

/// One word of several.
pub(super) fn word(table: &Checked, key: &str) -> Option<&'static str> {
    match table.get(key)?.value {
        Value::Choice(word) => Some(word),
        _ => None,
    }
}
