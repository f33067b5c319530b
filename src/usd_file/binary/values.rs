//! Values of a crate file: each is a word that holds it or says where it stands.

use super::Tables;
use super::scalar::{Scalar, shape};
use crate::cursor::Cursor;
use crate::usd_file::error::UsdFileError as Error;
use crate::usd_file::value::{Reference, Value};
use crate::usd_file::{DEEPEST, UNFOLDED, UNFOLDED_PER_BYTE};
use std::collections::HashMap;

/// Version of a file.
pub(super) type Version = [u8; 3];

const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_COMPRESSED: u64 = 1 << 61;

/// Memory of a field, with its name and value but without their texts and numbers, bytes.
const FIELD: u64 = 96;

/// Memory of a text in a list, without its letters, bytes.
pub(super) const ITEM: u64 = 40;

/// Pixar's numbers of the types that are not numbers.
pub(super) const STRING: u8 = 10;
pub(super) const TOKEN: u8 = 11;
pub(super) const ASSET: u8 = 12;
const DICTIONARY: u8 = 31;
const TOKEN_LIST_OP: u8 = 32;
const STRING_LIST_OP: u8 = 33;
const PATH_LIST_OP: u8 = 34;
const REFERENCE_LIST_OP: u8 = 35;
const PATH_VECTOR: u8 = 40;
const TOKEN_VECTOR: u8 = 41;
pub(super) const SPECIFIER: u8 = 42;
pub(super) const PERMISSION: u8 = 43;
pub(super) const VARIABILITY: u8 = 44;
const VARIANT_SELECTIONS: u8 = 45;
const TIME_SAMPLES: u8 = 46;
const PAYLOAD: u8 = 47;
const DOUBLE_VECTOR: u8 = 48;
const STRING_VECTOR: u8 = 50;
const VALUE_BLOCK: u8 = 51;
const PAYLOAD_LIST_OP: u8 = 55;

/// Reads values of a file.
pub(super) struct Values<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) version: Version,
    tables: &'b Tables,
    /// Arrays that are read already, by their word: many attributes may have the same.
    arrays: HashMap<u64, Value>,
    /// Memory that values, prims and properties may still take, bytes.
    budget: u64,
    depth: usize,
}

impl<'b> Values<'b> {
    pub(super) fn new(bytes: &'b [u8], version: Version, tables: &'b Tables) -> Self {
        Self {
            bytes,
            version,
            tables,
            arrays: HashMap::new(),
            budget: UNFOLDED_PER_BYTE * bytes.len() as u64 + UNFOLDED,
            depth: 0,
        }
    }

    /// Takes memory from what a file may unfold to in all.
    pub(super) fn spend(&mut self, bytes: u64) -> Result<(), Error> {
        let left = self.budget.checked_sub(bytes);
        self.budget = left.ok_or(Error::TooLarge)?;
        Ok(())
    }

    /// The value of a word.
    pub(super) fn value(&mut self, word: u64) -> Result<Value, Error> {
        let (kind, payload) = ((word >> 48) as u8, word & ((1 << 48) - 1));
        self.spend(FIELD)?;
        if word & IS_ARRAY != 0 {
            // Numbers are shared, texts are not.
            if let Some(Value::Texts(texts)) = self.arrays.get(&word) {
                let size = texts.iter().map(|text| ITEM + text.len() as u64).sum();
                self.spend(size)?;
            }
            if let Some(known) = self.arrays.get(&word) {
                return Ok(known.clone());
            }
            let array = self.array(kind, word & IS_COMPRESSED != 0, payload)?;
            self.arrays.insert(word, array.clone());
            return Ok(array);
        }
        if word & IS_INLINED != 0 {
            return self.inlined(kind, payload as u32);
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            let reason = format!("values are nested deeper than {DEEPEST} levels");
            return Err(Error::at(format!("byte {payload}"), reason));
        }
        let value = self.outside(kind, Cursor::new(self.bytes, payload));
        self.depth -= 1;
        value
    }

