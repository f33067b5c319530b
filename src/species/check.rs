//! First pass over a species file: every key known, every value of the right type and in range,
//! every number with its origin. What it lets through is typed; what it refuses is reported and
//! marked, so that the second pass does not report it again.

use super::error::{Place, Problems, closest, suggestion};
use super::fields;
use super::origin::{Cited, Origin, Origins, Reference};
use super::shape::{CITATION, Choice, Field, Kind, Presence, Range, Shape};
use super::tree::{Data, Node, Table, quote};

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
    /// Numbers in range, as many as asked for.
    Numbers(Vec<f64>),
    /// Text.
    Text(String),
    /// One of the allowed words.
    Choice(&'static str),
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

/// The names in `classes` that may be keys of class tables; problems are reported elsewhere.
pub(crate) fn class_names(root: &Table) -> Vec<String> {
    let Some(Data::Array(items)) = root.get("classes").map(|n| &n.data) else {
        return Vec::new();
    };
    let text = |n: &Node| match &n.data {
        Data::Text(text) => Some(text.clone()),
        _ => None,
    };
    let free = |name: &String| fields::SPECIES.field(name).is_none();
    items.iter().filter_map(text).filter(free).collect()
}

struct Checker<'a> {
    problems: &'a mut Problems,
    origins: Origins,
}

/// Origin of the bare numbers of a table.
type Cover = Option<(Origin, Option<String>)>;

