//! Text in a figure.

use crate::image::{Canvas, GLYPH_HEIGHT, text_width};
use glam::{Vec2, Vec3};

/// Writes text of one size.
pub(super) struct Pen {
    scale: f32,
}

impl Pen {
    /// * `scale`: size of a pixel of the bitmap font; rounded to halves, so that letters stay crisp
    ///   after averaging pairs of pixels.
    pub(super) fn new(scale: f32) -> Self {
        Self {
            scale: (2.0 * scale).round() / 2.0,
        }
    }

    /// Height of a letter, the unit of a figure's spacing.
    pub(super) fn line(&self) -> f32 {
        GLYPH_HEIGHT * self.scale
    }

    /// Width of thin lines.
    pub(super) fn hair(&self) -> f32 {
        self.scale.max(1.0)
    }

    /// Text that begins at `at` (its upper left corner).
    pub(super) fn left(&self, canvas: &mut Canvas, at: Vec2, text: &str, color: Vec3) {
        canvas.text(at.round(), text, self.scale, color);
    }

    /// Text centered about `at.x`.
    pub(super) fn center(&self, canvas: &mut Canvas, at: Vec2, text: &str, color: Vec3) {
        let half = 0.5 * text_width(text, self.scale);
        self.left(canvas, at - Vec2::new(half, 0.0), text, color);
    }

    /// Text that ends at `at.x`, centered about `at.y`.
    pub(super) fn right(&self, canvas: &mut Canvas, at: Vec2, text: &str, color: Vec3) {
        let shift = Vec2::new(text_width(text, self.scale), 0.5 * self.line());
        self.left(canvas, at - shift, text, color);
    }
}

/// A number of degrees without needless digits.
pub(super) fn degrees(value: f64) -> String {
    format!("{}°", (value * 100.0).round() / 100.0)
}
