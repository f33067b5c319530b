//! Values: of the right type, in range.

use super::citation::Cover;
use super::{Checker, Value, join};
use crate::species::error::closest;
use crate::species::fields;
use crate::species::shape::{Choice, Field, Kind, Range, Shape};
use crate::species::tree::{Data, Node, quote};

impl Checker<'_> {
    pub(super) fn value(
        &mut self,
        node: &Node,
        field: &'static Field,
        path: &str,
        cover: &Cover,
    ) -> Value {
        match &field.kind {
            Kind::Text(limit) => self.text(node, path, *limit),
            Kind::Texts(most, limit) => self.texts(node, path, *most, *limit),
            Kind::Names => self.names(node, path),
            Kind::Sources => self.sources(node, path),
            Kind::Setting(range) => self.number(node, path, *range, false),
            Kind::Count(range) => self.number(node, path, *range, true),
            Kind::Points(most, range) => self.points(node, path, *most, *range),
            Kind::Settings(count, range) => self.list(node, path, *count, *range),
            Kind::Flag => match node.data {
                Data::Flag(flag) => Value::Flag(flag),
                _ => self.wrong(node, path, "true or false"),
            },
            Kind::Words(choices) => self.words(node, path, choices),
            Kind::Choice(choices) => self.choice(node, path, choices),
            Kind::ChoiceOrFile(choices) => match &node.data {
                Data::Text(text) if text.ends_with(".toml") => self.text(node, path, 1000),
                _ => self.choice(node, path, choices),
            },
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
            Kind::Color(range) => {
                self.numbers(node, field, path, cover, |c, n| c.color(n, path, *range))
            }
        }
    }

    pub(super) fn wrong(&mut self, node: &Node, path: &str, expected: &str) -> Value {
        let message = format!("`{path}` is {}, expected {expected}", node.describe());
        self.problems.push(&node.place, message, None);
        Value::Refused
    }

    pub(super) fn text(&mut self, node: &Node, path: &str, limit: usize) -> Value {
        if let Data::Text(text) = &node.data {
            let words: Vec<&str> = text.split_whitespace().collect();
            let text = words.join(" ");
            let length = text.chars().count();
            if (1..=limit).contains(&length) && !text.contains(char::is_control) {
                return Value::Text(text);
            }
        }
        let expected = format!("text of 1 to {limit} characters, none of them a control character");
        self.wrong(node, path, &expected)
    }

    fn texts(&mut self, node: &Node, path: &str, most: usize, limit: usize) -> Value {
        let expected = format!("a list of at most {most} texts");
        let Data::Array(items) = &node.data else {
            return self.wrong(node, path, &expected);
        };
        if items.len() > most {
            return self.wrong(node, path, &expected);
        }
        let mut texts: Vec<String> = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{path}.{index}");
            match self.text(item, &path, limit) {
                Value::Text(text) if texts.contains(&text) => {
                    self.wrong(item, &path, "each text once");
                }
                Value::Text(text) => texts.push(text),
                _ => {}
            }
        }
        if texts.len() == items.len() {
            Value::Texts(texts)
        } else {
            Value::Refused
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

    fn words(&mut self, node: &Node, path: &str, choices: &'static [Choice]) -> Value {
        let Data::Table(table) = &node.data else {
            return self.wrong(node, path, "a table of names and words");
        };
        let mut words = Vec::new();
        for entry in &table.entries {
            let path = join(path, &entry.key);
            if let Value::Choice(word) = self.choice(&entry.node, &path, choices) {
                words.push((entry.key.clone(), word));
            }
        }
        if words.len() == table.entries.len() {
            Value::Words(words)
        } else {
            Value::Refused
        }
    }

    pub(super) fn subtable(&mut self, node: &Node, shape: &'static Shape, path: &str) -> Value {
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

    pub(super) fn number(&mut self, node: &Node, path: &str, range: Range, whole: bool) -> Value {
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

    fn points(&mut self, node: &Node, path: &str, most: usize, range: Range) -> Value {
        let expected = format!("2 to {most} points such as [0, 0.1, -2]");
        let Data::Array(items) = &node.data else {
            return self.wrong(node, path, &expected);
        };
        if !(2..=most).contains(&items.len()) {
            return self.wrong(node, path, &expected);
        }
        let mut points = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let point = self.list(item, &format!("{path}.{index}"), 3, range);
            if let Value::Numbers(numbers) = point {
                points.extend(<[f64; 3]>::try_from(numbers).ok());
            }
        }
        if points.len() == items.len() {
            Value::Points(points)
        } else {
            Value::Refused
        }
    }

    /// A number for all channels, or three.
    fn color(&mut self, node: &Node, path: &str, range: Range) -> Value {
        match &node.data {
            Data::Array(items) if items.len() == 3 => self.list(node, path, 3, range),
            Data::Array(_) => self.wrong(node, path, &format!("a number from {range}, or three")),
            _ => self.number(node, path, range, false),
        }
    }

    pub(super) fn list(&mut self, node: &Node, path: &str, count: usize, range: Range) -> Value {
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
}

/// Whether a hair class may be called so: the name is a key of the root and part of paths.
pub(super) fn is_class_name(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    (1..=32).contains(&name.len())
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(letter)
        && fields::SPECIES.field(name).is_none()
}