impl Checker<'_> {
    fn read_sources(&mut self, root: &Table) {
        let Some(Data::Table(table)) = root.get("sources").map(|n| &n.data) else {
            return;
        };
        for entry in &table.entries {
            if let Data::Text(text) = &entry.node.data {
                self.origins.references.push(Reference {
                    key: entry.key.clone(),
                    text: text.clone(),
                });
            }
        }
    }

    fn table(
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
        entry: &super::tree::Entry,
        table: &Table,
        shape: &'static Shape,
        classes: &[String],
        checked: &mut Checked,
    ) {
        let path = checked.path_of(&entry.key);
        let message = format!("unknown key `{}`", path.escape_debug());
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
        if std::ptr::eq(shape, &fields::SPECIES) && matches!(entry.node.data, Data::Table(_)) {
            hint.push_str("; the tables of hair classes are named in `classes`");
        }
        self.problems.push(&entry.key_place, message, Some(hint));
    }

    /// Keys that have no meaning with the choice made beside them.
    fn idle_keys(&mut self, table: &Table, shape: &Shape, checked: &Checked) {
        for field in shape.fields {
            let Kind::Choice(choices) = &field.kind else {
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

    fn value(&mut self, node: &Node, field: &'static Field, path: &str, cover: &Cover) -> Value {
        match &field.kind {
            Kind::Text(limit) => self.text(node, path, *limit),
            Kind::Names => self.names(node, path),
            Kind::Sources => self.sources(node, path),
            Kind::Choice(choices) => self.choice(node, path, choices),
            Kind::Table(shape) => self.subtable(node, shape, path),
            Kind::Tables(shape, most) => self.tables(node, shape, *most, path),
            Kind::Number(range) => self.numbers(node, field, path, cover, |c, n| {
                c.number(n, path, *range, false)
            }),
            Kind::Whole(range) => self.numbers(node, field, path, cover, |c, n| {
                c.number(n, path, *range, true)
            }),
            Kind::Numbers(count, range) => self.numbers(node, field, path, cover, |c, n| {
                c.list(n, path, *count, *range)
            }),
        }
    }

    fn wrong(&mut self, node: &Node, path: &str, expected: &str) -> Value {
        let message = format!("`{path}` is {}, expected {expected}", node.describe());
        self.problems.push(&node.place, message, None);
        Value::Refused
    }

    fn text(&mut self, node: &Node, path: &str, limit: usize) -> Value {
        match &node.data {
            Data::Text(text) if (1..=limit).contains(&text.trim().chars().count()) => {
                Value::Text(text.trim().to_owned())
            }
            _ => self.wrong(node, path, &format!("text of 1 to {limit} characters")),
        }
    }

    fn names(&mut self, node: &Node, path: &str) -> Value {
        let expected = "1 to 8 names of hair classes such as \"guard\", \"under\"";
        let Data::Array(items) = &node.data else {
            return self.wrong(node, path, expected);
        };
        if items.is_empty() || items.len() > 8 {
            return self.wrong(node, path, expected);
        }
        let mut names: Vec<String> = Vec::new();
        let mut good = true;
        for item in items {
            match &item.data {
                Data::Text(name) if is_class_name(name) && !names.contains(name) => {
                    names.push(name.clone());
                }
                _ => {
                    let expected = "a name of its own: lower-case letters, digits and `-`, \
                                    not one of the other keys";
                    self.wrong(item, path, expected);
                    good = false;
                }
            }
        }
        if good {
            Value::Names(names)
        } else {
            Value::Refused
        }
    }

    fn sources(&mut self, node: &Node, path: &str) -> Value {
        let Data::Table(table) = &node.data else {
            return self.wrong(node, path, "a table of references");
        };
        for entry in &table.entries {
            self.text(&entry.node, &join(path, &entry.key), 1000);
        }
        Value::Refused
    }

    fn choice(&mut self, node: &Node, path: &str, choices: &'static [Choice]) -> Value {
        let names: Vec<&'static str> = choices.iter().map(|c| c.name).collect();
        let Data::Text(text) = &node.data else {
            return self.wrong(node, path, &format!("one of {}", names.join(", ")));
        };
        if let Some(name) = names.iter().find(|n| *n == text) {
            return Value::Choice(name);
        }
        let message = format!(
            "`{path}` is {}, expected one of {}",
            quote(text),
            names.join(", ")
        );
        let hint = closest(text, names.iter().copied());
        let hint = hint.map(|name| format!("did you mean \"{name}\"?"));
        self.problems.push(&node.place, message, hint);
        Value::Refused
    }

    fn subtable(&mut self, node: &Node, shape: &'static Shape, path: &str) -> Value {
        match &node.data {
            Data::Table(table) => {
                Value::Table(self.table(table, &node.place, shape, &[], path.to_owned()))
            }
            _ => self.wrong(node, path, "a table"),
        }
    }

    fn tables(&mut self, node: &Node, shape: &'static Shape, most: usize, path: &str) -> Value {
        let expected = format!("a list of 1 to {most} tables");
        let Data::Array(items) = &node.data else {
            return self.wrong(node, path, &expected);
        };
        if items.is_empty() || items.len() > most {
            return self.wrong(node, path, &expected);
        }
        let mut tables = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{path}.{index}");
            match self.subtable(item, shape, &path) {
                Value::Table(table) => tables.push(table),
                _ => return Value::Refused,
            }
        }
        Value::Tables(tables)
    }

    /// A number or list of numbers, bare or as `{ value = .., source = .. }`.
    fn numbers(
        &mut self,
        node: &Node,
        field: &'static Field,
        path: &str,
        cover: &Cover,
        read: impl Fn(&mut Self, &Node) -> Value,
    ) -> Value {
        let (bare, cover) = match &node.data {
            Data::Table(table) => {
                let misspelt = self.citation_keys(table, path);
                let own = self.citation(table, path, &["value"]);
                let Some(bare) = table.get("value") else {
                    if !misspelt {
                        let message = format!("`{path}.value` is missing");
                        self.problems.push(&node.place, message, None);
                    }
                    return Value::Refused;
                };
                (bare, own.or_else(|| cover.clone()))
            }
            _ => (node, cover.clone()),
        };
        let value = read(self, bare);
        let cover = if is_overridden(bare) {
            Some((Origin::Override, None))
        } else {
            cover
        };
        let Some((origin, note)) = cover else {
            if !matches!(value, Value::Refused) {
                let message = format!("`{path}` does not say where it comes from");
                let hint = "write { value = .., source = \"KEY\" } or { value = .., estimate = \
                            \"why\" }, or put `source` or `estimate` into its table";
                self.problems
                    .push(&node.place, message, Some(hint.to_owned()));
            }
            return value;
        };
        let unit = match &field.kind {
            Kind::Number(range) | Kind::Whole(range) | Kind::Numbers(_, range) => range.unit,
            _ => "",
        };
        let values = match &value {
            Value::Number(number) => vec![*number],
            Value::Numbers(numbers) => numbers.clone(),
            _ => return value,
        };
        self.origins.numbers.push(Cited {
            path: path.to_owned(),
            values,
            unit,
            meaning: field.doc,
            origin,
            note,
        });
        value
    }

    fn number(&mut self, node: &Node, path: &str, range: Range, whole: bool) -> Value {
        match &node.data {
            Data::Number(value, integer) if range.holds(*value) && (*integer || !whole) => {
                Value::Number(*value)
            }
            _ => {
                let kind = if whole { "a whole number" } else { "a number" };
                self.wrong(node, path, &format!("{kind} from {range}"))
            }
        }
    }

    fn list(&mut self, node: &Node, path: &str, count: usize, range: Range) -> Value {
        let Data::Array(items) = &node.data else {
            return self.wrong(node, path, &format!("{count} numbers from {range}"));
        };
        if items.len() != count {
            return self.wrong(node, path, &format!("{count} numbers from {range}"));
        }
        let mut numbers = Vec::new();
        for (index, item) in items.iter().enumerate() {
            if let Value::Number(v) = self.number(item, &format!("{path}.{index}"), range, false) {
                numbers.push(v);
            }
        }
        if numbers.len() == count {
            Value::Numbers(numbers)
        } else {
            Value::Refused
        }
    }

    /// Only `value` and the citation keys may stand beside a number. Gives whether an unknown key was
    /// probably meant to be `value`.
    fn citation_keys(&mut self, table: &Table, path: &str) -> bool {
        const KEYS: [&str; 4] = ["value", CITATION[0], CITATION[1], CITATION[2]];
        let mut misspelt = false;
        for entry in &table.entries {
            if !KEYS.contains(&entry.key.as_str()) {
                let message = format!("unknown key `{}`", join(path, &entry.key).escape_debug());
                let meant = closest(&entry.key, KEYS);
                misspelt |= meant == Some("value");
                self.problems
                    .push(&entry.key_place, message, Some(suggestion(meant, &KEYS)));
            }
        }
        misspelt
    }

    /// What `source`, `estimate` and `note` of a table with the keys `known` say. A citation that is
    /// there but wrong or misspelt is reported once and counts, so that the numbers it covers are not
    /// reported too.
    fn citation(&mut self, table: &Table, path: &str, known: &[&str]) -> Cover {
        let note = match table.get("note") {
            None => None,
            Some(node) => match self.text(node, &join(path, "note"), 1000) {
                Value::Text(text) => Some(text),
                _ => None,
            },
        };
        match (table.get("source"), table.get("estimate")) {
            (None, None) => {
                let misspelt = |key: &str| {
                    !known.contains(&key) && key != "note" && closest(key, CITATION).is_some()
                };
                let covered = table.entries.iter().any(|e| misspelt(&e.key));
                covered.then(|| (Origin::Estimate(String::new()), None))
            }
            (Some(node), None) => {
                let keys = self.source_keys(node, &join(path, "source"));
                Some((Origin::Source(keys), note))
            }
            (None, Some(node)) => match self.text(node, &join(path, "estimate"), 1000) {
                Value::Text(text) => Some((Origin::Estimate(text), note)),
                _ => Some((Origin::Estimate(String::new()), note)),
            },
            (Some(_), Some(node)) => {
                let message = format!(
                    "`{}` stands beside `source`, expected one of the two",
                    join(path, "estimate")
                );
                let hint = "a `note` may explain how a value was taken from its source";
                self.problems
                    .push(&node.place, message, Some(hint.to_owned()));
                Some((Origin::Estimate(String::new()), note))
            }
        }
    }

    fn source_keys(&mut self, node: &Node, path: &str) -> Vec<String> {
        let items = match &node.data {
            Data::Array(items) if !items.is_empty() => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        let mut keys = Vec::new();
        for item in items {
            let known = self.origins.references.iter().map(|r| r.key.as_str());
            let known: Vec<&str> = known.collect();
            match &item.data {
                Data::Text(key) if known.contains(&key.as_str()) => keys.push(key.clone()),
                Data::Text(key) => {
                    let message =
                        format!("`{path}` is {}, expected a key of [sources]", quote(key));
                    let hint = suggestion(closest(key, known.iter().copied()), &known);
                    self.problems.push(&item.place, message, Some(hint));
                }
                _ => {
                    self.wrong(item, path, "a key of [sources] or a list of them");
                }
            }
        }
        keys
    }
}

fn is_overridden(node: &Node) -> bool {
    match (&node.place, &node.data) {
        (Place::Set(_), _) => true,
        (_, Data::Array(items)) => items.iter().any(is_overridden),
        _ => false,
    }
}

fn is_class_name(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    (1..=32).contains(&name.len())
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(letter)
        && fields::SPECIES.field(name).is_none()
}

/// `a.b`, or `b` at the root.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() {
        key.to_owned()
    } else {
        format!("{path}.{key}")
    }
}
