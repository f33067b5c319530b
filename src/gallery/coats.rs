//! The sheet of coats: the same body as different animals.

use super::swatch::{Model, draw};
use super::{GalleryError, Studio};
use crate::image::{Canvas, GLYPH_HEIGHT};
use crate::progress::Progress;
use crate::species;
use glam::{Vec2, Vec3};

/// Coats of the sheet and the species whose hair wears them: three a row.
pub const COATS: [(&str, &str); 9] = [
    ("tabby", "cat"),
    ("leopard", "cat"),
    ("zebra", "horse"),
    ("badger", "badger"),
    ("fox", "red-fox"),
    ("cow", "cow"),
    ("siamese", "cat"),
    ("tortoiseshell", "cat"),
    ("countershaded", "deer"),
];

const COLUMNS: usize = 3;
const INK: Vec3 = Vec3::new(0.9, 0.9, 0.88);
const PAPER: Vec3 = Vec3::new(0.12, 0.125, 0.13);

/// The whole body; a picture of it needs more strands than a swatch.
const BODY: Model = Model {
    skin: "body",
    zoom: 1.08,
    strands: 15,
    ground: Some(0.4),
};

/// Draws the sheet.
///
/// * `count`: how many of [`COATS`], at least 1.
/// * `height`: of each picture, pixels.
///
/// # Errors
/// A coat that cannot be rendered, or canceled.
pub fn coats_sheet(
    studio: &Studio<'_>,
    count: usize,
    height: usize,
    progress: &dyn Progress,
) -> Result<Canvas, GalleryError> {
    let coats = &COATS[..count.clamp(1, COATS.len())];
    let (width, gap) = (height * 4 / 3, 4);
    let rows = coats.len().div_ceil(COLUMNS);
    let mut canvas = Canvas::new(
        COLUMNS * (width + gap) + gap,
        rows * (height + gap) + gap,
        PAPER,
    );
    progress.begin("coats", coats.len() as u64, "pictures");
    let text = (height as f32 / 160.0).floor().max(1.0);
    for (i, (coat, name)) in coats.iter().enumerate() {
        let mut species = species::load(name, &[])?;
        species.wear(coat)?;
        let picture = draw(studio, &species, &BODY, (width, height))?;
        let (x, y) = (
            gap + i % COLUMNS * (width + gap),
            gap + i / COLUMNS * (height + gap),
        );
        canvas.paste(&picture, x, y);
        let at = Vec2::new(
            x as f32 + 0.8 * GLYPH_HEIGHT * text,
            y as f32 + 0.8 * GLYPH_HEIGHT * text,
        );
        canvas.text(at, coat, text, INK);
        progress.advance(1);
    }
    progress.finish();
    Ok(canvas)
}
