//! First pass over a species file: every key known, every value of the right type and in range,
//! every number with its origin. What it lets through is typed; what it refuses is reported and
//! marked, so that the second pass does not report it again.

mod citation;
mod values;

use values::is_class_name;

use super::error::{Place, Problems, closest, suggestion};
use super::fields;
use super::origin::Origins;
use super::shape::{CITATION, Choice, Field, Kind, Presence, Shape};
use super::tree::{Data, Entry, Node, Table};

/// A table that went through the check.
#[derive(Debug)]
pub(crate) struct Checked {
    /// Path of the table, empty for the root.
    pub(crate) path: String,
    /// Where it was written.
    pub(crate) place: Place,
    items: Vec<Item>,
    /// Keys that somebody probably meant when writing an unknown one.
    misspelt: Vec<String>,
}

/// A value that went through the check.
#[derive(Debug)]
pub(crate) struct Item {
    key: String,
    /// Where the value was written.
    pub(crate) place: Place,
    /// The value.
    pub(crate) value: Value,
}

/// A typed value.
#[derive(Debug)]
pub(crate) enum Value {
    /// A number in range.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// Numbers in range, as many as asked for.
    Numbers(Vec<f64>),
    /// Places in space.
    Points(Vec<[f64; 3]>),
    /// Text.
    Text(String),
    /// One of the allowed words.
    Choice(&'static str),
    /// Texts, no two alike.
    Texts(Vec<String>),
    /// Free keys and their words, in the order of the file.
    Words(Vec<(String, &'static str)>),
    /// Names of hair classes.
    Names(Vec<String>),
    /// A table.
    Table(Checked),
    /// Tables.
    Tables(Vec<Checked>),
    /// Refused and reported.
    Refused,
}

impl Checked {
    /// The value of a key.
    pub(crate) fn get(&self, key: &str) -> Option<&Item> {
        self.items.iter().find(|i| i.key == key)
    }

    /// Whether the absence of a key has been explained by a misspelling.
    pub(crate) fn is_misspelt(&self, key: &str) -> bool {
        self.misspelt.iter().any(|k| k == key)
    }

    /// The path of a key of this table.
    pub(crate) fn path_of(&self, key: &str) -> String {
        join(&self.path, key)
    }
}

/// Checks the root table.
pub(crate) fn check(root: &Table, problems: &mut Problems) -> (Checked, Origins) {
    let mut checker = Checker {
        problems,
        origins: Origins::default(),
    };
    checker.read_sources(root);
    let classes = class_names(root);
    let place = Place::File(0..0);
    let checked = checker.table(root, &place, &fields::SPECIES, &classes, String::new());
    (checked, checker.origins)
}

/// Checks a document of another shape, without hair classes.
pub(crate) fn check_table(
    root: &Table,
    shape: &'static Shape,
    problems: &mut Problems,
) -> (Checked, Origins) {
    let mut checker = Checker {
        problems,
        origins: Origins::default(),
    };
    checker.read_sources(root);
    let checked = checker.table(root, &Place::File(0..0), shape, &[], String::new());
    (checked, checker.origins)
}

/// The names in `classes` that may be keys of class tables; problems are reported elsewhere. Without
/// a list, every table that is not a key of the root is taken for a class, so that one missing key
/// does not hide the others' problems.
pub(crate) fn class_names(root: &Table) -> Vec<String> {
    let Some(Data::Array(items)) = root.get("classes").map(|n| &n.data) else {
        let tables = root
            .entries
            .iter()
            .filter(|e| matches!(e.node.data, Data::Table(_)));
        let names = tables
            .map(|e| e.key.clone())
            .filter(|name| is_class_name(name));
        return names
            .filter(|name| closest(name, SPECIES_KEYS).is_none())
            .collect();
    };
    let text = |n: &Node| match &n.data {
        Data::Text(text) => Some(text.clone()),
        _ => None,
    };
    items
        .iter()
        .filter_map(text)
        .filter(|name| is_class_name(name))
        .collect()
}

/// Keys of tables at the root that are no classes.
const SPECIES_KEYS: [&str; 3] = ["skin", "structure", "sources"];

struct Checker<'a> {
    problems: &'a mut Problems,
    origins: Origins,
}

impl Checker<'_> {
    pub(super) fn table(
        &mut self,
        table: &Table,
        place: &Place,
        shape: &'static Shape,
        classes: &[String],
        path: String,
    ) -> Checked {
        let mut checked = Checked {
            path,
            place: place.clone(),
            items: Vec::new(),
            misspelt: Vec::new(),
        };
        let cover = if shape.cited {
            let fields = shape.fields.iter().map(|f| f.key);
            self.citation(table, &checked.path, &fields.collect::<Vec<_>>())
        } else {
            None
        };
        for entry in &table.entries {
            let path = checked.path_of(&entry.key);
            let value = if let Some(field) = shape.field(&entry.key) {
                self.value(&entry.node, field, &path, &cover)
            } else if classes.contains(&entry.key) {
                self.subtable(&entry.node, &fields::CLASS, &path)
            } else if shape.cited && CITATION.contains(&entry.key.as_str()) {
                continue;
            } else {
                self.unknown_key(entry, table, shape, classes, &mut checked);
                continue;
            };
            checked.items.push(Item {
                key: entry.key.clone(),
                place: entry.node.place.clone(),
                value,
            });
        }
        self.idle_keys(table, shape, &checked);
        for field in shape.fields {
            if field.presence == Presence::Required
                && checked.get(field.key).is_none()
                && !checked.is_misspelt(field.key)
            {
                self.missing(&checked, field);
            }
        }
        checked
    }

    fn missing(&mut self, table: &Checked, field: &Field) {
        let message = format!("`{}` is missing", table.path_of(field.key));
        self.problems
            .push(&table.place, message, Some(field.doc.to_owned()));
    }

    fn unknown_key(
        &mut self,
        entry: &Entry,
        table: &Table,
        shape: &'static Shape,
        classes: &[String],
        checked: &mut Checked,
    ) {
        let path = checked.path_of(&entry.key);
        let message = format!("unknown key `{path}`");
        if self.problems.is_full() {
            return self.problems.push(&entry.key_place, message, None);
        }
        let absent = |key: &&str| table.get(key).is_none();
        let known: Vec<&'static str> = shape.keys().collect();
        // A key that is still missing is likelier meant than one that is there already.
        let own = closest(&entry.key, known.iter().copied().filter(absent))
            .or_else(|| closest(&entry.key, known.iter().copied()));
        let names = classes.iter().map(String::as_str);
        let class = closest(&entry.key, names.clone());
        checked.misspelt.extend(own.or(class).map(str::to_owned));
        let all: Vec<&str> = known.iter().copied().chain(names).collect();
        let mut hint = suggestion(own.or(class), &all);
        let is_root = std::ptr::eq(shape, &fields::SPECIES);
        if is_root && own.or(class).is_none() && matches!(entry.node.data, Data::Table(_)) {
            hint.push_str("; the tables of hair classes are named in `classes`");
        }
        self.problems.push(&entry.key_place, message, Some(hint));
    }

    /// Keys that have no meaning with the choice made beside them.
    fn idle_keys(&mut self, table: &Table, shape: &Shape, checked: &Checked) {
        for field in shape.fields {
            let (Kind::Choice(choices) | Kind::ChoiceOrFile(choices)) = &field.kind else {
                continue;
            };
            let Some(item) = checked.get(field.key) else {
                continue;
            };
            // An override of the choice leaves the file's other parameters behind, unused.
            let (Value::Choice(chosen), Place::File(_)) = (&item.value, &item.place) else {
                continue;
            };
            for entry in &table.entries {
                let owners: Vec<&Choice> = choices
                    .iter()
                    .filter(|c| c.keys.contains(&entry.key.as_str()))
                    .collect();
                if owners.is_empty() || owners.iter().any(|c| c.name == *chosen) {
                    continue;
                }
                let path = checked.path_of(&entry.key);
                let message = format!("`{path}` has no meaning with {} \"{chosen}\"", field.key);
                let names: Vec<&str> = owners.iter().map(|c| c.name).collect();
                let hint = format!("it belongs to {}", names.join(", "));
                self.problems.push(&entry.key_place, message, Some(hint));
            }
        }
    }
}

/// `a.b`, or `b` at the root.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() {
        key.to_owned()
    } else {
        format!("{path}.{key}")
    }
}
