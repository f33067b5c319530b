//! Reads layers of Pixar's Universal Scene Description that anyone wrote: `.usda` text, `.usdc` crate
//! files of version 0.4.0 and later, and the first layer of a `.usdz` package.
//!
//! In: the bytes of a file. Out: a [`Layer`], prims with their properties and metadata as they stand in
//! the file, of which [`compose()`] makes the prims that a reader sees. Values that no check looks at are
//! kept as [`Value::Unread`].
//!
//! Files are not trusted: nothing is allocated for a count before the file is known to be long enough
//! for it, all that a crate file unfolds to shares a budget, so do the prims that are put together, and prims
//! and values nest to a limit.

mod binary;
mod compose;
mod error;
mod files;
mod layer;
mod lexer;
mod text;
mod text_values;
mod transform;
mod value;
mod zip;

#[cfg(test)]
mod tests;

pub use compose::compose;
pub use error::UsdFileError;
pub use files::{Files, Open, Unfollowed, is_resolved_elsewhere};
pub use layer::{Fields, Layer, Prim, Property, Specifier, VariantSet};
pub(crate) use transform::{is_z_up, meters_per_unit, placed, to_meters};
pub use value::{Reference, Value};
pub use zip::{Member, members};

/// Most levels of prims, and of values in values.
const DEEPEST: usize = 100;

/// Memory that a crate file may unfold to, bytes: so many for each of its own, and so many more. What is packed
/// and what is shared takes more there than in the file.
const UNFOLDED_PER_BYTE: u64 = 16;
const UNFOLDED: u64 = 256 << 20;

/// Reads the bytes of a layer, in whichever form they are; a package is read by its first member.
///
/// # Errors
/// [`UsdFileError`] names the place and what is wrong there.
pub fn parse(bytes: &[u8]) -> Result<Layer, UsdFileError> {
    if bytes.starts_with(binary::MAGIC) {
        return binary::read(bytes);
    }
    if bytes.starts_with(b"PK\x03\x04") {
        let members = members(bytes)?;
        let first = members
            .first()
            .ok_or_else(|| UsdFileError::at("byte 0", "the package is empty"))?;
        let root = &bytes[first.data.clone()];
        if first.is_packed || root.starts_with(b"PK\x03\x04") {
            let reason = "the first member is deflated, or a package itself";
            return Err(UsdFileError::at("byte 0", reason));
        }
        return parse(root);
    }
    text::read(bytes)
}
