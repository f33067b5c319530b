//! Cubic strands cut into straight pieces.

use crate::math::spline::bezier_piece;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// Longest distance between the cubic and its pieces, in widths. At 0.3 the joints of a strand
/// that fills a few pixels show; at 0.03 segments double and no picture changes.
const CHORD_ERROR: f32 = 0.1;

/// Turn between two pieces below which the chord error is let go, radians. Tangents run smoothly
/// over joints, so a turn of 12 degrees is invisible unless the strand fills many pixels; at 20
/// crimped underhair looks like polygons.
const MAX_TURN: f32 = 12.0 * std::f32::consts::PI / 180.0;

/// Most pieces of one span, a guard against absurd control points.
const MAX_PIECES: usize = 64;

/// Cuts a strand into pieces.
///
/// * `points`: control points with half widths in w; a Catmull-Rom spline goes through all of them,
///   its ends pinned by reflected neighbors.
/// * `out`: receives the joints, first and last control point included. Equal neighbors are
///   dropped, so fewer than two joints mean a strand without length.
pub(super) fn flatten(points: &[Vec4], out: &mut Vec<Vec4>) {
    let Some(first) = points.first() else { return };
    out.push(*first);
    for i in 0..points.len().saturating_sub(1) {
        let span = bezier_piece::<_, f32>(points.len(), |i| points[i], i);
        let pieces = pieces_of(&span);
        for k in 1..=pieces {
            let joint = if k == pieces {
                span[3]
            } else {
                // Overshoot of the cubic must not make a width negative.
                let p = bezier(&span, k as f32 / pieces as f32);
                p.xyz().extend(p.w.max(0.0))
            };
            if out.last().is_some_and(|last| last.xyz() != joint.xyz()) {
                out.push(joint);
            }
        }
    }
}

/// Uniform pieces needed for the chord error (Wang's formula) or the turn, whichever is fewer.
fn pieces_of(span: &[Vec4; 4]) -> usize {
    let [a, b, c, d] = span.map(|p| p.xyz());
    let bend = (a - 2.0 * b + c).length().max((b - 2.0 * c + d).length());
    let width = span[0].w + span[3].w;
    let by_chord = (0.75 * bend / (CHORD_ERROR * width).max(1e-6)).sqrt();
    let by_turn = turn(b - a, c - b) + turn(c - b, d - c);
    (by_chord.min(by_turn / MAX_TURN).ceil() as usize).clamp(1, MAX_PIECES)
}

fn turn(a: Vec3, b: Vec3) -> f32 {
    a.cross(b).length().atan2(a.dot(b))
}

fn bezier([a, b, c, d]: &[Vec4; 4], t: f32) -> Vec4 {
    let s = 1.0 - t;
    s * s * s * *a + 3.0 * s * s * t * *b + 3.0 * s * t * t * *c + t * t * t * *d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_strands_keep_their_control_points() {
        let points: Vec<Vec4> = (0..5)
            .map(|i| Vec4::new(0.0, i as f32, 0.0, 0.01))
            .collect();
        let mut out = Vec::new();
        flatten(&points, &mut out);
        assert_eq!(out, points);
    }

    #[test]
    fn a_thick_arc_is_followed_within_a_tenth_of_its_width() {
        let points: Vec<Vec4> = (0..7)
            .map(|i| (i as f32 * 0.3).sin_cos())
            .map(|(s, c)| Vec4::new(10.0 * c, 10.0 * s, 0.0, 0.25))
            .collect();
        let mut out = Vec::new();
        flatten(&points, &mut out);
        assert!(out.len() > points.len());
        // Away from the pinned ends the spline follows the circle to 1e-3 of its radius.
        for pair in out.windows(2).skip(4).take(out.len() - 9) {
            let middle = 0.5 * (pair[0].xyz() + pair[1].xyz());
            assert!((middle.length() - 10.0).abs() < 0.05 + 0.01);
        }
    }

    #[test]
    fn fine_crimped_strands_turn_little_at_each_joint() {
        let points: Vec<Vec4> = (0..40)
            .map(|i| Vec4::new(0.3 * (i as f32).sin(), 0.2 * i as f32, 0.0, 0.004))
            .collect();
        let mut out = Vec::new();
        flatten(&points, &mut out);
        for joint in out.windows(3) {
            let angle = turn(
                joint[1].xyz() - joint[0].xyz(),
                joint[2].xyz() - joint[1].xyz(),
            );
            assert!(angle < 2.5 * MAX_TURN, "{angle}");
        }
    }

    #[test]
    fn a_point_has_no_pieces() {
        let mut out = Vec::new();
        flatten(&[Vec4::ONE; 4], &mut out);
        assert_eq!(out.len(), 1);
    }
}
