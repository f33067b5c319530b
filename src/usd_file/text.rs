//! The text form of a layer, `.usda`.

use super::error::UsdFileError;
use super::layer::{Fields, Layer, Prim, Property, Specifier, VariantSet};
use super::lexer::{Lexer, Token};
use super::text_values::Kind;
use super::value::{Reference, Value};
use super::{DEEPEST, UsdFileError as Error};

/// Words that say how a list is edited.
const EDITS: [&str; 5] = ["add", "append", "delete", "prepend", "reorder"];

/// Words before the type of an attribute.
const QUALIFIERS: [&str; 4] = ["custom", "uniform", "varying", "config"];

/// Reads a layer.
pub(super) fn read(bytes: &[u8]) -> Result<Layer, UsdFileError> {
    if !bytes.trim_ascii_start().starts_with(b"#usda") {
        return Err(UsdFileError::NotUsd);
    }
    let mut parser = Parser {
        lexer: Lexer::new(bytes),
        depth: 0,
    };
    let mut layer = Layer::default();
    if parser.lexer.accept(b'(')? {
        layer.metadata = parser.metadata()?;
    }
    loop {
        match parser.lexer.take()? {
            Token::End => return Ok(layer),
            Token::Sign(b';') => {}
            Token::Word(word) if word == "reorder" => parser.reorder()?,
            Token::Word(word) => match specifier(&word) {
                Some(specifier) => layer.prims.push(parser.prim(specifier)?),
                None => return Err(parser.lexer.error(format!("{word} is no kind of prim"))),
            },
            _ => return Err(parser.lexer.error("a prim was expected")),
        }
    }
}

fn specifier(word: &str) -> Option<Specifier> {
    match word {
        "def" => Some(Specifier::Def),
        "over" => Some(Specifier::Over),
        "class" => Some(Specifier::Class),
        _ => None,
    }
}

pub(super) struct Parser<'t> {
    pub(super) lexer: Lexer<'t>,
    /// Prims and values that are open.
    pub(super) depth: usize,
}

