//! The nearest point of a triangle.

use glam::DVec3;

/// Weights of the corners at the point of a triangle that is nearest to `p`, by the region that `p` is in
/// (Ericson 2005, "Real-Time Collision Detection", 5.1.5). They are 0..1 and sum to 1.
pub(crate) fn nearest(&[a, b, c]: &[DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return DVec3::X;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return DVec3::Y;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return DVec3::new(1.0 - t, t, 0.0);
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return DVec3::Z;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return DVec3::new(1.0 - t, 0.0, t);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return DVec3::new(0.0, 1.0 - t, t);
    }
    let sum = va + vb + vc;
    DVec3::new(va, vb, vc) / sum
}

/// What is at these weights of the corners.
pub(crate) fn blend(&[a, b, c]: &[DVec3; 3], weights: DVec3) -> DVec3 {
    a * weights.x + b * weights.y + c * weights.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    #[test]
    fn agrees_with_a_search_over_the_triangle() {
        let mut rng = Rng::new(5, 0);
        let mut vec = || {
            DVec3::from_array(std::array::from_fn(|_| {
                f64::from(rng.uniform_f32()) * 2.0 - 1.0
            }))
        };
        for _ in 0..200 {
            let corners = [vec(), vec(), vec()];
            let p = 2.0 * vec();
            let steps = 300;
            let mut least = f64::INFINITY;
            for i in 0..=steps {
                for j in 0..=steps - i {
                    let (u, v) = (f64::from(i) / 300.0, f64::from(j) / 300.0);
                    let q = blend(&corners, DVec3::new(1.0 - u - v, u, v));
                    least = least.min(p.distance(q));
                }
            }
            let weights = nearest(&corners, p);
            assert!(weights.min_element() >= 0.0 && (weights.element_sum() - 1.0).abs() < 1e-12);
            let found = p.distance(blend(&corners, weights));
            assert!(
                found <= least + 1e-12 && found > least - 0.02,
                "{found} {least}"
            );
        }
    }
}
