//! Files: whole or not at all.

mod atomic;
mod exr;
mod stale;

pub use atomic::{AtomicFile, FileError, check_writable, read_bounded};
pub use exr::sort_exr_attributes;
