//! Files: whole or not at all.

mod atomic;
mod exr;
mod exr_pixels;
mod picture;
mod stale;

pub use atomic::{AtomicFile, FileError, check_writable, read_bounded};
pub use exr::{exr_text, sort_exr_attributes};
pub(crate) use exr_pixels::{Decoded, decode_exr};

#[cfg(test)]
pub(crate) use exr_pixels::tests::boastful as boastful_exr;
pub use picture::{Channel, Picture, PictureError, Space};
