//! Pictures: PNG files and a small canvas for plots and labels.

mod canvas;
mod png;

pub use self::canvas::{Canvas, GLYPH_HEIGHT, text_width};
pub use self::png::write_png;
