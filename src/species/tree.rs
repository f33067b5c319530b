//! A TOML document as a tree in which every key and value knows where it was written.

use super::error::Place;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Where it was written.
    pub(crate) place: Place,
    /// What it is.
    pub(crate) data: Data,
}

/// What a value is.
#[derive(Clone, Debug)]
pub(crate) enum Data {
    /// A string.
    Text(String),
    /// A number, and whether it was written as an integer.
    Number(f64, bool),
    /// Anything else that TOML has and species files do not: its name.
    Other(&'static str),
    /// An array.
    Array(Vec<Node>),
    /// A table.
    Table(Table),
}

/// A key and its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// The key.
    pub(crate) key: String,
    /// Where the key was written.
    pub(crate) key_place: Place,
    /// The value.
    pub(crate) node: Node,
}

/// A table in the order of the file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Its entries; keys are unique.
    pub(crate) entries: Vec<Entry>,
}

impl Table {
    /// The value of a key.
    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        self.entries.iter().find(|e| e.key == key).map(|e| &e.node)
    }

    /// The value of a key, to be changed.
    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries
            .iter_mut()
            .find(|e| e.key == key)
            .map(|e| &mut e.node)
    }

    /// Replaces or adds a value that stands at `node.place`, and gives it back.
    pub(crate) fn put(&mut self, key: &str, node: Node) -> &mut Node {
        let index = match self.entries.iter().position(|e| e.key == key) {
            Some(index) => {
                self.entries[index].node = node;
                index
            }
            None => {
                self.entries.push(Entry {
                    key: key.to_owned(),
                    key_place: node.place.clone(),
                    node,
                });
                self.entries.len() - 1
            }
        };
        &mut self.entries[index].node
    }
}

impl Node {
    /// What stands here, for messages: `text "abc"`, `900`, `a table`. Long texts are cut.
    pub(crate) fn describe(&self) -> String {
        match &self.data {
            Data::Text(text) => format!("the text {}", quote(text)),
            Data::Number(value, _) if value.abs() >= 1e15 => format!("{value:e}"),
            Data::Number(value, _) => format!("{value}"),
            Data::Other(name) => (*name).to_owned(),
            Data::Array(items) => format!("an array of {}", items.len()),
            Data::Table(_) => "a table".to_owned(),
        }
    }
}

/// `text` in quotes, at most 60 characters.
pub(crate) fn quote(text: &str) -> String {
    let cut: String = text.chars().take(60).collect();
    let dots = if cut.len() < text.len() { "..." } else { "" };
    format!("\"{cut}{dots}\"")
}

/// Reads a document. The parser itself limits nesting to 80 levels.
///
/// # Errors
/// The first violation of TOML's syntax: message and byte span.
pub(crate) fn parse(text: &str) -> Result<Table, (String, Range<usize>)> {
    let document = DeTable::parse(text).map_err(|e| syntax(&e, text.len()))?;
    Ok(table(document.get_ref(), &Where::File))
}

/// Reads the value of an override; a bare word counts as text.
pub(crate) fn parse_override(text: &str, index: usize) -> Node {
    let origin = Where::Set(index);
    match DeValue::parse(text) {
        Ok(value) => node(&value, &origin),
        Err(_) => Node {
            place: Place::Set(index),
            data: Data::Text(text.to_owned()),
        },
    }
}

fn syntax(error: &toml::de::Error, end: usize) -> (String, Range<usize>) {
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    (message, error.span().unwrap_or(end..end))
}

/// Which text spans refer to.
enum Where {
    File,
    Set(usize),
}

impl Where {
    fn place(&self, span: Range<usize>) -> Place {
        match self {
            Self::File => Place::File(span),
            Self::Set(index) => Place::Set(*index),
        }
    }
}

fn table(source: &DeTable<'_>, origin: &Where) -> Table {
    let mut spanned: Vec<(usize, Entry)> = source
        .iter()
        .map(|(key, value)| {
            let entry = Entry {
                key: key.get_ref().to_string(),
                key_place: origin.place(key.span()),
                node: node(value, origin),
            };
            (key.span().start, entry)
        })
        .collect();
    spanned.sort_by_key(|(start, _)| *start);
    Table {
        entries: spanned.into_iter().map(|(_, entry)| entry).collect(),
    }
}

fn array(source: &DeArray<'_>, origin: &Where) -> Vec<Node> {
    source.iter().map(|value| node(value, origin)).collect()
}

fn node(source: &Spanned<DeValue<'_>>, origin: &Where) -> Node {
    let data = match source.get_ref() {
        DeValue::String(text) => Data::Text(text.to_string()),
        DeValue::Integer(digits) => Data::Number(
            i128::from_str_radix(digits.as_str(), digits.radix())
                .map_or(f64::INFINITY, |value| value as f64),
            true,
        ),
        DeValue::Float(digits) => Data::Number(digits.as_str().parse().unwrap_or(f64::NAN), false),
        DeValue::Boolean(true) => Data::Other("true"),
        DeValue::Boolean(false) => Data::Other("false"),
        DeValue::Datetime(_) => Data::Other("a date"),
        DeValue::Array(items) => Data::Array(array(items, origin)),
        DeValue::Table(entries) => Data::Table(table(entries, origin)),
    };
    Node {
        place: origin.place(source.span()),
        data,
    }
}
