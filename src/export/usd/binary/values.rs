//! Values of a crate file: each becomes a word that holds it or says where it stands.

use super::coding::compress_ints;
use super::tables::Tables;
use crate::export::usd::pieces;
use crate::export::usd::value::{Array, Dictionary, Rows, Value};
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

/// Shorter arrays of integers are stored plain.
const LEAST_PACKED: usize = 16;

const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_COMPRESSED: u64 = 1 << 61;

/// Types of values, by Pixar's numbers.
#[derive(Clone, Copy)]
pub(super) enum Type {
    Bool = 1,
    Int = 3,
    Float = 8,
    Double = 9,
    String = 10,
    Token = 11,
    Asset = 12,
    Vec2f = 20,
    Vec3f = 24,
    Dictionary = 31,
    TokenListOp = 32,
    StringListOp = 33,
    PathListOp = 34,
    TokenVector = 41,
    Specifier = 42,
    Variability = 44,
    VariantSelections = 45,
    PayloadListOp = 55,
}

/// The items of a list edit stand in one of these places.
#[derive(Clone, Copy)]
pub(super) enum Edit {
    /// The list is these items.
    Explicit,
    /// They come before what weaker layers say.
    Prepend,
}

impl Edit {
    fn head(self) -> u8 {
        match self {
            Self::Explicit => 1 | 2,
            Self::Prepend => 1 << 5,
        }
    }
}

/// A value in the word itself.
pub(super) fn inlined(kind: Type, payload: u32) -> u64 {
    (kind as u64) << 48 | IS_INLINED | u64::from(payload)
}

/// The part of a file that values go to.
pub(super) struct Values<'o> {
    out: &'o mut dyn Write,
    position: u64,
    wrote: &'o mut dyn FnMut(u64) -> io::Result<()>,
    /// Where arrays stand that went out already, by their address.
    arrays: HashMap<usize, u64>,
}

impl<'o> Values<'o> {
    pub(super) fn new(
        out: &'o mut dyn Write,
        position: u64,
        wrote: &'o mut dyn FnMut(u64) -> io::Result<()>,
    ) -> Self {
        Self {
            out,
            position,
            wrote,
            arrays: HashMap::new(),
        }
    }

    /// Where the next byte goes.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    pub(super) fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.position += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    /// Writes the bytes of a value and returns its word.
    fn outside(&mut self, kind: Type, bytes: &[u8]) -> io::Result<u64> {
        let place = self.position;
        self.put(bytes)?;
        Ok((kind as u64) << 48 | place)
    }

    pub(super) fn value(&mut self, value: &Value<'_>, tables: &mut Tables) -> io::Result<u64> {
        Ok(match value {
            Value::Bool(value) => inlined(Type::Bool, u32::from(*value)),
            Value::Int(value) => inlined(Type::Int, *value as u32),
            Value::Float(value) => inlined(Type::Float, value.to_bits()),
            Value::Double(value) => self.double(*value)?,
            Value::Vec2(value) => self.outside(Type::Vec2f, &bytes_of(value))?,
            Value::Vec3(value) => self.outside(Type::Vec3f, &bytes_of(value))?,
            Value::String(text) => inlined(Type::String, tables.string(text)),
            Value::Token(text) => inlined(Type::Token, tables.token(text)),
            Value::Asset(path) => inlined(Type::Asset, tables.token(path)),
            Value::Strings(texts) => {
                let strings: Vec<u32> = texts.iter().map(|t| tables.string(t)).collect();
                self.strings(&strings)?
            }
            Value::Array(array) => self.array(array)?,
            Value::Dictionary(dictionary) => self.dictionary(dictionary, tables)?,
        })
    }

    fn double(&mut self, value: f64) -> io::Result<u64> {
        let single = value as f32;
        if f64::from(single).to_bits() == value.to_bits() {
            return Ok(inlined(Type::Double, single.to_bits()));
        }
        self.outside(Type::Double, &value.to_le_bytes())
    }

    /// An array of strings.
    fn strings(&mut self, strings: &[u32]) -> io::Result<u64> {
        if strings.is_empty() {
            return Ok((Type::String as u64) << 48 | IS_ARRAY);
        }
        Ok(self.outside(Type::String, &counted(strings))? | IS_ARRAY)
    }

    /// `primChildren` and the like: a list of tokens that is not an array.
    pub(super) fn token_vector(&mut self, tokens: &[u32]) -> io::Result<u64> {
        self.outside(Type::TokenVector, &counted(tokens))
    }

    /// A list edit of tokens, strings or paths.
    pub(super) fn list_edit(&mut self, kind: Type, edit: Edit, items: &[u32]) -> io::Result<u64> {
        let mut bytes = vec![edit.head()];
        bytes.extend(counted(items));
        self.outside(kind, &bytes)
    }

