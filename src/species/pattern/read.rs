//! Reading a recipe: the same two passes as for species files.

use super::fields::PATTERN;
use super::{
    CuticlePattern, CyclesPer, MarginTerm, MarginWave, PatternLayout, PatternRecipe, RowPhase,
};
use crate::species::build::{number, tables};
use crate::species::check::Checked;
use crate::species::error::{Problems, SpeciesError, SpeciesErrors};
use crate::species::recipe::{self, need, text, word};
use std::path::Path;

/// The recipe in a file, whose name is that of the file, and the text of it.
///
/// # Errors
/// An unreadable file, or everything that is wrong with it.
pub(crate) fn recipe_of(path: &Path) -> Result<(CuticlePattern, String), SpeciesError> {
    let text = recipe::read(path)?;
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
    recipe::parse(text, file, &PATTERN, |root, problems| {
        build(root, name, problems)
    })
}

/// Builds a checked recipe; `None` only if a problem was reported.
fn build(root: &Checked, name: &str, problems: &mut Problems) -> Option<PatternRecipe> {
    let mut need = |table: &Checked, key: &str| need(table, key, problems);
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
    for term in tables(root, "margin").unwrap_or_default() {
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
        summary: text(root, "summary")?,
        rise: number(root, "rise").unwrap_or(1.0),
        layout,
        margin,
    })
}
