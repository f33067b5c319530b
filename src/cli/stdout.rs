//! What commands print for other programs.

use super::Failure;
use crate::blame::Blame;
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

/// Writes JSON, indented.
///
/// # Errors
/// Stdout that cannot be written.
pub(super) fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value:#}\n"))
}
