//! Words, numbers and signs of the text form.

use super::error::UsdFileError;

/// One of the pieces that text is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    /// A name with its namespaces and, for properties, `.connect` and the like; also `inf` and `nan`.
    Word(String),
    /// In quotes.
    Text(String),
    /// `@...@`.
    Asset(String),
    /// `<...>`.
    Path(String),
    /// A number.
    Number(f64),
    /// A whole number, which doubles may not hold.
    Int(i64),
    /// Anything else.
    Sign(u8),
    /// Nothing more.
    End,
}

/// Reads one piece after the other.
pub(super) struct Lexer<'t> {
    bytes: &'t [u8],
    at: usize,
    line: usize,
    next: Option<Token>,
}

impl<'t> Lexer<'t> {
    pub(super) fn new(bytes: &'t [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            line: 1,
            next: None,
        }
    }

    /// Something wrong at the line that was read last.
    pub(super) fn error(&self, reason: impl Into<String>) -> UsdFileError {
        UsdFileError::at(format!("line {}", self.line), reason)
    }

    /// The piece that comes, which stays.
    pub(super) fn peek(&mut self) -> Result<&Token, UsdFileError> {
        if self.next.is_none() {
            self.next = Some(self.read()?);
        }
        Ok(self.next.as_ref().unwrap_or(&Token::End))
    }

    /// The piece that comes.
    pub(super) fn take(&mut self) -> Result<Token, UsdFileError> {
        match self.next.take() {
            Some(token) => Ok(token),
            None => self.read(),
        }
    }

    /// Takes a sign if it comes.
    pub(super) fn accept(&mut self, sign: u8) -> Result<bool, UsdFileError> {
        let comes = *self.peek()? == Token::Sign(sign);
        if comes {
            self.next = None;
        }
        Ok(comes)
    }

    /// Takes a sign that must come.
    pub(super) fn expect(&mut self, sign: u8) -> Result<(), UsdFileError> {
        match self.accept(sign)? {
            true => Ok(()),
            false => Err(self.error(format!("{:?} was expected", char::from(sign)))),
        }
    }

    /// Takes a word that must come.
    pub(super) fn word(&mut self) -> Result<String, UsdFileError> {
        match self.take()? {
            Token::Word(word) => Ok(word),
            _ => Err(self.error("a name was expected")),
        }
    }

    /// Takes a text that must come.
    pub(super) fn text(&mut self) -> Result<String, UsdFileError> {
        match self.take()? {
            Token::Text(text) => Ok(text),
            _ => Err(self.error("a text in quotes was expected")),
        }
    }

    fn read(&mut self) -> Result<Token, UsdFileError> {
        self.skip_space()?;
        let Some(&first) = self.bytes.get(self.at) else {
            return Ok(Token::End);
        };
        match first {
            b'"' | b'\'' => self.quoted(first),
            b'@' => self.asset(),
            b'<' => self.path(),
            b'0'..=b'9' | b'-' | b'+' | b'.' => self.number(),
            c if is_word(c) => Ok(Token::Word(
                self.run(|c| is_word(c) || c == b':' || c == b'.'),
            )),
            sign => {
                self.at += 1;
                Ok(Token::Sign(sign))
            }
        }
    }

    fn skip_space(&mut self) -> Result<(), UsdFileError> {
        loop {
            let rest = &self.bytes[self.at..];
            match rest {
                [b'\n', ..] => self.line += 1,
                [b' ' | b'\t' | b'\r', ..] => {}
                [b'#', ..] | [b'/', b'/', ..] => {
                    let end = rest.iter().position(|&c| c == b'\n');
                    self.at += end.unwrap_or(rest.len());
                    continue;
                }
                [b'/', b'*', ..] => {
                    let end = rest.windows(2).position(|pair| pair == b"*/");
                    let end = end.ok_or_else(|| self.error("a comment without end"))?;
                    self.pass(end + 2);
                    continue;
                }
                _ => return Ok(()),
            }
            self.at += 1;
        }
    }

    /// Steps over bytes and counts their lines.
    fn pass(&mut self, count: usize) {
        let passed = &self.bytes[self.at..self.at + count];
        self.line += passed.iter().filter(|&&c| c == b'\n').count();
        self.at += count;
    }

    fn run(&mut self, belongs: impl Fn(u8) -> bool) -> String {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&c| !belongs(c));
        let word = &rest[..length.unwrap_or(rest.len())];
        self.at += word.len();
        String::from_utf8_lossy(word).into_owned()
    }

    fn quoted(&mut self, quote: u8) -> Result<Token, UsdFileError> {
        let triple = [quote; 3];
        let end: &[u8] = match self.bytes[self.at..].starts_with(&triple) {
            true => &triple,
            false => &triple[..1],
        };
        self.at += end.len();
        let mut text = Vec::new();
        loop {
            let rest = &self.bytes[self.at..];
            if rest.starts_with(end) {
                self.at += end.len();
                return Ok(Token::Text(String::from_utf8_lossy(&text).into_owned()));
            }
            match rest {
                [] => return Err(self.error("a text without end")),
                [b'\n', ..] if end.len() == 1 => return Err(self.error("a text without end")),
                [b'\\', escaped, ..] => {
                    text.push(match escaped {
                        b'n' => b'\n',
                        b't' => b'\t',
                        b'r' => b'\r',
                        other => *other,
                    });
                    self.pass(2);
                }
                [c, ..] => {
                    text.push(*c);
                    self.pass(1);
                }
            }
        }
    }

    fn asset(&mut self) -> Result<Token, UsdFileError> {
        let rest = &self.bytes[self.at..];
        let (end, skip): (&[u8], usize) = match rest.starts_with(b"@@@") {
            true => (b"@@@", 3),
            false => (b"@", 1),
        };
        let mut from = skip;
        loop {
            let found = rest[from..].windows(end.len()).position(|w| w == end);
            let found = from + found.ok_or_else(|| self.error("the path of a file without end"))?;
            if skip == 3 && rest[found - 1] == b'\\' {
                from = found + 3;
                continue;
            }
            // More signs than three belong to the path.
            let more = rest[found + end.len()..]
                .iter()
                .take_while(|&&c| c == b'@' && skip == 3);
            let close = found + more.count();
            let path = String::from_utf8_lossy(&rest[skip..close]).replace("\\@@@", "@@@");
            self.pass(close + end.len());
            return Ok(Token::Asset(path));
        }
    }

    fn path(&mut self) -> Result<Token, UsdFileError> {
        let rest = &self.bytes[self.at + 1..];
        let end = rest.iter().position(|&c| c == b'>' || c == b'\n');
        let end = end.filter(|&end| rest[end] == b'>');
        let end = end.ok_or_else(|| self.error("a path without end"))?;
        let path = String::from_utf8_lossy(&rest[..end]).into_owned();
        self.at += end + 2;
        Ok(Token::Path(path))
    }

    fn number(&mut self) -> Result<Token, UsdFileError> {
        let text = self.run(|c| c.is_ascii_alphanumeric() || matches!(c, b'-' | b'+' | b'.'));
        // Unsigned ones beyond half of their range keep their bits.
        let int = text
            .parse()
            .or_else(|_| text.parse::<u64>().map(|n| n as i64));
        if let Ok(int) = int {
            return Ok(Token::Int(int));
        }
        let number = text.parse().map(Token::Number);
        number.map_err(|_| self.error(format!("{text} is no number")))
    }
}

/// Letters of any script, digits and the underscore.
fn is_word(c: u8) -> bool {
    c.is_ascii_alphanumeric() || c == b'_' || c >= 0x80
}
