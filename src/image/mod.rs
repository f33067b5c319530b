//! Pictures: rendered films as EXR and PNG, and a small canvas for plots and labels.

mod canvas;
mod cryptomatte;
mod denoise;
mod film;
mod palette;
mod png;
mod view;

pub use self::canvas::{Canvas, GLYPH_HEIGHT, text_width};
pub use self::denoise::denoise;
pub use self::film::{PROVENANCE_ATTRIBUTE, Provenance, write_film_exr, write_film_png};
pub use self::png::write_png;
pub use self::view::{Look, ViewTransform};
