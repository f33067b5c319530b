//! How a species file is described: one table of fields drives the reader, `--set`, the field guide
//! and the JSON Schema, so that they cannot disagree.

/// Closed interval of a number, in a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// Smallest value allowed.
    pub(crate) min: f64,
    /// Largest value allowed.
    pub(crate) max: f64,
    /// Unit for people, empty for ratios.
    pub(crate) unit: &'static str,
}

impl Range {
    /// Whether `value` is finite and inside.
    pub(crate) fn holds(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} to {}", self.min, self.max)?;
        if !self.unit.is_empty() {
            write!(f, " {}", self.unit)?;
        }
        Ok(())
    }
}

/// One allowed word of a [`Kind::Choice`].
#[derive(Debug)]
pub(crate) struct Choice {
    /// As written in the file.
    pub(crate) name: &'static str,
    /// What it means.
    pub(crate) doc: &'static str,
    /// Keys beside this one that only have a meaning with this choice (or others that list them).
    pub(crate) keys: &'static [&'static str],
}

/// What may stand behind a key.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Text of at most so many characters.
    Text(usize),
    /// A list of at most so many texts of at most so many characters, no two alike.
    Texts(usize, usize),
    /// Names of hair classes: each is the key of a table of the root.
    Names,
    /// Table of free keys with literature references.
    Sources,
    /// A number that says where it comes from.
    Number(Range),
    /// As `Number`, whole.
    Whole(Range),
    /// A fixed count of numbers.
    Numbers(usize, Range),
    /// A number for all color channels or three for linear R, G, B, as `Number`.
    Color(Range),
    /// A number that is no measurement and needs no origin.
    Setting(Range),
    /// A fixed count of numbers that are no measurement.
    Settings(usize, Range),
    /// As `Setting`, whole.
    Count(Range),
    /// A line: two to so many points of three numbers.
    Points(usize, Range),
    /// True or false.
    Flag,
    /// Table of free keys, each with one of these words.
    Words(&'static [Choice]),
    /// One of these words.
    Choice(&'static [Choice]),
    /// One of these words or the path of a `.toml` file.
    ChoiceOrFile(&'static [Choice]),
    /// A table.
    Table(&'static Shape),
    /// A list of tables, at least one and at most so many.
    Tables(&'static Shape, usize),
}

/// Whether a key has to be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    /// In this table.
    Required,
    /// In this table or an outer one, or only for some choices: the builder of the species decides.
    Layered,
    /// May be left out.
    Optional,
}

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Field {
    /// The key.
    pub(crate) key: &'static str,
    /// What it means, a sentence.
    pub(crate) doc: &'static str,
    /// Whether it has to be there.
    pub(crate) presence: Presence,
    /// What may stand behind it.
    pub(crate) kind: Kind,
}

impl Field {
    /// A key that has to be in this table.
    pub(crate) const fn required(key: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self {
            key,
            doc,
            presence: Presence::Required,
            kind,
        }
    }

    /// A key that has to be in this table or an outer one.
    pub(crate) const fn layered(key: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self {
            key,
            doc,
            presence: Presence::Layered,
            kind,
        }
    }

    /// A key that may be left out.
    pub(crate) const fn optional(key: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self {
            key,
            doc,
            presence: Presence::Optional,
            kind,
        }
    }
}

/// A table with its keys.
#[derive(Debug)]
pub(crate) struct Shape {
    /// Name in the schema.
    pub(crate) name: &'static str,
    /// What it describes, a sentence.
    pub(crate) doc: &'static str,
    /// Its numbers need a source or an estimate, and the table itself may carry [`CITATION`].
    pub(crate) cited: bool,
    /// Its keys.
    pub(crate) fields: &'static [Field],
}

impl Shape {
    /// The field of a key.
    pub(crate) fn field(&self, key: &str) -> Option<&'static Field> {
        self.fields.iter().find(|f| f.key == key)
    }

    /// All keys that may be written.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'static str> {
        let citation: &[&str] = if self.cited { &CITATION } else { &[] };
        self.fields
            .iter()
            .map(|f| f.key)
            .chain(citation.iter().copied())
    }
}

/// Keys that say where numbers come from: beside `value`, or for all bare numbers of a table.
pub(crate) const CITATION: [&str; 3] = ["source", "estimate", "note"];
