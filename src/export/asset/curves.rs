//! Kinds of curves: how control points of the groom become those of a file.

use crate::math::spline::bezier_piece;
use glam::Vec3;
use std::ops::{Add, Mul};

/// How strands are written. All but `Linear` have the groom's own shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curves {
    /// Catmull-Rom, pinned at its ends: the curve goes through all points.
    #[default]
    Pinned,
    /// Catmull-Rom with a mirrored point beyond each end, for readers that do not know `pinned`.
    Phantom,
    /// Bezier, for readers that know no other cubic curve.
    Bezier,
    /// Straight pieces between the points.
    Linear,
}

impl Curves {
    /// `type`, `basis` and `wrap` of the schema; no basis for straight pieces.
    pub fn schema(self) -> (&'static str, Option<&'static str>, &'static str) {
        match self {
            Self::Pinned => ("cubic", Some("catmullRom"), "pinned"),
            Self::Phantom => ("cubic", Some("catmullRom"), "nonperiodic"),
            Self::Bezier => ("cubic", Some("bezier"), "nonperiodic"),
            Self::Linear => ("linear", None, "nonperiodic"),
        }
    }

    /// Number of control points that `points` of one strand become.
    pub fn count(self, points: usize) -> usize {
        self.total(1, points)
    }

    /// Number of control points that those of all `strands` together become: `points` of the groom.
    pub fn total(self, strands: usize, points: usize) -> usize {
        match self {
            Self::Pinned | Self::Linear => points,
            Self::Phantom => points + 2 * strands,
            Self::Bezier => 3 * points.saturating_sub(strands) + strands,
        }
    }

    /// Appends the control points of a strand.
    pub(super) fn points(self, points: &[Vec3], out: &mut Vec<Vec3>) {
        let n = points.len();
        if n < 2 {
            out.extend(points);
            return;
        }
        match self {
            Self::Pinned | Self::Linear => out.extend(points),
            Self::Phantom => {
                // The points beyond the curve's ends mirror their neighbors.
                out.push(2.0 * points[0] - points[1]);
                out.extend(points);
                out.push(2.0 * points[n - 1] - points[n - 2]);
            }
            Self::Bezier => {
                for i in 0..n - 1 {
                    let piece = bezier_piece::<_, f32>(n, |i| points[i], i);
                    out.extend(&piece[..3]);
                }
                out.push(points[n - 1]);
            }
        }
    }

    /// Appends what belongs to the control points of a strand other than their places: straight between
    /// the groom's own.
    pub(super) fn values<T>(self, values: &[T], out: &mut Vec<T>)
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
            return;
        };
        match self {
            Self::Pinned | Self::Linear => out.extend(values),
            Self::Phantom => {
                out.push(first);
                out.extend(values);
                out.push(last);
            }
            Self::Bezier => {
                for pair in values.windows(2) {
                    let third = |t: f32| pair[0] * (1.0 - t) + pair[1] * t;
                    out.extend([pair[0], third(1.0 / 3.0), third(2.0 / 3.0)]);
                }
                out.push(last);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [Vec3; 4] = [
        Vec3::ZERO,
        Vec3::new(1.0, 0.5, 0.0),
        Vec3::new(2.0, -1.0, 0.3),
        Vec3::new(2.5, 0.0, 1.0),
    ];

    fn catmull_rom(p: &[Vec3], t: f32) -> Vec3 {
        let [a, b, c, d] = [p[0], p[1], p[2], p[3]];
        0.5 * (2.0 * b
            + (c - a) * t
            + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
            + (3.0 * b - a - 3.0 * c + d) * t * t * t)
    }

    fn bezier(p: &[Vec3], t: f32) -> Vec3 {
        let s = 1.0 - t;
        p[0] * s * s * s + p[1] * 3.0 * s * s * t + p[2] * 3.0 * s * t * t + p[3] * t * t * t
    }

    #[test]
    fn all_cubic_kinds_are_the_same_curve() {
        let (mut phantom, mut handles) = (Vec::new(), Vec::new());
        Curves::Phantom.points(&POINTS, &mut phantom);
        Curves::Bezier.points(&POINTS, &mut handles);
        assert_eq!(phantom.len(), Curves::Phantom.count(4));
        assert_eq!(handles.len(), Curves::Bezier.count(4));
        for piece in 0..3 {
            for t in [0.0, 0.3, 0.7, 1.0] {
                let a = catmull_rom(&phantom[piece..], t);
                let b = bezier(&handles[3 * piece..], t);
                assert!(a.distance(b) < 1e-5, "{piece} {t}: {a} {b}");
            }
        }
    }

    #[test]
    fn every_control_point_has_its_value() {
        for curves in [
            Curves::Pinned,
            Curves::Phantom,
            Curves::Bezier,
            Curves::Linear,
        ] {
            for points in 2..6 {
                let (mut places, mut values) = (Vec::new(), Vec::new());
                curves.points(&vec![Vec3::X; points], &mut places);
                curves.values(&vec![2.0f32; points], &mut values);
                assert_eq!(places.len(), curves.count(points));
                assert_eq!(values.len(), curves.count(points));
                assert!(values.iter().all(|v| (v - 2.0).abs() < 1e-6));
            }
        }
    }
}
