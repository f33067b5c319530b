//! Two tables and their difference side by side, for one incidence.

use super::sphere_map::{self, MapStyle};
use super::text::Pen;
use super::{Area, FAINT, Field, INK, PAPER, SUPERSAMPLE, letter_scale};
use crate::image::Canvas;
use crate::table::compare::TableRef;
use crate::table::{ScatterTable, TableError};
use glam::Vec2;

/// What to draw.
#[derive(Clone, Debug)]
pub struct DifferencePlot<'a> {
    /// The table to judge and the reference.
    pub tables: [TableRef<'a>; 2],
    /// What to call them.
    pub names: [String; 2],
    /// Absorption level or color channel.
    pub channel: usize,
    /// Inclination of the query direction, degrees in -90..=90.
    pub incidence_deg: f64,
    /// Width and height in pixels, 1200 x 400 to 8192 x 8192.
    pub size: (usize, usize),
}

impl DifferencePlot<'_> {
    /// The picture: both on the color scale of the reference, then their difference in shares of the
    /// reference's peak, red where the first table is brighter.
    ///
    /// * Errors: inclination, channel or size out of range.
    pub fn draw(&self) -> Result<Canvas, TableError> {
        let (width, height) = self.size;
        if !(1200..=8192).contains(&width) || !(400..=8192).contains(&height) {
            return Err(TableError::Request(format!(
                "a comparison of {width}x{height} pixels; 1200x400 to 8192x8192 are possible"
            )));
        }
        super::check_incidence(self.incidence_deg)?;
        let [a, b] = [self.prepare(0)?, self.prepare(1)?];
        let theta = self.incidence_deg.to_radians();
        let reference = Field::new(&b.0, theta, b.1);
        let mut judged = Field::new(&a.0, theta, a.1);
        judged.peak = reference.peak;

        let (w, h) = (width * SUPERSAMPLE, height * SUPERSAMPLE);
        let size = Vec2::new(w as f32, h as f32);
        let mut canvas = Canvas::new(w, h, PAPER);
        let pen = Pen::new(letter_scale(0.62 * size.x, 1.3 * size.y));
        let margin = 2.0 * pen.line();
        let head = format!(
            "{} and {}, incidence {}°",
            self.names[0], self.names[1], self.incidence_deg
        );
        let at = Vec2::new(margin, 0.7 * margin);
        pen.left(&mut canvas, at, &head, INK);
        let top = 0.7 * margin + 4.5 * pen.line();
        let difference = sphere_map::Difference::new(&judged, &reference);
        let styles = [
            (self.names[0].as_str(), MapStyle::Density(&judged)),
            (self.names[1].as_str(), MapStyle::Density(&reference)),
            (
                "difference, share of the peak",
                MapStyle::Difference(&difference),
            ),
        ];
        for (i, (name, style)) in styles.iter().enumerate() {
            let column = (size.x - margin) / 3.0;
            let left = 0.5 * margin + i as f32 * column;
            let area = Area {
                min: Vec2::new(left, top),
                max: Vec2::new(left + column, size.y - 0.5 * margin),
            };
            sphere_map::draw(&mut canvas, &pen, area, style, name);
        }
        let note = "S cos θ per steradian";
        let below = Vec2::new(margin, 0.7 * margin + 1.4 * pen.line());
        pen.left(&mut canvas, below, note, FAINT);
        Ok(canvas.downsampled(SUPERSAMPLE))
    }

    /// One channel of a table for look-up, and its photons a node.
    fn prepare(&self, which: usize) -> Result<(ScatterTable, f64), TableError> {
        let table = self.tables[which];
        let (nodes, res) = (table.nodes(), table.res());
        nodes.only_averaged()?;
        let gray = table.channel(self.channel).ok_or_else(|| {
            TableError::Request(format!(
                "channel {} was asked for; {} has channels 0 to {}",
                self.channel,
                self.names[which],
                table.channels() - 1
            ))
        })?;
        let gray = gray.into_iter().map(|f| [f; 3]).collect();
        let photons = table.photons() / nodes.len() as f64;
        Ok((ScatterTable::new(nodes.clone(), res, gray), photons))
    }
}