    fn inlined(&mut self, kind: u8, payload: u32) -> Result<Value, Error> {
        let bytes = payload.to_le_bytes();
        Ok(match (kind, shape(kind)) {
            (STRING, _) => Value::Text(self.string(payload)?),
            (TOKEN, _) => Value::Text(self.token(payload)?),
            (ASSET, _) => Value::Asset(self.token(payload)?),
            (DICTIONARY, _) => Value::Dictionary(Vec::new()),
            (VALUE_BLOCK, _) => Value::Block,
            (1, _) => Value::Bool(payload != 0),
            (_, Some((Scalar::Double, 1))) => Value::Number(f64::from(f32::from_bits(payload))),
            (_, Some((Scalar::I64, 1))) => Value::Number(f64::from(payload as i32)),
            (_, Some((Scalar::U64, 1))) => Value::Number(f64::from(payload)),
            (_, Some((scalar, 1))) => Value::Number(scalar.read(&mut Cursor::new(&bytes, 0))?),
            // Small whole numbers: all of a vector, the diagonal of a matrix.
            (13..=15, Some((_, count))) => {
                self.spend(8 * count as u64)?;
                let edge = count.isqrt();
                let mut matrix = vec![0.0; count];
                for i in 0..edge {
                    matrix[i * edge + i] = f64::from(bytes[i] as i8);
                }
                Value::Tuple(matrix)
            }
            (_, Some((_, count))) => {
                Value::Tuple(bytes[..count].iter().map(|&b| f64::from(b as i8)).collect())
            }
            _ => Value::Unread,
        })
    }

    fn token(&mut self, index: u32) -> Result<String, Error> {
        let token = self.tables.tokens.get(index as usize);
        let missing = || Error::at("a value", format!("there is no token {index}"));
        self.named(token.ok_or_else(missing)?)
    }

    /// A name of its own.
    pub(super) fn named(&mut self, name: &str) -> Result<String, Error> {
        self.spend(name.len() as u64)?;
        Ok(name.to_owned())
    }

    fn string(&mut self, index: u32) -> Result<String, Error> {
        let token = self.tables.strings.get(index as usize);
        let missing = || Error::at("a value", format!("there is no string {index}"));
        self.token(*token.ok_or_else(missing)?)
    }

    /// A path as text; empty for a number that no path has.
    fn path(&mut self, index: u32) -> Result<String, Error> {
        let tables = self.tables;
        let paths = &tables.paths;
        let mut elements = Vec::new();
        let mut at = index;
        while let Some(path) = paths.get(at as usize).filter(|path| path.depth > 0) {
            if elements.len() > 2 * DEEPEST {
                return Err(Error::at(format!("path {index}"), "it is too long"));
            }
            elements.push((self.token(path.element)?, path.is_property));
            at = path.parent;
        }
        let mut text = String::new();
        for (element, is_property) in elements.iter().rev() {
            if *is_property {
                text.push('.');
            } else if !element.starts_with('{') && !text.ends_with('}') {
                text.push('/');
            }
            text.push_str(element);
        }
        Ok(text)
    }

    fn outside(&mut self, kind: u8, mut cursor: Cursor<'b>) -> Result<Value, Error> {
        if let Some((scalar, width)) = shape(kind) {
            self.spend(8 * width as u64)?;
            let numbers: Result<Vec<f64>, Error> =
                (0..width).map(|_| Ok(scalar.read(&mut cursor)?)).collect();
            let numbers = numbers?;
            return Ok(match numbers.as_slice() {
                [one] => Value::Number(*one),
                _ => Value::Tuple(numbers),
            });
        }
        Ok(match kind {
            DICTIONARY => self.dictionary(&mut cursor)?,
            TOKEN_LIST_OP | STRING_LIST_OP | PATH_LIST_OP => {
                let item = |this: &mut Self, cursor: &mut Cursor<'_>| this.text(kind, cursor);
                Value::Texts(self.edited(&mut cursor, 4, item)?)
            }
            REFERENCE_LIST_OP => {
                Value::References(self.edited(&mut cursor, 32, |this, cursor| {
                    let reference = this.reference(cursor, true)?;
                    this.dictionary(cursor)?;
                    Ok(reference)
                })?)
            }
            PAYLOAD_LIST_OP => {
                let item = |this: &mut Self, cursor: &mut Cursor<'b>| this.reference(cursor, true);
                Value::References(self.edited(&mut cursor, 24, item)?)
            }
            PAYLOAD => {
                let offset = self.version >= [0, 8, 0];
                Value::References(vec![self.reference(&mut cursor, offset)?])
            }
            TOKEN_VECTOR | STRING_VECTOR | PATH_VECTOR => {
                Value::Texts(self.texts(kind, &mut cursor)?)
            }
            DOUBLE_VECTOR => {
                let count = cursor.count(8)?;
                self.floats(Scalar::Double, 1, count, &mut cursor)?
            }
            VARIANT_SELECTIONS => {
                let count = cursor.count(8)?;
                self.spend(FIELD * count)?;
                let mut entries = Vec::new();
                for _ in 0..count {
                    let (set, variant) = (cursor.u32()?, cursor.u32()?);
                    entries.push((self.string(set)?, Value::Text(self.string(variant)?)));
                }
                Value::Dictionary(entries)
            }
            TIME_SAMPLES => self.time_samples(&mut cursor)?,
            _ => Value::Unread,
        })
    }

