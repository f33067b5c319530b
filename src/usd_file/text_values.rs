//! Values of the text form.

use super::error::UsdFileError as Error;
use super::lexer::Token;
use super::text::Parser;
use super::value::Value;

impl Parser<'_> {
    pub(super) fn value(&mut self, kind: Kind) -> Result<Value, Error> {
        Ok(match self.lexer.take()? {
            Token::Text(text) => Value::Text(text),
            Token::Path(path) => Value::Text(path),
            Token::Asset(path) => Value::Asset(path),
            Token::Int(number) => Value::Number(number as f64),
            Token::Number(number) => Value::Number(number),
            Token::Word(word) => match word.as_str() {
                "None" => Value::Block,
                "true" => Value::Bool(true),
                "false" => Value::Bool(false),
                "inf" => Value::Number(f64::INFINITY),
                "nan" => Value::Number(f64::NAN),
                _ => Value::Text(word),
            },
            Token::Sign(b'(') => {
                let mut numbers = Vec::new();
                self.tuple(&mut |number| numbers.push(number))?;
                Value::Tuple(numbers)
            }
            Token::Sign(b'[') => self.list(kind)?,
            Token::Sign(b'{') => self.dictionary()?,
            _ => return Err(self.lexer.error("a value was expected")),
        })
    }

    /// Numbers up to the closing bracket; tuples in tuples are one after the other.
    fn tuple(&mut self, push: &mut dyn FnMut(f64)) -> Result<(), Error> {
        self.deeper()?;
        loop {
            match self.lexer.take()? {
                Token::Sign(b')') => break,
                Token::Sign(b',') => {}
                Token::Sign(b'(') => self.tuple(push)?,
                token => match number(&token) {
                    Some(number) => push(number),
                    None => return Err(self.lexer.error("a number was expected")),
                },
            }
        }
        self.depth -= 1;
        Ok(())
    }

    /// Elements up to the closing bracket.
    fn list(&mut self, kind: Kind) -> Result<Value, Error> {
        self.deeper()?;
        let (mut ints, mut floats, mut width) = (Vec::new(), Vec::new(), 0);
        let (mut texts, mut unread) = (Vec::new(), false);
        loop {
            match self.lexer.take()? {
                Token::Sign(b']') => break,
                Token::Sign(b',') => {}
                Token::Int(int) if kind == Kind::Ints => ints.push(int),
                Token::Word(word)
                    if kind == Kind::Ints && matches!(word.as_str(), "true" | "false") =>
                {
                    ints.push(i64::from(word == "true"));
                }
                Token::Sign(b'(') => {
                    let before = floats.len();
                    self.tuple(&mut |number| floats.push(to_f32(number)))?;
                    let found = floats.len() - before;
                    if width > 0 && found != width {
                        let reason = format!("a tuple of {found} numbers among some of {width}");
                        return Err(self.lexer.error(reason));
                    }
                    width = found;
                }
                Token::Text(text) | Token::Path(text) | Token::Asset(text) => texts.push(text),
                token @ (Token::Sign(b'[' | b'{') | Token::End) => {
                    if token == Token::End {
                        return Err(self.lexer.error("the file ends within a list"));
                    }
                    unread = true;
                    match token {
                        Token::Sign(b'[') => drop(self.list(Kind::Any)?),
                        _ => drop(self.dictionary()?),
                    }
                }
                token => match (number(&token), token) {
                    (Some(number), _) => {
                        width = 1;
                        floats.push(to_f32(number));
                    }
                    (None, Token::Word(word)) => texts.push(word),
                    _ => return Err(self.lexer.error("an element of a list was expected")),
                },
            }
        }
        self.depth -= 1;
        Ok(match (kind, unread) {
            (_, true) => Value::Unread,
            (Kind::Ints, _) if floats.is_empty() => Value::Ints(ints.into()),
            _ if !floats.is_empty() || kind == Kind::Floats => Value::Floats {
                values: floats.into(),
                width: width.max(1),
            },
            _ => Value::Texts(texts),
        })
    }

    /// Entries up to the closing bracket: `type key = value`, or `key: value`.
    fn dictionary(&mut self) -> Result<Value, Error> {
        self.deeper()?;
        let mut entries = Vec::new();
        loop {
            match self.lexer.take()? {
                Token::Sign(b'}') => break,
                Token::Sign(b',' | b';') => {}
                Token::Word(mut type_name) => {
                    if self.lexer.accept(b'[')? {
                        self.lexer.expect(b']')?;
                        type_name.push_str("[]");
                    }
                    let key = match self.lexer.take()? {
                        Token::Word(key) | Token::Text(key) => key,
                        _ => return Err(self.lexer.error("a key was expected")),
                    };
                    self.lexer.expect(b'=')?;
                    entries.push((key, self.value(Kind::of(&type_name))?));
                }
                Token::Int(_) | Token::Number(_) | Token::Text(_) | Token::Path(_) => {
                    self.lexer.expect(b':')?;
                    self.value(Kind::Any)?;
                }
                _ => return Err(self.lexer.error("an entry was expected")),
            }
        }
        self.depth -= 1;
        Ok(Value::Dictionary(entries))
    }
}

/// What the elements of an array are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Ints,
    Floats,
    Any,
}

impl Kind {
    pub(super) fn of(type_name: &str) -> Self {
        match type_name.strip_suffix("[]") {
            Some("int" | "uint" | "int64" | "uint64" | "uchar" | "bool") => Self::Ints,
            Some("string" | "token" | "asset" | "pathExpression") | None => Self::Any,
            Some(_) => Self::Floats,
        }
    }
}

fn number(token: &Token) -> Option<f64> {
    match token {
        Token::Int(number) => Some(*number as f64),
        Token::Number(number) => Some(*number),
        Token::Word(word) => match word.as_str() {
            "inf" => Some(f64::INFINITY),
            "nan" => Some(f64::NAN),
            _ => None,
        },
        _ => None,
    }
}

/// The nearest single; finite numbers stay finite.
pub(super) fn to_f32(number: f64) -> f32 {
    match number.is_finite() {
        true => number.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32,
        false => number as f32,
    }
}
