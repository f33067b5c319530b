//! Values of attributes and metadata as files have them.

use super::layer::{memory, texts};
use std::sync::Arc;

/// A value. Long arrays are shared between all that have the same.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `None`: no value, whatever weaker layers say.
    Block,
    /// `bool`; text has it as a number.
    Bool(bool),
    /// A number of any type.
    Number(f64),
    /// A string, token or word.
    Text(String),
    /// The path of a file.
    Asset(String),
    /// Vectors, matrices and quaternions, row by row.
    Tuple(Vec<f64>),
    /// An array of whole numbers.
    Ints(Arc<[i64]>),
    /// An array of numbers, or of `width` numbers each.
    Floats {
        /// One after the other.
        values: Arc<[f32]>,
        /// Numbers an element.
        width: usize,
    },
    /// Strings or tokens; of a list edit what it adds. Also paths of prims and properties.
    Texts(Vec<String>),
    /// References and payloads.
    References(Vec<Reference>),
    /// Keys and values.
    Dictionary(Vec<(String, Value)>),
    /// Something that no check looks at.
    Unread,
}

/// Another prim whose content is added.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reference {
    /// The file; empty for the same.
    pub asset: String,
    /// The prim; empty for the default one.
    pub prim: String,
}

impl Value {
    /// A string, token or word.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// A number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Bool(yes) => Some(f64::from(u8::from(*yes))),
            _ => None,
        }
    }

    /// Number of elements of an array; `None` for a single value.
    pub fn elements(&self) -> Option<usize> {
        match self {
            Self::Ints(values) => Some(values.len()),
            Self::Floats { values, width } => Some(values.len() / (*width).max(1)),
            Self::Texts(texts) => Some(texts.len()),
            _ => None,
        }
    }

    /// Memory that a copy takes, bytes; about. Numbers of arrays are shared.
    pub(super) fn memory(&self) -> usize {
        let more = match self {
            Self::Text(text) | Self::Asset(text) => text.len(),
            Self::Tuple(numbers) => size_of_val(numbers.as_slice()),
            Self::Texts(all) => texts(all),
            Self::References(all) => all.iter().map(|r| texts([&r.asset, &r.prim])).sum(),
            Self::Dictionary(entries) => memory(entries),
            _ => 0,
        };
        size_of::<Self>() + more
    }

    /// The value of a key of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Value> {
        match self {
            Self::Dictionary(entries) => entries.iter().find(|(k, _)| k == key).map(|(_, v)| v),
            _ => None,
        }
    }
}
