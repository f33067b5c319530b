//! The contact sheet: a row an animal.

use super::Column;
use crate::image::{Canvas, GLYPH_HEIGHT, text_width};
use crate::micrograph::wrap;
use crate::species::Species;
use glam::{Vec2, Vec3};

/// Possible heights of a row, pixels: below, names do not fit; above, a sheet of the whole library
/// is too tall for most viewers.
pub const ROW_HEIGHTS: std::ops::RangeInclusive<usize> = 96..=800;

const PAPER: Vec3 = Vec3::new(0.965, 0.96, 0.95);
const INK: Vec3 = Vec3::new(0.12, 0.13, 0.15);
const FAINT: Vec3 = Vec3::new(0.42, 0.43, 0.46);

/// An animal and its pictures; instead of a picture, why there is none.
pub struct Row<'a> {
    /// The animal.
    pub species: &'a Species,
    /// One a column.
    pub pictures: Vec<Result<Canvas, String>>,
}

/// Width and height of a column's pictures on a sheet.
pub fn picture_size(column: Column, row_height: usize) -> (usize, usize) {
    let width = column.aspect() * row_height as f64;
    (width.round() as usize, row_height)
}

/// Draws the sheet.
///
/// * `row_height`: height of the pictures, pixels, in [`ROW_HEIGHTS`].
pub fn sheet(rows: &[Row], columns: &[Column], row_height: usize) -> Canvas {
    let text = (row_height as f32 / 140.0).floor().max(1.0);
    let line = (1.4 * GLYPH_HEIGHT * text) as usize;
    let gap = line;
    let names = text_width("m", text) as usize * 20;
    let at: Vec<usize> = columns
        .iter()
        .scan(2 * gap + names, |x, &column| {
            let here = *x;
            *x += picture_size(column, row_height).0 + gap;
            Some(here)
        })
        .collect();
    let right = columns.iter().map(|&c| picture_size(c, row_height).0 + gap);
    let width = 2 * gap + names + right.sum::<usize>();
    let head = 3 * gap;
    let height = head + rows.len() * (row_height + gap);
    let mut canvas = Canvas::new(width, height, PAPER);
    let place = |x: usize, y: usize| Vec2::new(x as f32, y as f32);
    for (&column, &x) in columns.iter().zip(&at) {
        canvas.text(place(x, gap), column.title(), text, FAINT);
    }
    for (i, row) in rows.iter().enumerate() {
        let top = head + i * (row_height + gap);
        let mut y = top;
        let columns_of_text = names / text_width("m", text) as usize;
        let species = row.species;
        let parts = [
            (&species.name, INK),
            (&species.latin, FAINT),
            (&species.family, FAINT),
        ];
        for (words, color) in parts.into_iter().filter(|(words, _)| !words.is_empty()) {
            for part in wrap(words, columns_of_text) {
                canvas.text(place(gap, y), &part, text, color);
                y += line;
            }
        }
        for ((picture, &x), &column) in row.pictures.iter().zip(&at).zip(columns) {
            match picture {
                Ok(picture) => canvas.paste(picture, x, top),
                Err(why) => {
                    let wide = picture_size(column, row_height).0;
                    let fits = wide / text_width("m", text) as usize;
                    for (k, part) in wrap(why, fits).iter().enumerate() {
                        canvas.text(place(x, top + k * line), part, text, FAINT);
                    }
                }
            }
        }
    }
    canvas
}
