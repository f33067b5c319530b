//! What a crate file stores once and refers to by number: tokens, strings, fields, sets of fields.

use std::collections::HashMap;

/// Marks the end of a set of fields.
const END: u32 = u32::MAX;

/// Tokens, strings, fields and sets of fields in the order in which they were first met.
pub(super) struct Tables {
    /// Tokens; number 0 is never used, because properties are negative numbers among the paths.
    pub(super) tokens: Vec<String>,
    /// Strings, as tokens.
    pub(super) strings: Vec<u32>,
    /// Token of the name, and value.
    pub(super) fields: Vec<(u32, u64)>,
    /// Fields of each set, with [`END`] after each.
    pub(super) field_sets: Vec<u32>,
    token_of: HashMap<String, u32>,
    string_of: HashMap<u32, u32>,
    field_of: HashMap<(u32, u64), u32>,
    field_set_of: HashMap<Vec<u32>, u32>,
}

impl Tables {
    pub(super) fn new() -> Self {
        let mut tables = Self {
            tokens: Vec::new(),
            strings: Vec::new(),
            fields: Vec::new(),
            field_sets: Vec::new(),
            token_of: HashMap::new(),
            string_of: HashMap::new(),
            field_of: HashMap::new(),
            field_set_of: HashMap::new(),
        };
        tables.token(";-)");
        tables
    }

    pub(super) fn token(&mut self, text: &str) -> u32 {
        if let Some(&known) = self.token_of.get(text) {
            return known;
        }
        let index = self.tokens.len() as u32;
        self.tokens.push(text.to_owned());
        self.token_of.insert(text.to_owned(), index);
        index
    }

    pub(super) fn string(&mut self, text: &str) -> u32 {
        let token = self.token(text);
        *self.string_of.entry(token).or_insert_with(|| {
            self.strings.push(token);
            self.strings.len() as u32 - 1
        })
    }

    pub(super) fn field(&mut self, name: &str, value: u64) -> u32 {
        let key = (self.token(name), value);
        *self.field_of.entry(key).or_insert_with(|| {
            self.fields.push(key);
            self.fields.len() as u32 - 1
        })
    }

    pub(super) fn field_set(&mut self, fields: Vec<u32>) -> u32 {
        if let Some(&known) = self.field_set_of.get(&fields) {
            return known;
        }
        let index = self.field_sets.len() as u32;
        self.field_sets.extend(&fields);
        self.field_sets.push(END);
        self.field_set_of.insert(fields, index);
        index
    }
}
