//! The plate: outside, longitudinal cut and cross-section of a fiber with labels and scale bars.

use super::specimen::{HalfSpace, Specimen};
use crate::fiber::{Fiber, Region};
use crate::image::{Canvas, GLYPH_HEIGHT, text_width};
use crate::progress::{Cancel, Progress};
use crate::sampling::{Rng, hash64};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

/// What is written beside the pictures.
pub(super) struct Labels {
    pub(super) title: String,
    pub(super) subtitle: String,
    pub(super) facts: Vec<String>,
}

/// Samples along a pixel's side.
const SAMPLES: u32 = 4;
const BACKGROUND: Vec3 = Vec3::new(0.045, 0.05, 0.058);
const INK: Vec3 = Vec3::new(0.93, 0.93, 0.9);
const FAINT: Vec3 = Vec3::new(0.6, 0.62, 0.64);
/// Rows of scales that the outside shows at least.
const ROWS_SHOWN: f64 = 6.0;
/// Angle of the view toward the root, radians: from straight above, risers are edge-on and invisible.
const VIEW_TILT: f64 = 0.32;

/// A rectangle of pixels.
#[derive(Clone, Copy)]
struct Panel {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// Draws the plate; `None` when canceled.
pub(super) fn draw(
    fiber: &Fiber,
    labels: &Labels,
    (width, height): (usize, usize),
    progress: &dyn Progress,
    cancel: &Cancel,
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
    let section = Panel {
        x: width - side - margin,
        y: top,
        width: side,
        height: side,
    };
    progress.begin("drawing", (2 * long.height + section.height) as u64, "rows");
    let diameter = 2.0 * fiber.bounding_radius_um();
    // The fiber fills the picture, unless it is so thin that no pattern of scales would show.
    let pattern = ROWS_SHOWN * fiber.structure().cuticle.pitch_um / long.width as f64;
    let scale = (diameter / (0.86 * long.height as f64)).max(pattern);
    shoot(
        &mut canvas,
        long,
        &lengthwise(fiber, scale, long, false),
        progress,
        cancel,
    )?;
    shoot(
        &mut canvas,
        cut,
        &lengthwise(fiber, scale, cut, true),
        progress,
        cancel,
    )?;
    let across = diameter / (0.9 * section.height as f64);
    shoot(
        &mut canvas,
        section,
        &crosswise(fiber, across, section),
        progress,
        cancel,
    )?;
    progress.finish();

    let at = |x: usize, y: usize| Vec2::new(x as f32, y as f32);
    canvas.text(at(margin, margin), &labels.title, 1.5 * text, INK);
    let below = margin + (1.5 * line as f32) as usize;
    canvas.text(at(margin, below), &labels.subtitle, text, FAINT);
    let under = |p: Panel| at(p.x, p.y + p.height + line / 4);
    canvas.text(under(long), "outside, root left, tip right", text, FAINT);
    canvas.text(under(cut), "front half cut away", text, FAINT);
    let next_line = Vec2::new(0.0, GLYPH_HEIGHT * text * 1.7);
    canvas.text(under(section) + next_line, "cross-section", text, FAINT);
    bar(&mut canvas, scale, long, text);
    bar(&mut canvas, scale, cut, text);
    bar(&mut canvas, across, section, text);
    let columns = (side as f32 / text_width("m", text)) as usize;
    let mut y = section.y + section.height + 3 * line;
    for row in labels.facts.iter().flat_map(|fact| wrap(fact, columns)) {
        canvas.text(at(section.x, y), &row, text, INK);
        y += (GLYPH_HEIGHT * text * 1.5) as usize;
    }
    Some(canvas)
}

/// A view: where the ray of a point of the panel begins, and which way all rays go.
struct View<'a> {
    specimen: Specimen<'a>,
    dir: DVec3,
    origin: Box<dyn Fn(f64, f64) -> DVec3 + Sync + 'a>,
}

/// Seen from the side: z to the right, an oblique parallel view so that z is true to scale.
fn lengthwise<'a>(fiber: &'a Fiber, scale: f64, panel: Panel, cut: bool) -> View<'a> {
    let length = panel.width as f64 * scale;
    // The flat side of the section faces the viewer (-y).
    let dir = DVec3::new(0.0, VIEW_TILT.cos(), -VIEW_TILT.sin());
    let far = 4.0 * fiber.bounding_radius_um();
    let (w, h) = (panel.width as f64, panel.height as f64);
    let removed = if cut {
        let toward_viewer = HalfSpace {
            normal: DVec3::NEG_Y,
            offset: 0.0,
        };
        let beyond = HalfSpace {
            normal: DVec3::Z,
            offset: 0.2 * length,
        };
        vec![toward_viewer, beyond]
    } else {
        Vec::new()
    };
    View {
        specimen: Specimen {
            fiber,
            removed,
            // Low from the root and from above: margins throw shadows toward the tip. A cut is lit
            // more steeply, or the part that is left whole darkens it.
            lamp: if cut {
                DVec3::new(0.5, -0.8, -0.25).normalize()
            } else {
                DVec3::new(0.62, -0.62, -0.75).normalize()
            },
            tinted: cut,
        },
        dir,
        origin: Box::new(move |x, y| {
            DVec3::new((0.5 * h - y) * scale, 0.0, (x / w) * length) - far * dir
        }),
    }
}

