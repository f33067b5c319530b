//! Second pass over a species file: from checked values to a [`Species`], with the rules that join
//! several values. Reports what is missing or contradicts itself; goes on after each problem.

mod comb;
mod groom;
mod materials;
mod medulla;
mod modeled;
mod pigment;
mod structure;
mod vary;

use super::check::{Checked, Item, Value};
use super::coat::{CoatRecipe, coat_of};
use super::error::{Place, Problems, SpeciesError, printable};
use super::model::{HairClass, Species};
use std::collections::BTreeMap;
use std::path::Path;

/// Builds the species of a checked root table.
///
/// * `folder`: of the file, where relative paths begin.
///
/// `None` only if a problem was reported, here or by the check.
pub(crate) fn build(
    root: &Checked,
    id: &str,
    text: String,
    folder: &Path,
    problems: &mut Problems,
) -> Option<Species> {
    let mut reader = Reader::new(problems, folder);
    let shared = table(root, "structure");
    let skin = table(root, "skin").and_then(|t| numbers(t, "color"));
    let mut classes = Vec::new();
    let mut complete = true;
    for name in names(root) {
        match root.get(name).map(|i| &i.value) {
            Some(Value::Table(class)) => match reader.class(name, class, shared) {
                Some(class) => classes.push(class),
                None => complete = false,
            },
            Some(_) => complete = false,
            None => {
                complete = false;
                if !root.is_misspelt(name) {
                    reader.problems.push(
                        &root.place,
                        format!("`{name}` is missing: `classes` names it"),
                        Some(format!("add a table [{name}] or take it out of `classes`")),
                    );
                }
            }
        }
    }
    let coat = reader.coat(root);
    let groom = reader.shared_groom(
        root,
        Some(&classes).filter(|all| complete && !all.is_empty()),
    );
    if !complete || classes.is_empty() {
        return None;
    }
    let mut species = Species {
        id: id.to_owned(),
        name: text_of(root, "name")?,
        latin: text_of(root, "latin").unwrap_or_default(),
        family: text_of(root, "family").unwrap_or_default(),
        group: text_of(root, "group").unwrap_or_default(),
        synonyms: texts(root, "synonyms"),
        summary: text_of(root, "summary")?,
        classes,
        groom,
        coat: coat?,
        skin_color: skin?.try_into().ok()?,
        text: text + &as_comments(&reader.recipes),
    };
    species.estimate_dyes();
    Some(species)
}

/// Recipes as comments, to stand at the end of the file's text.
fn as_comments(recipes: &BTreeMap<String, String>) -> String {
    recipes
        .iter()
        .map(|(file, text)| as_comment(file, text))
        .collect()
}

/// A recipe as a comment: without the marks it is the file again.
pub(crate) fn as_comment(file: &str, text: &str) -> String {
    let lines = text.lines().map(|line| match line {
        "" => "#\n".to_owned(),
        _ => format!("# {line}\n"),
    });
    let lines: String = lines.collect();
    format!("\n# Pattern {}:\n{lines}", printable(file))
}

/// Reads checked tables and reports what does not fit together.
pub(crate) struct Reader<'a> {
    pub(super) problems: &'a mut Problems,
    /// Where relative paths begin.
    pub(super) folder: &'a Path,
    /// Texts of the recipes in files of their own, by the paths that name them.
    pub(super) recipes: BTreeMap<String, String>,
    /// Places of problems that several stations may share. See [`Reader::conflict_once`].
    seen: Vec<Place>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(problems: &'a mut Problems, folder: &'a Path) -> Self {
        Self {
            problems,
            folder,
            seen: Vec::new(),
            recipes: BTreeMap::new(),
        }
    }
}

