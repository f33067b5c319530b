//! Files: whole or not at all.

mod atomic;
mod exr;
mod picture;
mod stale;

pub use atomic::{AtomicFile, FileError, check_writable, read_bounded};
pub use exr::sort_exr_attributes;
pub use picture::{Channel, Picture, PictureError, Space};
