//! Where numbers come from: `source`, `estimate` and `note`, beside the number or for a whole table.

use super::{Checker, Value, join};
use crate::species::error::{Place, closest, suggestion};
use crate::species::fields;
use crate::species::origin::{Cited, Origin, Reference};
use crate::species::shape::{CITATION, Field, Kind};
use crate::species::tree::{Data, Node, Table, quote};

/// Origin of the bare numbers of a table.
pub(super) type Cover = Option<(Origin, Option<String>)>;

impl Checker<'_> {
    pub(super) fn read_sources(&mut self, root: &Table) {
        // A misspelt table is reported once as an unknown key, not again for each reference to it.
        let is_it = |key: &str| {
            let unknown = fields::SPECIES.field(key).is_none();
            key == "sources" || (unknown && closest(key, ["sources"]).is_some())
        };
        let Some(entry) = root.entries.iter().find(|e| is_it(&e.key)) else {
            return;
        };
        let Data::Table(table) = &entry.node.data else {
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

    pub(super) fn sources(&mut self, node: &Node, path: &str) -> Value {
        let Data::Table(table) = &node.data else {
            return self.wrong(node, path, "a table of references");
        };
        for entry in &table.entries {
            self.text(&entry.node, &join(path, &entry.key), 1000);
            let length = entry.key.chars().count();
            if !(1..=60).contains(&length) || entry.key.contains(char::is_control) {
                let message = format!(
                    "`{path}` has the key {}, expected 1 to 60 characters, none of them a control \
                     character",
                    quote(&entry.key)
                );
                self.problems.push(&entry.key_place, message, None);
            }
        }
        Value::Refused
    }

    /// A number or list of numbers, bare or as `{ value = .., source = .. }`.
    pub(super) fn numbers(
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
            Kind::Number(range)
            | Kind::Whole(range)
            | Kind::Numbers(_, range)
            | Kind::Color(range) => range.unit,
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

    /// Only `value` and the citation keys may stand beside a number. Gives whether an unknown key was
    /// probably meant to be `value`.
    fn citation_keys(&mut self, table: &Table, path: &str) -> bool {
        const KEYS: [&str; 4] = ["value", CITATION[0], CITATION[1], CITATION[2]];
        let mut misspelt = false;
        for entry in &table.entries {
            if !KEYS.contains(&entry.key.as_str()) {
                let message = format!("unknown key `{}`", join(path, &entry.key));
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
    pub(super) fn citation(&mut self, table: &Table, path: &str, known: &[&str]) -> Cover {
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
                    let hint = if known.is_empty() {
                        format!("name it there: {key} = \"who, when, what\"")
                    } else {
                        suggestion(closest(key, known.iter().copied()), &known)
                    };
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
