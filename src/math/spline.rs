//! The curve of every strand: a Catmull-Rom spline through all points, its ends pinned by reflected neighbors.

use std::ops::{Add, Div, Sub};

/// Bezier points of the piece that begins at a point.
///
/// * `count`: of the points, at least two. * `at`: a point. * `first`: before `count - 1`.
/// * `S`: the scalar of `V`.
pub(crate) fn bezier_piece<V, S>(count: usize, at: impl Fn(usize) -> V, first: usize) -> [V; 4]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Div<S, Output = V>,
    S: From<u8>,
{
    let (b, c) = (at(first), at(first + 1));
    let a = if first == 0 { b + b - c } else { at(first - 1) };
    let d = if first + 2 == count {
        c + c - b
    } else {
        at(first + 2)
    };
    [b, b + (c - a) / S::from(6), c - (d - b) / S::from(6), c]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spline through points of a line, evenly spaced or not, leaves each of its points by half the way between
    /// its neighbors, and its ends straight.
    #[test]
    fn pieces_meet_with_half_the_way_between_neighbors() {
        let points = [0.0f64, 1.0, 3.0, 4.0];
        let piece = |first| bezier_piece::<f64, f64>(points.len(), |i| points[i], first);
        let tangents = |[a, b, c, d]: [f64; 4]| [3.0 * (b - a), 3.0 * (d - c)];
        for (first, expected) in [(0, [1.0, 1.5]), (1, [1.5, 1.5]), (2, [1.5, 1.0])] {
            let [from, to] = tangents(piece(first));
            assert!((from - expected[0]).abs() < 1e-12 && (to - expected[1]).abs() < 1e-12);
            assert_eq!(
                [piece(first)[0], piece(first)[3]],
                [points[first], points[first + 1]]
            );
        }
        // Two points are a straight line.
        let [a, b, c, d] = bezier_piece::<f64, f64>(2, |i| points[i], 0);
        assert!((b - a - 1.0 / 3.0).abs() < 1e-12 && (d - c - 1.0 / 3.0).abs() < 1e-12);
    }
}
