//! The frame of a micrograph: how large the fiber is in it, the caption and the scale bar.

use super::caption::Facts;
use super::{Legend, Shot, Subject, View};
use crate::fiber::Fiber;
use crate::image::{Canvas, GLYPH_HEIGHT, text_width};
use crate::species::CuticlePattern;
use glam::{Vec2, Vec3};

/// A picture and its scale.
pub(super) struct Drawn {
    pub(super) canvas: Canvas,
    /// Along the picture.
    pub(super) um_per_pixel: f64,
}

const STRIP: Vec3 = Vec3::new(0.07, 0.075, 0.085);
const INK: Vec3 = Vec3::new(0.94, 0.94, 0.92);
const FAINT: Vec3 = Vec3::new(0.66, 0.68, 0.70);

/// Micrometers a pixel at which the fiber fills a share of the height, unless that shows fewer than
/// `least` rows of scales along the picture, or more than `most`.
pub(super) fn fit(
    fiber: &Fiber,
    (width, height): (usize, usize),
    share: f64,
    least: f64,
    most: Option<f64>,
) -> f64 {
    let whole = 2.0 * fiber.bounding_radius_um() / (share * height as f64);
    let cuticle = &fiber.structure().cuticle;
    if cuticle.pattern == CuticlePattern::Smooth {
        return whole;
    }
    let rows = |count: f64| count * cuticle.pitch_um / width as f64;
    let scale = whole.max(rows(least));
    most.map_or(scale, |most| scale.min(rows(most.max(least))))
}

/// A picture in its frame.
///
/// * `picture`: draws into an area of so many pixels.
pub(super) fn draw(
    subject: &Subject,
    shot: &Shot,
    view: View,
    picture: impl FnOnce((usize, usize)) -> Option<Drawn>,
) -> Option<Canvas> {
    let (width, height) = shot.size;
    let text = (width as f32 / 640.0).floor().clamp(1.0, 8.0);
    let line = GLYPH_HEIGHT * text * 1.5;
    let pad = (0.7 * line).round();
    let lines = caption(subject, view);
    let columns = ((width as f32 - 2.0 * pad) / text_width("m", text)) as usize;
    let mut rows: Vec<String> = lines[1..].iter().flat_map(|l| wrap(l, columns)).collect();
    // A small picture keeps three quarters of its height.
    let room = (0.25 * height as f32 - 2.0 * pad) / line - 1.0;
    rows.truncate(room.max(0.0) as usize);
    let strip = if shot.legend == Legend::Caption {
        (line * (rows.len() + 1) as f32 + 2.0 * pad) as usize
    } else {
        0
    };
    let drawn = picture((width, height - strip))?;
    let top = (height - strip) as f32;
    let mut canvas = Canvas::new(width, height, STRIP);
    canvas.paste(&drawn.canvas, 0, 0);
    if shot.legend != Legend::Caption {
        if shot.legend == Legend::Bar {
            let right = Vec2::new(width as f32 - pad, top - pad - line);
            bar(&mut canvas, drawn.um_per_pixel, right, 0.3, text, true);
        }
        return Some(canvas);
    }
    let right = Vec2::new(width as f32 - pad, top + pad);
    let taken = bar(&mut canvas, drawn.um_per_pixel, right, 0.25, text, false);
    let columns = ((width as f32 - taken - 3.0 * pad) / text_width("m", text)) as usize;
    let title: String = lines[0].chars().take(columns).collect();
    canvas.text(Vec2::new(pad, top + pad), &title, text, INK);
    for (i, row) in rows.iter().enumerate() {
        let at = Vec2::new(pad, top + pad + line * (i + 1) as f32);
        canvas.text(at, row, text, FAINT);
    }
    Some(canvas)
}

/// Whose hair it is, how the picture was taken, and what can be seen.
fn caption(subject: &Subject, view: View) -> Vec<String> {
    let facts = Facts::of(subject);
    let taken = match view {
        View::Sem { tilt } => format!(
            "scanning electron microscope, stage tilted {:.0}\u{b0}",
            tilt.to_degrees()
        ),
        View::Light(m) => {
            let mount = if m.mount == 1.0 {
                ", dry".to_owned()
            } else {
                format!(" in a medium of index {:.2}", m.mount)
            };
            let lamp = match m.lamp_ev {
                Some(ev) if ev != 0.0 => format!(", lamp {ev:+} EV"),
                _ => String::new(),
            };
            format!(
                "transmitted light{mount}, aperture {:.2}{lamp}",
                m.objective
            )
        }
        View::Section => "cross-section".to_owned(),
        View::Cutaway => "front quarter cut away".to_owned(),
        View::Plate => String::new(),
    };
    let mut lines = vec![facts.title, format!("{}; {taken}", facts.place)];
    match view {
        View::Sem { .. } => lines.push(facts.cuticle),
        View::Light(_) | View::Section => lines.push(format!("{}; {}", facts.size, facts.medulla)),
        View::Cutaway | View::Plate => lines.extend([facts.cuticle, facts.medulla]),
    }
    lines
}

/// A scale bar with its length beside it, its right end at `right`. Returns the width it takes.
///
/// * `share`: of the picture's width that it may take. * `on_picture`: over the picture itself.
pub(super) fn bar(
    canvas: &mut Canvas,
    um_per_pixel: f64,
    right: Vec2,
    share: f64,
    text: f32,
    on_picture: bool,
) -> f32 {
    let room = share * f64::from(right.x) * um_per_pixel;
    let decade = 10f64.powf(room.log10().floor());
    let length = [5.0, 2.0, 1.0]
        .map(|f| f * decade)
        .into_iter()
        .find(|&l| l <= room)
        .unwrap_or(decade);
    let pixels = (length / um_per_pixel) as f32;
    let label = format!("{length} \u{b5}m");
    let height = GLYPH_HEIGHT * text;
    let (thick, tick) = (1.5 * text, 0.35 * height);
    let wide = text_width(&label, text);
    let left = right.x - pixels;
    let taken = pixels + wide + height;
    if on_picture {
        let pad = 0.5 * height;
        let min = Vec2::new(right.x - taken, right.y) - pad;
        canvas.fill_rect(min, Vec2::new(right.x, right.y + height) + pad, STRIP);
    }
    let middle = right.y + 0.5 * height;
    let mut fill = |x0: f32, x1: f32, half: f32| {
        let (min, max) = (Vec2::new(x0, middle - half), Vec2::new(x1, middle + half));
        canvas.fill_rect(min, max, INK);
    };
    fill(left, right.x, 0.5 * thick);
    fill(left, left + text, tick);
    fill(right.x - text, right.x, tick);
    let at = Vec2::new(right.x - taken, right.y);
    canvas.text(at, &label, text, INK);
    taken
}

/// Breaks a text into lines of at most `columns` characters. Numbers and their units stay together.
pub(crate) fn wrap(text: &str, columns: usize) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let is_unit = matches!(word.trim_end_matches([',', ';']), "%" | "µm" | "mm");
        match words.last_mut() {
            Some(number) if is_unit && number.ends_with(|c: char| c.is_ascii_digit()) => {
                number.push(' ');
                number.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
    }
    let mut lines: Vec<String> = vec![String::new()];
    for word in &words {
        if let Some(line) = lines.last_mut() {
            if line.is_empty() {
                line.push_str(word);
            } else if line.chars().count() + 1 + word.chars().count() <= columns {
                line.push(' ');
                line.push_str(word);
            } else {
                lines.push(format!(" {word}"));
            }
        }
    }
    lines
}