impl Parser<'_> {
    pub(super) fn deeper(&mut self) -> Result<(), Error> {
        self.depth += 1;
        match self.depth > DEEPEST {
            true => Err(self
                .lexer
                .error(format!("nested deeper than {DEEPEST} levels"))),
            false => Ok(()),
        }
    }

    /// `reorder nameChildren = [...]`, of no interest.
    fn reorder(&mut self) -> Result<(), Error> {
        self.lexer.word()?;
        self.lexer.expect(b'=')?;
        self.value(Kind::Any).map(|_| ())
    }

    /// What follows `def`.
    fn prim(&mut self, specifier: Specifier) -> Result<Prim, Error> {
        let type_name = match self.lexer.peek()? {
            Token::Word(_) => self.lexer.word()?,
            _ => String::new(),
        };
        let name = self.lexer.text()?;
        let mut prim = Prim {
            name,
            specifier,
            type_name,
            ..Prim::default()
        };
        self.body(&mut prim)?;
        Ok(prim)
    }

    /// Metadata and content after a prim's or variant's name.
    fn body(&mut self, prim: &mut Prim) -> Result<(), Error> {
        self.deeper()?;
        if self.lexer.accept(b'(')? {
            prim.metadata = self.metadata()?;
        }
        self.lexer.expect(b'{')?;
        loop {
            match self.lexer.take()? {
                Token::Sign(b'}') => break,
                Token::Sign(b';') => {}
                Token::Word(word) => self.statement(word, prim)?,
                Token::End => return Err(self.lexer.error("the file ends within a prim")),
                _ => return Err(self.lexer.error("a prim or a property was expected")),
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn statement(&mut self, word: String, prim: &mut Prim) -> Result<(), Error> {
        if let Some(specifier) = specifier(&word) {
            let child = self.prim(specifier)?;
            prim.children.push(child);
        } else if word == "variantSet" {
            let mut set = VariantSet {
                name: self.lexer.text()?,
                variants: Vec::new(),
            };
            self.lexer.expect(b'=')?;
            self.lexer.expect(b'{')?;
            while !self.lexer.accept(b'}')? {
                let mut variant = Prim {
                    name: self.lexer.text()?,
                    ..Prim::default()
                };
                self.body(&mut variant)?;
                set.variants.push(variant);
            }
            prim.variant_sets.push(set);
        } else if word == "reorder"
            && matches!(self.lexer.peek()?, Token::Word(w) if w == "nameChildren" || w == "properties")
        {
            self.reorder()?;
        } else {
            self.property(word, prim)?;
        }
        Ok(())
    }

    /// An attribute or relationship whose first word is taken already.
    fn property(&mut self, mut word: String, prim: &mut Prim) -> Result<(), Error> {
        let edit = EDITS.contains(&word.as_str()).then(|| word.clone());
        while EDITS.contains(&word.as_str()) || QUALIFIERS.contains(&word.as_str()) {
            word = self.lexer.word()?;
        }
        let mut type_name = word;
        if self.lexer.accept(b'[')? {
            self.lexer.expect(b']')?;
            type_name.push_str("[]");
        }
        let full = self.lexer.word()?;
        let (name, part) = match full.split_once('.') {
            Some((name, part)) => (name, part),
            None => (full.as_str(), ""),
        };
        let is_relationship = type_name == "rel";
        let at = prim.properties.iter().position(|p| p.name == name);
        let at = at.unwrap_or_else(|| {
            prim.properties.push(Property {
                name: name.to_owned(),
                type_name: if is_relationship {
                    String::new()
                } else {
                    type_name.clone()
                },
                ..Property::default()
            });
            prim.properties.len() - 1
        });
        if self.lexer.accept(b'=')? {
            let property = &mut prim.properties[at];
            match part {
                "timeSamples" => property.samples = self.samples(Kind::of(&type_name))?,
                "connect" => self.targets(edit.as_deref(), property)?,
                "" if is_relationship => self.targets(edit.as_deref(), property)?,
                "" => property.value = Some(self.value(Kind::of(&type_name))?),
                // Splines and what else there may be.
                _ => self.skip_value()?,
            }
        }
        if self.lexer.accept(b'(')? {
            let metadata = self.metadata()?;
            prim.properties[at].metadata.extend(metadata);
        }
        Ok(())
    }

    /// Steps over a value whose form is not known: one word, list or tuple, or all between braces.
    fn skip_value(&mut self) -> Result<(), Error> {
        if !self.lexer.accept(b'{')? {
            return self.value(Kind::Any).map(drop);
        }
        let mut open = 1;
        while open > 0 {
            match self.lexer.take()? {
                Token::Sign(b'{') => open += 1,
                Token::Sign(b'}') => open -= 1,
                Token::End => return Err(self.lexer.error("the file ends within a value")),
                _ => {}
            }
        }
        Ok(())
    }

    fn targets(&mut self, edit: Option<&str>, property: &mut Property) -> Result<(), Error> {
        let paths = match self.value(Kind::Any)? {
            Value::Text(path) => vec![path],
            Value::Texts(paths) => paths,
            _ => Vec::new(),
        };
        if !matches!(edit, Some("delete" | "reorder")) {
            property.targets.extend(paths);
        }
        Ok(())
    }

    fn samples(&mut self, kind: Kind) -> Result<Vec<(f64, Value)>, Error> {
        self.lexer.expect(b'{')?;
        let mut samples = Vec::new();
        while !self.lexer.accept(b'}')? {
            let time = match self.lexer.take()? {
                Token::Int(time) => time as f64,
                Token::Number(time) => time,
                _ => return Err(self.lexer.error("a time was expected")),
            };
            self.lexer.expect(b':')?;
            samples.push((time, self.value(kind)?));
            self.lexer.accept(b',')?;
        }
        Ok(samples)
    }

    /// Metadata up to the closing bracket; the opening one is taken already.
    fn metadata(&mut self) -> Result<Fields, Error> {
        let mut fields = Fields::new();
        loop {
            match self.lexer.take()? {
                Token::Sign(b')') => return Ok(fields),
                Token::Sign(b';') => {}
                Token::Text(comment) => fields.push(("comment".to_owned(), Value::Text(comment))),
                Token::Word(word) => {
                    let edit = EDITS.contains(&word.as_str()).then(|| word.clone());
                    let key = match &edit {
                        Some(_) => self.lexer.word()?,
                        None => word,
                    };
                    self.lexer.expect(b'=')?;
                    let value = match key.as_str() {
                        "payload" | "references" | "subLayers" => {
                            Value::References(self.references()?)
                        }
                        _ => self.value(Kind::Any)?,
                    };
                    if !matches!(edit.as_deref(), Some("delete" | "reorder")) {
                        merge(&mut fields, key, value);
                    }
                }
                _ => return Err(self.lexer.error("a name of metadata was expected")),
            }
        }
    }

    /// `@file@</prim> (offset = 1)`, one or a list of them.
    fn references(&mut self) -> Result<Vec<Reference>, Error> {
        let list = self.lexer.accept(b'[')?;
        let mut references = Vec::new();
        loop {
            if list && self.lexer.accept(b']')? {
                return Ok(references);
            }
            let mut reference = Reference::default();
            match self.lexer.take()? {
                Token::Asset(asset) => {
                    reference.asset = asset;
                    if let Token::Path(_) = self.lexer.peek()?
                        && let Token::Path(path) = self.lexer.take()?
                    {
                        reference.prim = path;
                    }
                }
                Token::Path(path) => reference.prim = path,
                Token::Word(word) if word == "None" => return Ok(references),
                _ => return Err(self.lexer.error("a file or a prim was expected")),
            }
            if self.lexer.accept(b'(')? {
                self.metadata()?;
            }
            references.push(reference);
            if !list {
                return Ok(references);
            }
            self.lexer.accept(b',')?;
        }
    }
}

/// Adds a field; lists that are edited in several places become one.
fn merge(fields: &mut Fields, key: String, value: Value) {
    match (fields.iter_mut().find(|(known, _)| *known == key), value) {
        (Some((_, Value::Texts(list))), Value::Texts(more)) => list.extend(more),
        (Some((_, Value::References(list))), Value::References(more)) => list.extend(more),
        (Some((_, known)), value) => *known = value,
        (None, value) => fields.push((key, value)),
    }
}
