//! The binary form of a layer: a crate file.
//!
//! Its layout is that of Pixar's `sdf/crateFile.cpp`: a head, values, and tables of tokens, strings, fields,
//! sets of fields, paths and specs that refer to one another by number.

mod arrays;
mod coding;
#[cfg(test)]
mod hostile_tests;
mod scalar;
mod tree;
mod values;

use super::error::UsdFileError;
use super::layer::Layer;
use crate::cursor::Cursor;
use coding::{decompress, integers};
use values::{Values, Version};

/// The first bytes.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";

/// Most paths and tokens of a file.
const MOST_PATHS: u64 = 2_000_000;

/// Most entries of the other tables, and bytes of all tokens.
const MOST_ENTRIES: u64 = 16_000_000;
const MOST_TEXT: u64 = 256 << 20;

/// Entries and bytes of tokens that the tables of any file may have; more for long files only.
const FEW_ENTRIES: u64 = 1 << 20;
const SHORT_TEXT: u64 = 16 << 20;

/// How long the tables of a file may be: packed ones could be far longer than the file.
#[derive(Clone, Copy)]
struct Limits {
    entries: u64,
    text: u64,
}

impl Limits {
    fn of(bytes: &[u8]) -> Self {
        let length = bytes.len() as u64;
        Self {
            entries: MOST_ENTRIES.min(FEW_ENTRIES + 4 * length),
            text: MOST_TEXT.min(SHORT_TEXT + 16 * length),
        }
    }
}

/// The tables of a file.
struct Tables {
    tokens: Vec<String>,
    /// Tokens of strings.
    strings: Vec<u32>,
    /// Token of the name, and value.
    fields: Vec<(u32, u64)>,
    /// Fields of each set, with -1 after each.
    field_sets: Vec<u32>,
    paths: Vec<Path>,
    specs: Vec<Spec>,
}

/// A path, by its parent.
#[derive(Clone, Copy)]
struct Path {
    parent: u32,
    /// Token of the last element.
    element: u32,
    is_property: bool,
    /// Elements above.
    depth: u32,
}

/// What is said of a path.
struct Spec {
    path: u32,
    fields: u32,
    kind: u32,
}

/// Reads a layer.
pub(super) fn read(bytes: &[u8]) -> Result<Layer, UsdFileError> {
    let mut head = Cursor::new(bytes, MAGIC.len() as u64);
    let version: Version = head.array()?;
    if version[0] != 0 || version[1] < 4 {
        let [a, b, c] = version;
        return Err(UsdFileError::Version(format!("{a}.{b}.{c}")));
    }
    head.take(5)?;
    let directory = head.u64()?;
    let mut directory = Cursor::new(bytes, directory);
    let mut sections = Vec::new();
    for _ in 0..directory.count(32)? {
        let name: [u8; 16] = directory.array()?;
        let (start, size) = (directory.u64()?, directory.u64()?);
        let mut place = Cursor::new(bytes, start);
        sections.push((name, Cursor::new(place.take(size)?, 0)));
    }
    let section = |name: &str| {
        let found = sections.iter().find(|(padded, _)| {
            let (word, rest) = padded.split_at(name.len());
            word == name.as_bytes() && rest[0] == 0
        });
        found
            .map(|(_, cursor)| cursor.clone())
            .ok_or_else(|| UsdFileError::at("the directory", format!("it names no table {name}")))
    };
    let limits = Limits::of(bytes);
    let tables = Tables {
        tokens: tokens(section("TOKENS")?, limits)?,
        strings: strings(section("STRINGS")?)?,
        fields: fields(section("FIELDS")?, limits)?,
        field_sets: table_of_numbers(&mut section("FIELDSETS")?, limits)?,
        paths: paths(section("PATHS")?, limits)?,
        specs: specs(section("SPECS")?, limits)?,
    };
    tree::layer(&tables, &mut Values::new(bytes, version, &tables))
}

/// Bytes that have their number before them.
fn sized<'b>(cursor: &mut Cursor<'b>) -> Result<&'b [u8], UsdFileError> {
    let size = cursor.u64()?;
    Ok(cursor.take(size)?)
}

/// A count, and as many packed numbers.
fn table_of_numbers(cursor: &mut Cursor<'_>, limits: Limits) -> Result<Vec<u32>, UsdFileError> {
    let count = cursor.u64()?;
    numbers(cursor, count, limits)
}

fn numbers(cursor: &mut Cursor<'_>, count: u64, limits: Limits) -> Result<Vec<u32>, UsdFileError> {
    if count > limits.entries {
        return Err(UsdFileError::TooLarge);
    }
    let numbers = integers::<4>(sized(cursor)?, count)?;
    Ok(numbers.into_iter().map(|n| n as u32).collect())
}

