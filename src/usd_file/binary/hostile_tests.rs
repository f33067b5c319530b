//! Small crate files that would unfold to far more than their size are refused.

#![allow(clippy::unwrap_used)]

use super::{MAGIC, UsdFileError, read};

const IS_ARRAY: u64 = 1 << 63;
const TOKENS: u64 = 11 << 48;
const INTS: u64 = 3 << 48;

/// Bytes with their number before them, packed in one block.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut block = vec![0];
    block.extend(lz4_flex::block::compress(bytes));
    let mut out = (block.len() as u64).to_le_bytes().to_vec();
    out.extend(block);
    out
}

/// Whole numbers as differences: of two bits where they are one, of four bytes elsewhere.
fn ints(values: &[i32]) -> Vec<u8> {
    let mut codes = vec![0u8; values.len().div_ceil(4)];
    let (mut last, mut steps) = (0, Vec::new());
    for (i, value) in values.iter().enumerate() {
        let step = value.wrapping_sub(last);
        last = *value;
        if step != 1 {
            codes[i / 4] |= 3 << (2 * (i % 4));
            steps.extend(step.to_le_bytes());
        }
    }
    packed(&[&1i32.to_le_bytes()[..], &codes, &steps].concat())
}

/// A crate file of one prim with so many attributes that all have the same fields.
struct Crate {
    tokens: Vec<String>,
    /// Token of the name, and word of the value.
    fields: Vec<(i32, u64)>,
    attributes: usize,
    /// From byte 24 on.
    values: Vec<u8>,
}

impl Crate {
    fn bytes(&self) -> Vec<u8> {
        let count = |n: usize| (n as u64).to_le_bytes().to_vec();
        let text = self.tokens.join("\0") + "\0";
        let names: Vec<i32> = self.fields.iter().map(|(name, _)| *name).collect();
        let words: Vec<u8> = self
            .fields
            .iter()
            .flat_map(|(_, w)| w.to_le_bytes())
            .collect();
        // One set for all attributes, and an empty one behind it.
        let mut set: Vec<i32> = (0..names.len() as i32).collect();
        set.extend([-1, -1]);
        let empty = names.len() as i32 + 1;
        let paths = self.attributes + 2;
        let indices: Vec<i32> = (0..paths as i32).collect();
        let element = |i| if i < 2 { 1 } else { -1 };
        let elements: Vec<i32> = (0..paths).map(element).collect();
        let jump = |i| match i {
            0 | 1 => -1,
            i if i + 1 == paths => -2,
            _ => 0,
        };
        let jumps: Vec<i32> = (0..paths).map(jump).collect();
        let sets: Vec<i32> = (0..paths).map(|i| if i < 2 { empty } else { 0 }).collect();
        let kind = |i| match i {
            0 => 7,
            1 => 6,
            _ => 1,
        };
        let kinds: Vec<i32> = (0..paths).map(kind).collect();
        let number = count(paths);
        let sections: [(&str, Vec<u8>); 6] = [
            (
                "TOKENS",
                [
                    count(self.tokens.len()),
                    count(text.len()),
                    packed(text.as_bytes()),
                ]
                .concat(),
            ),
            ("STRINGS", count(0)),
            (
                "FIELDS",
                [count(names.len()), ints(&names), packed(&words)].concat(),
            ),
            ("FIELDSETS", [count(set.len()), ints(&set)].concat()),
            (
                "PATHS",
                [
                    number.clone(),
                    number.clone(),
                    ints(&indices),
                    ints(&elements),
                    ints(&jumps),
                ]
                .concat(),
            ),
            (
                "SPECS",
                [number, ints(&indices), ints(&sets), ints(&kinds)].concat(),
            ),
        ];
        let mut out = MAGIC.to_vec();
        out.extend([0, 8, 0, 0, 0, 0, 0, 0]);
        out.extend([0; 8]);
        out.extend(&self.values);
        let mut directory = count(sections.len());
        for (name, section) in sections {
            let mut padded = name.as_bytes().to_vec();
            padded.resize(16, 0);
            directory.extend(padded);
            directory.extend(count(out.len()));
            directory.extend(count(section.len()));
            out.extend(section);
        }
        let place = out.len() as u64;
        out[16..24].copy_from_slice(&place.to_le_bytes());
        out.extend(directory);
        out
    }

    fn is_refused(&self) -> bool {
        let bytes = self.bytes();
        assert!(bytes.len() < 1 << 20, "{} bytes", bytes.len());
        match read(&bytes) {
            Ok(layer) => {
                assert_eq!(layer.prims[0].properties.len(), self.attributes);
                false
            }
            Err(error) => {
                assert_eq!(error, UsdFileError::TooLarge);
                true
            }
        }
    }
}

/// An array of tokens that all attributes have; few may.
#[test]
fn shared_texts_are_counted_each_time() {
    let array = |attributes| {
        let mut values = 1000u64.to_le_bytes().to_vec();
        values.extend(2u32.to_le_bytes().repeat(1000));
        Crate {
            tokens: vec!["default".into(), "x".into(), "t".repeat(4000)],
            fields: vec![(0, IS_ARRAY | TOKENS | 24)],
            attributes,
            values,
        }
    };
    assert!(!array(4).is_refused());
    assert!(array(80).is_refused());
}

/// A name of a megabyte that all attributes have, or are called.
#[test]
fn long_names_are_counted_each_time() {
    let long = |attributes, field: bool| {
        let mut tokens = vec!["default".to_owned(), "x".into()];
        tokens[usize::from(!field)] = "t".repeat(1 << 20);
        Crate {
            tokens,
            fields: vec![(0, IS_ARRAY | INTS)],
            attributes,
            values: Vec::new(),
        }
    };
    for field in [false, true] {
        assert!(!long(3, field).is_refused());
        assert!(long(400, field).is_refused());
    }
}

/// A thousand fields that all attributes have, with a value that is shared.
#[test]
fn shared_fields_are_counted_each_time() {
    let shared = |attributes| Crate {
        tokens: vec!["f".into(), "x".into()],
        fields: vec![(0, IS_ARRAY | INTS); 1000],
        attributes,
        values: Vec::new(),
    };
    assert!(!shared(50).is_refused());
    assert!(shared(4000).is_refused());
}

/// Tables that are packed to a thousandth of what they unfold to.
#[test]
fn tables_are_as_long_as_the_file_may_have_them() {
    let many = |attributes| Crate {
        tokens: vec!["f".into(), "x".into()],
        fields: Vec::new(),
        attributes,
        values: Vec::new(),
    };
    assert!(!many(10_000).is_refused());
    assert!(many(1_800_000).is_refused());
    let text = |length| Crate {
        tokens: vec!["t".repeat(length), "x".into()],
        ..many(1)
    };
    assert!(!text(1 << 20).is_refused());
    assert!(text(40 << 20).is_refused());
}