    /// A token, string or path, as an item of a list of some type.
    pub(super) fn text(&mut self, kind: u8, cursor: &mut Cursor<'_>) -> Result<String, Error> {
        let index = cursor.u32()?;
        match kind {
            TOKEN | TOKEN_LIST_OP | TOKEN_VECTOR | ASSET => self.token(index),
            PATH_LIST_OP | PATH_VECTOR => self.path(index),
            _ => self.string(index),
        }
    }

    fn texts(&mut self, kind: u8, cursor: &mut Cursor<'_>) -> Result<Vec<String>, Error> {
        let count = cursor.count(4)?;
        self.spend(ITEM * count)?;
        (0..count).map(|_| self.text(kind, cursor)).collect()
    }

    /// What a list edit adds: explicit, added, prepended and appended items.
    fn edited<T>(
        &mut self,
        cursor: &mut Cursor<'b>,
        size: u64,
        mut item: impl FnMut(&mut Self, &mut Cursor<'b>) -> Result<T, Error>,
    ) -> Result<Vec<T>, Error> {
        let head = cursor.u8()?;
        let mut items = Vec::new();
        for bit in [1, 2, 5, 6] {
            if head >> bit & 1 == 0 {
                continue;
            }
            let count = cursor.count(size)?;
            self.spend(2 * ITEM * count)?;
            for _ in 0..count {
                items.push(item(self, cursor)?);
            }
        }
        Ok(items)
    }

    fn reference(&mut self, cursor: &mut Cursor<'_>, has_offset: bool) -> Result<Reference, Error> {
        let asset = self.string(cursor.u32()?)?;
        let prim = self.path(cursor.u32()?)?;
        if has_offset {
            cursor.take(16)?;
        }
        Ok(Reference { asset, prim })
    }

    /// The place that the distance at the cursor leads to.
    fn jump(&self, cursor: &mut Cursor<'b>) -> Result<(), Error> {
        let start = cursor.at();
        let distance = cursor.u64()? as i64;
        let target = start.checked_add_signed(distance);
        let target = target.ok_or_else(|| cursor.error("a value stands before the file"))?;
        *cursor = Cursor::new(self.bytes, target);
        Ok(())
    }

    fn dictionary(&mut self, cursor: &mut Cursor<'b>) -> Result<Value, Error> {
        let count = cursor.count(20)?;
        let mut entries = Vec::new();
        for _ in 0..count {
            let key = self.string(cursor.u32()?)?;
            self.jump(cursor)?;
            let word = cursor.u64()?;
            entries.push((key, self.value(word)?));
        }
        Ok(Value::Dictionary(entries))
    }

    /// Times as keys.
    fn time_samples(&mut self, cursor: &mut Cursor<'b>) -> Result<Value, Error> {
        self.jump(cursor)?;
        let times = cursor.u64()?;
        let times = self.value(times)?;
        self.jump(cursor)?;
        let count = cursor.count(8)?;
        let Value::Floats { values: times, .. } = times else {
            return Ok(Value::Unread);
        };
        let mut samples = Vec::new();
        for time in times.iter().take(count as usize) {
            let word = cursor.u64()?;
            samples.push((time.to_string(), self.value(word)?));
        }
        Ok(Value::Dictionary(samples))
    }
}
