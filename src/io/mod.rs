//! Files: whole or not at all.

mod atomic;

pub use atomic::{AtomicFile, FileError, check_writable, read_bounded};