    /// One payload: the default prim of a file.
    pub(super) fn payload(&mut self, asset: &str, tables: &mut Tables) -> io::Result<u64> {
        /// No path is a number that no path has.
        const NO_PATH: u32 = u32::MAX;
        let mut bytes = vec![Edit::Prepend.head()];
        bytes.extend(1u64.to_le_bytes());
        bytes.extend(tables.string(asset).to_le_bytes());
        bytes.extend(NO_PATH.to_le_bytes());
        // Offset and scale of time.
        bytes.extend(0f64.to_le_bytes());
        bytes.extend(1f64.to_le_bytes());
        self.outside(Type::PayloadListOp, &bytes)
    }

    pub(super) fn selections(
        &mut self,
        selections: &[(String, String)],
        tables: &mut Tables,
    ) -> io::Result<u64> {
        let mut bytes = (selections.len() as u64).to_le_bytes().to_vec();
        for (set, variant) in selections {
            bytes.extend(tables.string(set).to_le_bytes());
            bytes.extend(tables.string(variant).to_le_bytes());
        }
        self.outside(Type::VariantSelections, &bytes)
    }

    /// Keys, each with the distance to the word of its value; what the values need outside stands before.
    pub(super) fn dictionary(
        &mut self,
        dictionary: &Dictionary<'_>,
        tables: &mut Tables,
    ) -> io::Result<u64> {
        let mut words = Vec::with_capacity(dictionary.len());
        for (key, value) in dictionary {
            words.push((tables.string(key), self.value(value, tables)?));
        }
        let mut bytes = (words.len() as u64).to_le_bytes().to_vec();
        for (key, word) in words {
            bytes.extend(key.to_le_bytes());
            bytes.extend(8i64.to_le_bytes());
            bytes.extend(word.to_le_bytes());
        }
        self.outside(Type::Dictionary, &bytes)
    }

    fn array(&mut self, array: &Arc<Array<'_>>) -> io::Result<u64> {
        let address = Arc::as_ptr(array).cast::<()>() as usize;
        if let Some(&word) = self.arrays.get(&address) {
            return Ok(word);
        }
        let word = self.new_array(array)?;
        self.arrays.insert(address, word);
        Ok(word)
    }

    fn new_array(&mut self, array: &Array<'_>) -> io::Result<u64> {
        let kind = match array {
            Array::Int(_) => Type::Int,
            Array::Float(_) => Type::Float,
            Array::Vec2(_) => Type::Vec2f,
            Array::Vec3(_) => Type::Vec3f,
        };
        let word = (kind as u64) << 48 | IS_ARRAY;
        let count = array.elements();
        if count == 0 {
            return Ok(word);
        }
        if let Array::Int(rows) = array
            && count >= LEAST_PACKED
        {
            let mut values = Vec::with_capacity(count);
            rows.fill(0..rows.rows(), &mut values);
            let packed = compress_ints(&values);
            let place = self.position;
            self.put(&(count as u64).to_le_bytes())?;
            self.put(&(packed.len() as u64).to_le_bytes())?;
            self.put(&packed)?;
            (self.wrote)(packed.len() as u64)?;
            return Ok(word | IS_COMPRESSED | place);
        }
        // Readers that map the file want the elements aligned.
        let padding = self.position.next_multiple_of(8) - self.position;
        self.put(&[0; 8][..padding as usize])?;
        let place = self.position;
        self.put(&(count as u64).to_le_bytes())?;
        let (out, wrote) = (&mut *self.out, &mut *self.wrote);
        match array {
            Array::Int(rows) => elements(rows, out, wrote, |values, bytes| {
                bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
            }),
            Array::Float(rows) => elements(rows, out, wrote, put_floats),
            Array::Vec2(rows) => elements(rows, out, wrote, |values, bytes| {
                put_floats(values.as_flattened(), bytes);
            }),
            Array::Vec3(rows) => elements(rows, out, wrote, |values, bytes| {
                put_floats(values.as_flattened(), bytes);
            }),
        }?;
        self.position += array.bytes();
        Ok(word | place)
    }
}

fn elements<T: Send>(
    rows: &Rows<'_, T>,
    out: &mut dyn Write,
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
    put: impl Fn(&[T], &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    pieces::write(rows, out, |values, _, bytes| put(values, bytes), wrote)
}

fn put_floats(values: &[f32], bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.resize(start + 4 * values.len(), 0);
    for (to, value) in bytes[start..].chunks_exact_mut(4).zip(values) {
        to.copy_from_slice(&value.to_le_bytes());
    }
}

fn bytes_of(values: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    put_floats(values, &mut bytes);
    bytes
}

fn counted(indices: &[u32]) -> Vec<u8> {
    let mut bytes = (indices.len() as u64).to_le_bytes().to_vec();
    bytes.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    bytes
}