impl Reader<'_> {
    /// The pattern of the coat, if the file names one; `None` after a problem.
    fn coat(&mut self, root: &Checked) -> Option<Option<CoatRecipe>> {
        let Some(item) = root.get("coat") else {
            return Some(None);
        };
        let name = match &item.value {
            Value::Choice(name) => (*name).to_owned(),
            Value::Text(file) => file.clone(),
            _ => return None,
        };
        match coat_of(&name, self.folder) {
            Ok((recipe, text)) => {
                if name.ends_with(".toml") {
                    self.recipes.insert(name, text);
                }
                return Some(Some(recipe));
            }
            Err(error) => self.refused_recipe(&item.place, "coat", "coat", error),
        }
        None
    }

    /// Reports what is wrong with a recipe at the place that names it.
    ///
    /// * `path`: of the key there; `what`: the recipe is of.
    pub(super) fn refused_recipe(
        &mut self,
        place: &Place,
        path: &str,
        what: &str,
        error: SpeciesError,
    ) {
        let SpeciesError::Invalid(errors) = error else {
            let hint = format!("the path of a {what} is relative to this file");
            self.problems
                .push(place, format!("`{path}`: {error}"), Some(hint));
            return;
        };
        for problem in &errors.problems {
            let at = errors.locate(&problem.place);
            let message = format!("`{path}`: {at}: {}", problem.message);
            self.problems.push(place, message, problem.hint.clone());
        }
    }

    fn class(
        &mut self,
        name: &str,
        class: &Checked,
        shared: Option<&Checked>,
    ) -> Option<HairClass> {
        let stations = self.stations(class, shared);
        let pigment = self.pigment(class);
        let groom = table(class, "groom").and_then(|t| self.groom(t));
        Some(HairClass {
            name: name.to_owned(),
            stations: stations?,
            pigment: pigment?,
            groom: groom?,
        })
    }

    /// As [`Reader::conflict`], once for each place: many stations inherit what an outer table says.
    pub(super) fn conflict_once(&mut self, place: &Place, message: String, hint: &str) {
        if !self.seen.contains(place) {
            self.seen.push(place.clone());
            self.conflict(place, message, hint);
        }
    }

    /// Reports that two values do not fit together.
    pub(super) fn conflict(&mut self, place: &Place, message: String, hint: &str) {
        self.problems.push(place, message, Some(hint.to_owned()));
    }
}

/// Names of the hair classes, in order.
fn names(root: &Checked) -> &[String] {
    match root.get("classes").map(|i| &i.value) {
        Some(Value::Names(names)) => names,
        _ => &[],
    }
}

pub(super) fn table<'a>(parent: &'a Checked, key: &str) -> Option<&'a Checked> {
    match &parent.get(key)?.value {
        Value::Table(table) => Some(table),
        _ => None,
    }
}

pub(crate) fn tables<'a>(parent: &'a Checked, key: &str) -> Option<&'a [Checked]> {
    match &parent.get(key)?.value {
        Value::Tables(tables) => Some(tables),
        _ => None,
    }
}

pub(crate) fn flag(parent: &Checked, key: &str) -> Option<bool> {
    match parent.get(key)?.value {
        Value::Flag(flag) => Some(flag),
        _ => None,
    }
}

pub(crate) fn number(parent: &Checked, key: &str) -> Option<f64> {
    parent.get(key).and_then(number_of)
}

pub(super) fn number_of(item: &Item) -> Option<f64> {
    match item.value {
        Value::Number(number) => Some(number),
        _ => None,
    }
}

pub(crate) fn numbers(parent: &Checked, key: &str) -> Option<Vec<f64>> {
    match &parent.get(key)?.value {
        Value::Numbers(numbers) => Some(numbers.clone()),
        _ => None,
    }
}

fn text_of(parent: &Checked, key: &str) -> Option<String> {
    match &parent.get(key)?.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

fn texts(parent: &Checked, key: &str) -> Vec<String> {
    match parent.get(key).map(|i| &i.value) {
        Some(Value::Texts(texts)) => texts.clone(),
        _ => Vec::new(),
    }
}

/// Where a key was written, or its table.
pub(crate) fn place_of<'a>(parent: &'a Checked, key: &str) -> &'a Place {
    parent.get(key).map_or(&parent.place, |i| &i.place)
}
