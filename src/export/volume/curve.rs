//! Strands as straight pieces, fine enough for voxels.

use crate::math::spline::bezier_piece;
use glam::{DVec3, Vec3};

/// Most pieces of one span, a guard against absurd control points.
const MAX_PIECES: f64 = 32.0;
/// Longest piece in steps: where a piece is passed over, all of it is.
const STEPS: f64 = 64.0;
/// Longest span in steps. Every leaf looks at all pieces of a span that it meets.
pub(super) const MOST_STEPS: f64 = 4096.0;
/// Largest turn from piece to piece, radians: chords of an arc are shorter by a 24th of its square.
const TURN: f64 = 0.15;

/// Curves through control points, as a groom has them: Catmull-Rom splines through all points, their
/// ends pinned by reflected neighbors.
#[derive(Clone, Copy, Debug)]
pub struct Curves<'a> {
    /// Control points, units.
    pub points: &'a [Vec3],
    /// Full diameter at each control point, units.
    pub widths: &'a [f32],
    /// Start of each curve in `points`; one more entry than curves.
    pub offsets: &'a [u32],
    /// Scattering albedo at each control point, linear; may be empty where no colors are asked for.
    pub colors: &'a [Vec3],
}

/// A point of a strand between two pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    /// Units.
    pub(super) at: DVec3,
    /// Diameter, units.
    pub(super) width: f64,
    /// Way along the span, 0 .. 1.
    pub(super) t: f64,
}

impl<'a> Curves<'a> {
    /// Number of curves.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Indices of the first control points of all spans of a curve.
    pub(super) fn spans(&self, curve: usize) -> std::ops::Range<usize> {
        let [first, end] = [curve, curve + 1].map(|i| self.offsets[i] as usize);
        first..end.saturating_sub(1).max(first)
    }

    /// The curve that a control point belongs to.
    pub(super) fn curve_of(&self, point: usize) -> usize {
        self.offsets.partition_point(|&o| o as usize <= point) - 1
    }

    /// Joints of the span that begins at control point `i`, both ends included.
    ///
    /// * `step`: the pieces stray from the spline by at most an eighth of this, units.
    pub(super) fn joints(&self, i: usize, curve: usize, step: f64, out: &mut Vec<Joint>) {
        let spans = self.spans(curve);
        let at = |k: usize| self.points[spans.start + k].as_dvec3();
        let span = bezier_piece::<_, f64>(spans.len() + 1, at, i - spans.start);
        let [b, .., c] = span;
        let by_length = (b.distance(c) / (STEPS * step))
            .min(MOST_STEPS / STEPS)
            .ceil();
        let pieces = pieces_of(&span, step / 8.0).max(by_length as usize);
        let (w0, w1) = (f64::from(self.widths[i]), f64::from(self.widths[i + 1]));
        out.clear();
        out.extend((0..=pieces).map(|k| {
            let t = k as f64 / pieces as f64;
            Joint {
                at: if k == pieces { c } else { bezier(&span, t) },
                width: w0 + (w1 - w0) * t,
                t,
            }
        }));
    }
}

/// Uniform pieces needed for the chord error (Wang's formula) and the turn.
fn pieces_of([a, b, c, d]: &[DVec3; 4], error: f64) -> usize {
    let bend = (*a - 2.0 * *b + *c)
        .length()
        .max((*b - 2.0 * *c + *d).length());
    let by_chord = (0.75 * bend / error).sqrt();
    let turn = |u: DVec3, v: DVec3| u.cross(v).length().atan2(u.dot(v));
    let by_turn = (turn(*b - *a, *c - *b) + turn(*c - *b, *d - *c)) / TURN;
    by_chord.max(by_turn).ceil().clamp(1.0, MAX_PIECES) as usize
}

fn bezier([a, b, c, d]: &[DVec3; 4], t: f64) -> DVec3 {
    let s = 1.0 - t;
    s * s * s * *a + 3.0 * s * s * t * *b + 3.0 * s * t * t * *c + t * t * t * *d
}
