//! Named values of one part, with the complaints of a careful reader.

use crate::table::TableError;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::str::FromStr;

/// The three attribute types in use; every OpenEXR library knows them.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Int(i32),
    Double(f64),
    Text(String),
}

/// The `vair:` attributes of a part, without the prefix.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Attributes(pub(super) BTreeMap<String, Value>);

impl Attributes {
    pub(super) fn int(&mut self, name: &str, value: usize) {
        // Sizes are far below 2^31: `check` has seen them.
        let value = i32::try_from(value).unwrap_or(i32::MAX);
        self.0.insert(name.to_owned(), Value::Int(value));
    }

    pub(super) fn double(&mut self, name: &str, value: f64) {
        self.0.insert(name.to_owned(), Value::Double(value));
    }

    pub(super) fn text(&mut self, name: &str, value: impl Into<String>) {
        self.0.insert(name.to_owned(), Value::Text(value.into()));
    }

    /// Numbers as text, separated by blanks: exact for 64-bit integers and, in Rust's shortest
    /// notation, for doubles.
    pub(super) fn list<T: Display>(&mut self, name: &str, values: impl IntoIterator<Item = T>) {
        let words: Vec<String> = values.into_iter().map(|v| v.to_string()).collect();
        self.text(name, words.join(" "));
    }

    fn get(&self, name: &str) -> Result<&Value, TableError> {
        self.0
            .get(name)
            .ok_or_else(|| complaint(name, "is missing"))
    }

    pub(super) fn get_int<T: TryFrom<i32>>(&self, name: &str) -> Result<T, TableError> {
        match self.get(name)? {
            Value::Int(value) => {
                T::try_from(*value).map_err(|_| complaint(name, format!("is {value}")))
            }
            _ => Err(complaint(name, "is not of type int")),
        }
    }

    pub(super) fn get_double(&self, name: &str) -> Result<f64, TableError> {
        match self.get(name)? {
            Value::Double(value) if value.is_finite() => Ok(*value),
            Value::Double(value) => Err(complaint(name, format!("is {value}"))),
            _ => Err(complaint(name, "is not of type double")),
        }
    }

    pub(super) fn get_text(&self, name: &str) -> Result<&str, TableError> {
        match self.get(name)? {
            Value::Text(value) => Ok(value),
            _ => Err(complaint(name, "is not of type string")),
        }
    }

    pub(super) fn get_parsed<T: FromStr>(&self, name: &str) -> Result<T, TableError> {
        let text = self.get_text(name)?;
        text.parse()
            .map_err(|_| complaint(name, format!("holds {text:?}, which is no such number")))
    }

    /// A list of exactly `count` numbers.
    pub(super) fn get_list<T: FromStr>(
        &self,
        name: &str,
        count: usize,
    ) -> Result<Vec<T>, TableError> {
        let values = self.get_numbers(name)?;
        if values.len() != count {
            let what = format!("holds {} numbers, not {count}", values.len());
            return Err(complaint(name, what));
        }
        Ok(values)
    }

    /// A list of any length.
    pub(super) fn get_numbers<T: FromStr>(&self, name: &str) -> Result<Vec<T>, TableError> {
        let words = self.get_text(name)?.split_ascii_whitespace();
        words
            .map(|word| {
                word.parse()
                    .map_err(|_| complaint(name, format!("holds {word:?}, which is no number")))
            })
            .collect()
    }
}

fn complaint(name: &str, what: impl Display) -> TableError {
    TableError::Inconsistent(format!("attribute vair:{name} {what}"))
}