fn tokens(mut cursor: Cursor<'_>, limits: Limits) -> Result<Vec<String>, UsdFileError> {
    let count = cursor.u64()?;
    let size = cursor.u64()?;
    if count > MOST_PATHS.min(limits.entries) || size > limits.text {
        return Err(UsdFileError::TooLarge);
    }
    let text = decompress(sized(&mut cursor)?, size)?;
    if count > text.len() as u64 {
        return Err(cursor.error("fewer tokens than announced").into());
    }
    let all = text.split(|&c| c == 0).take(count as usize);
    let tokens: Vec<String> = all
        .map(|t| String::from_utf8_lossy(t).into_owned())
        .collect();
    match tokens.len() as u64 == count {
        true => Ok(tokens),
        false => Err(cursor.error("fewer tokens than announced").into()),
    }
}

fn strings(mut cursor: Cursor<'_>) -> Result<Vec<u32>, UsdFileError> {
    let count = cursor.count(4)?;
    (0..count).map(|_| Ok(cursor.u32()?)).collect()
}

fn fields(mut cursor: Cursor<'_>, limits: Limits) -> Result<Vec<(u32, u64)>, UsdFileError> {
    let names = table_of_numbers(&mut cursor, limits)?;
    let words = decompress(sized(&mut cursor)?, 8 * names.len() as u64)?;
    let mut words = Cursor::new(&words, 0);
    names
        .into_iter()
        .map(|name| Ok((name, words.u64()?)))
        .collect()
}

fn specs(mut cursor: Cursor<'_>, limits: Limits) -> Result<Vec<Spec>, UsdFileError> {
    let count = cursor.u64()?;
    let paths = numbers(&mut cursor, count, limits)?;
    let fields = numbers(&mut cursor, count, limits)?;
    let kinds = numbers(&mut cursor, count, limits)?;
    let specs = paths.into_iter().zip(fields).zip(kinds);
    Ok(specs
        .map(|((path, fields), kind)| Spec { path, fields, kind })
        .collect())
}

/// Paths by number, from the tree that the file holds as a list: a jump is -2 for a leaf, -1 if only a child
/// follows, 0 if only the next sibling does, or the distance to the next sibling behind the children.
fn paths(mut cursor: Cursor<'_>, limits: Limits) -> Result<Vec<Path>, UsdFileError> {
    let count = cursor.u64()?;
    let encoded = cursor.u64()?;
    if count.max(encoded) > MOST_PATHS {
        return Err(UsdFileError::TooLarge);
    }
    let indices = numbers(&mut cursor, encoded, limits)?;
    let elements = numbers(&mut cursor, encoded, limits)?;
    let jumps = numbers(&mut cursor, encoded, limits)?;
    if count > encoded {
        return Err(cursor.error("fewer paths than announced").into());
    }
    let root = Path {
        parent: u32::MAX,
        element: 0,
        is_property: false,
        depth: 0,
    };
    let mut paths = vec![root; count as usize];
    // Each stands in the tree once, else there would be loops.
    let mut seen = vec![false; count as usize];
    // Parents of siblings that come behind the children of others.
    let mut waiting: Vec<(usize, u32)> = Vec::new();
    let (mut at, mut parent, mut first) = (0usize, u32::MAX, true);
    for _ in 0..encoded {
        let (Some(&index), Some(&element), Some(&jump)) =
            (indices.get(at), elements.get(at), jumps.get(at))
        else {
            return Err(cursor
                .error("the tree of paths leads out of the file")
                .into());
        };
        let (element, jump) = (element as i32, jump as i32);
        let depth = match paths.get(parent as usize) {
            Some(above) => above.depth + 1,
            None => 0,
        };
        let Some(path) = paths.get_mut(index as usize) else {
            return Err(cursor.error(format!("path {index} of {count}")).into());
        };
        if std::mem::replace(&mut seen[index as usize], true) {
            return Err(cursor
                .error(format!("path {index} stands twice in the tree"))
                .into());
        }
        if !first && depth == 0 {
            return Err(cursor.error("the tree of paths has two roots").into());
        }
        if !first {
            *path = Path {
                parent,
                element: element.unsigned_abs(),
                is_property: element < 0,
                depth,
            };
        }
        first = false;
        let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
        if has_child && has_sibling {
            waiting.push((at + jump as usize, parent));
        }
        if has_child {
            parent = index;
            at += 1;
        } else if has_sibling {
            at += 1;
        } else if let Some(next) = waiting.pop() {
            (at, parent) = next;
        } else {
            break;
        }
    }
    Ok(paths)
}