/// Seen from the tip onto a cut across; the cut goes through a void if there is one.
fn crosswise<'a>(fiber: &'a Fiber, scale: f64, panel: Panel) -> View<'a> {
    let voids = |z: f64| {
        let probes = (0..64).map(|i| {
            let r = 0.9 * f64::from(i / 8) / 8.0;
            let phi = std::f64::consts::TAU * f64::from(i % 8) / 8.0;
            fiber.bounding_radius_um() * r * DVec3::new(phi.cos(), phi.sin(), 0.0) + z * DVec3::Z
        });
        probes
            .filter(|&p| fiber.region_at(p) == Region::Void)
            .count()
    };
    let period = fiber.period_um();
    let z = (0..256)
        .map(|i| period * f64::from(i) / 256.0)
        .max_by_key(|&z| voids(z))
        .unwrap_or(0.0);
    let half = 0.5 * panel.height as f64;
    View {
        specimen: Specimen {
            fiber,
            removed: vec![HalfSpace {
                normal: DVec3::Z,
                offset: z,
            }],
            lamp: DVec3::new(-0.5, 0.5, 0.9).normalize(),
            tinted: true,
        },
        dir: DVec3::NEG_Z,
        origin: Box::new(move |x, y| DVec3::new((x - half) * scale, (half - y) * scale, z + 10.0)),
    }
}

/// Renders a view into its panel.
fn shoot(
    canvas: &mut Canvas,
    panel: Panel,
    view: &View,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Option<()> {
    let rows: Vec<Option<Vec<Vec3>>> = (0..panel.height)
        .into_par_iter()
        .map(|y| {
            if cancel.is_cancelled() {
                return None;
            }
            let row = (0..panel.width).map(|x| pixel(view, panel, x, y)).collect();
            progress.advance(1);
            Some(row)
        })
        .collect();
    for (y, row) in rows.into_iter().enumerate() {
        for (x, color) in row?.into_iter().enumerate() {
            canvas.set(panel.x + x, panel.y + y, color);
        }
    }
    Some(())
}

fn pixel(view: &View, panel: Panel, x: usize, y: usize) -> Vec3 {
    let index = (y * panel.width + x) as u64;
    let background = BACKGROUND.map(crate::color::linear_from_srgb).as_dvec3();
    let mut sum = DVec3::ZERO;
    for sample in 0..SAMPLES * SAMPLES {
        let mut rng = Rng::new(hash64(index), u64::from(sample));
        let (i, j) = (sample % SAMPLES, sample / SAMPLES);
        let px = x as f64 + (f64::from(i) + rng.uniform()) / f64::from(SAMPLES);
        let py = y as f64 + (f64::from(j) + rng.uniform()) / f64::from(SAMPLES);
        let seen = view
            .specimen
            .look((view.origin)(px, py), view.dir, &mut rng);
        sum += seen.unwrap_or(background);
    }
    let mean = sum / f64::from(SAMPLES * SAMPLES);
    mean.as_vec3()
        .map(|v| crate::color::srgb_from_linear(v.min(1.0)))
}

/// A scale bar in the lower right corner of a panel.
fn bar(canvas: &mut Canvas, um_per_pixel: f64, panel: Panel, text: f32) {
    let room = 0.3 * panel.width as f64 * um_per_pixel;
    let decade = 10f64.powf(room.log10().floor());
    let length = [5.0, 2.0, 1.0]
        .map(|f| f * decade)
        .into_iter()
        .find(|&l| l <= room)
        .unwrap_or(decade);
    let pixels = (length / um_per_pixel) as f32;
    let label = format!("{length} \u{b5}m");
    let right = (panel.x + panel.width) as f32 - 4.0 * text;
    let y = (panel.y + panel.height) as f32 + 6.0 * text;
    let thick = 2.0 * text;
    canvas.fill_rect(
        Vec2::new(right - pixels, y),
        Vec2::new(right, y + thick),
        INK,
    );
    for x in [right - pixels, right - text] {
        canvas.fill_rect(
            Vec2::new(x, y - 2.0 * text),
            Vec2::new(x + text, y + thick + 2.0 * text),
            INK,
        );
    }
    let at = Vec2::new(
        right - pixels - text_width(&label, text) - 6.0 * text,
        y - 3.0 * text,
    );
    canvas.text(at, &label, text, INK);
}

/// Breaks a text into lines of at most `columns` characters.
fn wrap(text: &str, columns: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split(' ') {
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
