//! Reading a recipe: the same two passes as for species files.

use super::fields::PATTERN;
use super::{
    CuticlePattern, CyclesPer, MarginTerm, MarginWave, PatternLayout, PatternRecipe, RowPhase,
};
use crate::io::{FileError, read_bounded};
use crate::species::check::{Checked, Value, check_table};
use crate::species::error::{Place, Problems, SpeciesErrors};
use crate::species::tree;
use std::io::{Error, ErrorKind};
use std::path::Path;

/// Longest recipe, bytes. The built-in ones have about 1 kB.
const FILE_LIMIT: u64 = 256 << 10;

/// Why a pattern could not be read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PatternError {
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file was read and refused.
    #[error(transparent)]
    Invalid(#[from] SpeciesErrors),
}

/// The recipe in a file, whose name is that of the file, and the text of it.
///
/// # Errors
/// An unreadable file, or everything that is wrong with it.
pub(crate) fn recipe_of(path: &Path) -> Result<(CuticlePattern, String), PatternError> {
    let refuse = |reason: String| {
        let error = Error::new(ErrorKind::InvalidData, reason);
        PatternError::File(FileError::new("read", path, error))
    };
    // A pipe or a device would never end or never begin.
    if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return Err(refuse("it is no regular file".to_owned()));
    }
    let text = String::from_utf8(read_bounded(path, FILE_LIMIT)?)
        .map_err(|e| refuse(format!("it is not UTF-8 text: {}", e.utf8_error())))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let recipe = parse(&text, &name, &path.display().to_string())?;
    Ok((CuticlePattern::Scales(Box::new(recipe)), text))
}

/// Reads the text of a recipe.
///
/// * `file`: for messages.
///
/// # Errors
/// Everything that is wrong with it.
pub(super) fn parse(text: &str, name: &str, file: &str) -> Result<PatternRecipe, SpeciesErrors> {
    let mut problems = Problems::default();
    let recipe = match tree::parse(text) {
        Ok(root) => {
            let (checked, _) = check_table(&root, &PATTERN, &mut problems);
            recipe(&checked, name, &mut problems)
        }
        Err((message, span)) => {
            problems.push(&Place::File(span), format!("not TOML: {message}"), None);
            None
        }
    };
    problems.finish(file, text, &[])?;
    recipe.ok_or_else(|| SpeciesErrors::unexplained(file, text, &[]))
}

/// Builds a checked recipe; `None` only if a problem was reported.
fn recipe(root: &Checked, name: &str, problems: &mut Problems) -> Option<PatternRecipe> {
    let mut need = |table: &Checked, key: &str| {
        let value = number(table, key);
        if table.get(key).is_none() && !table.is_misspelt(key) {
            let message = format!("`{}` is missing", table.path_of(key));
            problems.push(&table.place, message, None);
        }
        value
    };
    let layout = match word(root, "generator")? {
        "petals" => {
            let keys = ["length", "width", "waist", "taper", "stagger"];
            let [length, width, waist, taper, stagger] = keys.map(|key| need(root, key));
            PatternLayout::Petals {
                length: length?,
                width: width?,
                waist: waist?,
                taper: taper?,
                stagger: stagger?,
            }
        }
        "mosaic" => PatternLayout::Mosaic {
            scatter: need(root, "scatter")?,
        },
        _ => PatternLayout::Rows,
    };
    let mut margin = Vec::new();
    for term in crate::species::build::tables(root, "margin").unwrap_or_default() {
        let wave = match word(term, "wave")? {
            "sine" => MarginWave::Sine,
            "triangle" => MarginWave::Triangle,
            "comb" => MarginWave::Comb {
                sharpness: need(term, "sharpness")?,
            },
            _ => MarginWave::Noise {
                rows: number(term, "rows").unwrap_or(1.0) as u32,
                gate: number(term, "gate").unwrap_or(0.0),
            },
        };
        margin.push(MarginTerm {
            wave,
            amplitude: number(term, "amplitude")?,
            cycles: number(term, "cycles")?,
            per: match word(term, "per")? {
                "turn" => CyclesPer::Turn,
                _ => CyclesPer::Scale,
            },
            phase: match word(term, "phase") {
                Some("alternate") => RowPhase::Alternate,
                Some("wander") => RowPhase::Wander,
                Some("random") => RowPhase::Random,
                _ => RowPhase::Same,
            },
        });
    }
    Some(PatternRecipe {
        name: name.to_owned(),
        summary: match root.get("summary").map(|i| &i.value) {
            Some(Value::Text(text)) => text.clone(),
            _ => return None,
        },
        rise: number(root, "rise").unwrap_or(1.0),
        layout,
        margin,
    })
}

fn number(table: &Checked, key: &str) -> Option<f64> {
    crate::species::build::number(table, key)
}

fn word(table: &Checked, key: &str) -> Option<&'static str> {
    match table.get(key)?.value {
        Value::Choice(word) => Some(word),
        _ => None,
    }
}
