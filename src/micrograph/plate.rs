//! The plate: outside, longitudinal cut and cross-section of a fiber with labels and scale bars.

use super::caption::Facts;
use super::frame::{Drawn, bar, fit, wrap};
use super::raster::Raster;
use super::{Subject, View, cutaway, section, sem};
use crate::image::{Canvas, GLYPH_HEIGHT, text_width};
use glam::{Vec2, Vec3};

const BACKGROUND: Vec3 = Vec3::new(0.045, 0.05, 0.058);
const INK: Vec3 = Vec3::new(0.93, 0.93, 0.9);
const FAINT: Vec3 = Vec3::new(0.6, 0.62, 0.64);

/// Where a picture stands.
#[derive(Clone, Copy)]
struct Panel {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// From one row of facts to the next, pixels.
fn row_height(text: f32) -> usize {
    (GLYPH_HEIGHT * text * 1.5) as usize
}

/// Facts broken into rows, in the largest text that fits; the smallest text may be cut.
fn largest_fit(facts: &[String], text: f32, (width, height): (usize, usize)) -> (f32, Vec<String>) {
    let rows = |text: f32| -> Vec<String> {
        let columns = (width as f32 / text_width("m", text)) as usize;
        facts.iter().flat_map(|fact| wrap(fact, columns)).collect()
    };
    let mut text = text;
    // Glyphs are bitmaps: other than whole sizes blur.
    while text > 1.0 && rows(text).len() * row_height(text) > height {
        text -= 1.0;
    }
    (text, rows(text))
}

/// Draws the plate; `None` when canceled.
pub(super) fn draw(
    subject: &Subject,
    (width, height): (usize, usize),
    raster: &Raster,
) -> Option<Canvas> {
    let mut canvas = Canvas::new(width, height, BACKGROUND);
    let text = (height as f32 / 360.0).floor().clamp(1.0, 6.0);
    let line = (GLYPH_HEIGHT * text * 1.7) as usize;
    let margin = height / 40;
    let top = margin + 2 * line + margin / 2;
    // The lower edge of each picture holds a line of text.
    let each = (height - top - 2 * line - margin) / 2;
    let side = (width / 4).min(each);
    let long = Panel {
        x: margin,
        y: top,
        width: width - side - 3 * margin,
        height: each,
    };
    let cut = Panel {
        y: top + each + line,
        ..long
    };
    let across = Panel {
        x: width - side - margin,
        y: top,
        width: side,
        height: side,
    };
    let View::Sem { tilt } = View::SEM else {
        return None;
    };
    let area = (long.width, long.height);
    let scale = fit(subject.fiber, area, 0.86, 6.0, None);
    let outside = sem::draw(subject.fiber, tilt, scale, area, raster)?;
    let inside = cutaway::halved(subject, (cut.width, cut.height), scale, raster)?;
    let section = section::draw(subject, (side, side), raster)?;

    let facts = Facts::of(subject);
    let at = |x: usize, y: usize| Vec2::new(x as f32, y as f32);
    canvas.text(at(margin, margin), &facts.title, 1.5 * text, INK);
    let below = margin + (1.5 * line as f32) as usize;
    canvas.text(at(margin, below), &facts.place, text, FAINT);
    let mut mount = |drawn: &Drawn, panel: Panel, label: &str, lines_below: usize| {
        canvas.paste(&drawn.canvas, panel.x, panel.y);
        let under = at(panel.x, panel.y + panel.height + line / 4);
        let next = at(0, lines_below * line);
        canvas.text(under + next, label, text, FAINT);
        let right = at(panel.x + panel.width, panel.y + panel.height + line / 4);
        let share = 0.3 * panel.width as f32 / right.x;
        bar(
            &mut canvas,
            drawn.um_per_pixel,
            right,
            share.into(),
            text,
            false,
        );
    };
    mount(&outside, long, "outside, root left, tip right", 0);
    mount(&inside, cut, "front half cut away", 0);
    mount(&section, across, "cross-section", 1);
    let mut y = across.y + across.height + 3 * line;
    let (text, rows) = largest_fit(
        &[facts.size, facts.cuticle, facts.medulla],
        text,
        (side, height.saturating_sub(y)),
    );
    for row in rows {
        canvas.text(at(across.x, y), &row, text, INK);
        y += row_height(text);
    }
    Some(canvas)
}
