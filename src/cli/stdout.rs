//! What commands print for other programs, and what of it a terminal may have.

use super::Failure;
use crate::blame::Blame;
use std::borrow::Cow;
use std::io::{ErrorKind, Write as _};

/// Writes to stdout; a reader that has gone away (`| head`) is no failure.
///
/// # Errors
/// Stdout that cannot be written.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::new(
            Blame::Environment,
            format!("cannot write to stdout: {e}"),
        )),
        _ => Ok(()),
    }
}

/// Writes a line to stderr. Whoever closed it did not want to read it.
pub(super) fn tell(line: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Text with control characters, and those that turn its direction, spelled out: names in files may hold what
/// drives a terminal. Line breaks and tabs stay.
pub(super) fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful = |c: char| {
        let is_control = c.is_control() && !matches!(c, '\n' | '\t');
        is_control
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let spelled = |c: char| match is_harmful(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    Cow::Owned(text.chars().map(spelled).collect())
}

/// Writes JSON, indented.
///
/// # Errors
/// Stdout that cannot be written.
pub(super) fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value:#}\n"))
}
