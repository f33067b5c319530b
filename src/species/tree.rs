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
    /// True or false.
    Flag(bool),
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
            Data::Flag(flag) => format!("{flag}"),
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

/// Levels of nesting that the parser allows; it does not say where there are more.
const DEEPEST: usize = 80;

/// Reads a document. The parser itself limits nesting to [`DEEPEST`] levels.
///
/// # Errors
/// The first violation of TOML's syntax: message and byte span.
pub(crate) fn parse(text: &str) -> Result<Table, (String, Range<usize>)> {
    let document = DeTable::parse(text).map_err(|e| syntax(&e, text))?;
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

fn syntax(error: &toml::de::Error, text: &str) -> (String, Range<usize>) {
    if let Some(span) = error.span() {
        let message = error.message().lines().collect::<Vec<_>>().join(", ");
        return (message, span);
    }
    match too_deep(text) {
        Some(at) => (
            format!("nested deeper than {DEEPEST} levels"),
            at..(at + 1).min(text.len()),
        ),
        None => (error.message().to_owned(), text.len()..text.len()),
    }
}

/// The byte at which brackets and dotted keys first go deeper than the parser allows; strings and
/// comments do not count.
fn too_deep(text: &str) -> Option<usize> {
    let (mut brackets, mut dots) = (0_usize, 0_usize);
    let mut quote: Option<u8> = None;
    let mut escaped = false;
    let mut comment = false;
    for (at, byte) in text.bytes().enumerate() {
        match (byte, quote) {
            (b'\n', _) => {
                (comment, dots) = (false, 0);
                // A single-line string ends here, and this scan does not know of others.
                quote = None;
            }
            _ if comment => {}
            (b'\\', Some(b'"')) if !escaped => {
                escaped = true;
                continue;
            }
            (_, Some(open)) if byte == open && !escaped => quote = None,
            (_, Some(_)) => {}
            (b'"' | b'\'', None) => quote = Some(byte),
            (b'#', None) => comment = true,
            (b'[' | b'{', None) => brackets += 1,
            (b']' | b'}', None) => brackets = brackets.saturating_sub(1),
            (b'.', None) => dots += 1,
            (b'=' | b',', None) => dots = 0,
            _ => {}
        }
        escaped = false;
        if brackets + dots >= DEEPEST {
            return Some(at);
        }
    }
    None
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
        DeValue::Boolean(flag) => Data::Flag(*flag),
        DeValue::Datetime(_) => Data::Other("a date"),
        DeValue::Array(items) => Data::Array(array(items, origin)),
        DeValue::Table(entries) => Data::Table(table(entries, origin)),
    };
    Node {
        place: origin.place(source.span()),
        data,
    }
}
