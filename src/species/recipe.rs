//! Recipes: small files beside species files, read in the same two passes.

use super::build::place_of;
use super::check::{Checked, Value, check_table};
use super::error::{Place, Problems, SpeciesErrors};
use super::fields::CHANNELS;
use super::shape::Shape;
use super::tree;
use crate::io::{Channel, FileError, Picture, Space, read_bounded};
use std::io::{Error, ErrorKind};
use std::path::Path;
use std::sync::Arc;

/// Longest recipe, bytes. The built-in ones have some kB.
const FILE_LIMIT: u64 = 256 << 10;

/// The text of a recipe's file.
pub(crate) fn read(path: &Path) -> Result<String, FileError> {
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
pub(crate) fn parse<T>(
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
pub(crate) fn need(table: &Checked, key: &str, problems: &mut Problems) -> Option<f64> {
    if table.get(key).is_none() {
        missing(table, key, problems);
    }
    super::build::number(table, key)
}

/// The picture that the keys `file`, `channel` and `space` name.
///
/// * `space`: how a PNG is read if the table does not say it.
/// * `folder`: where relative paths begin.
pub(crate) fn picture(
    table: &Checked,
    space: &str,
    folder: &Path,
    problems: &mut Problems,
) -> Option<Arc<Picture>> {
    let Some(file) = text(table, "file") else {
        if table.get("file").is_none() {
            missing(table, "file", problems);
        }
        return None;
    };
    let channel = match word(table, "channel") {
        Some(name) => CHANNELS.iter().position(|c| c.name == name)?,
        None => 0,
    };
    let space = match word(table, "space").unwrap_or(space) {
        "linear" => Space::Linear,
        _ => Space::Srgb,
    };
    match Picture::read(&folder.join(file), Channel::ALL[channel], space) {
        Ok(picture) => Some(Arc::new(picture)),
        Err(error) => {
            let hint = "the path of a map is relative to this file".to_owned();
            let message = format!("`{}`: {error}", table.path_of("file"));
            problems.push(place_of(table, "file"), message, Some(hint));
            None
        }
    }
}

/// Reports a key that has to be there, unless it is under another spelling.
pub(crate) fn missing(table: &Checked, key: &str, problems: &mut Problems) {
    if !table.is_misspelt(key) {
        let message = format!("`{}` is missing", table.path_of(key));
        problems.push(&table.place, message, None);
    }
}

/// A text.
pub(crate) fn text(table: &Checked, key: &str) -> Option<String> {
    match &table.get(key)?.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

/// One word of several.
pub(crate) fn word(table: &Checked, key: &str) -> Option<&'static str> {
    match table.get(key)?.value {
        Value::Choice(word) => Some(word),
        _ => None,
    }
}
