//! Pixar's Universal Scene Description: layers in memory, and their two forms on the disk.
//!
//! `.usda` is text, `.usdc` is binary ("crate"); `.usd` may be either and is binary here. Both forms of
//! a layer print as the same text in Pixar's own library, which is what decides whether they are right.
//! Crate files have version 0.8.0: whatever reads USD since 2018 reads them.

mod binary;
mod layer;
mod pieces;
mod spelling;
mod text;
mod value;

pub use layer::{Attribute, Layer, Prim, Property, Specifier, VariantSet};
pub use value::{Array, Dictionary, Rows, Value};

use std::io::{self, Seek, Write};

/// A form of a layer on the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `.usda`.
    Text,
    /// `.usdc`.
    Binary,
}

/// Writes a layer.
///
/// * `wrote`: hears now and then how many more bytes went out; an error of its own stops the writing.
pub fn write(
    layer: &Layer<'_>,
    form: Form,
    out: &mut (impl Write + Seek),
    wrote: &mut dyn FnMut(u64) -> io::Result<()>,
) -> io::Result<()> {
    match form {
        Form::Text => text::write(layer, out, wrote),
        Form::Binary => binary::write(layer, out, wrote),
    }
}
