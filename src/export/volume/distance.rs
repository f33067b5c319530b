//! How far a point is from a triangle.

use glam::DVec3;

/// Distance of `p` from the nearest point of the triangle, by the region that `p` is in (Ericson 2005,
/// section 5.1.5).
pub(super) fn to_triangle(p: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length();
    }
    let bp = p - *b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).length();
    }
    let cp = p - *c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).length();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (bp - (*c - *b) * t).length();
    }
    let sum = va + vb + vc;
    (ap - ab * (vb / sum) - ac * (vc / sum)).length()
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
                    let q =
                        corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
                    least = least.min(p.distance(q));
                }
            }
            let found = to_triangle(p, &corners);
            assert!(
                found <= least + 1e-12 && found > least - 0.02,
                "{found} {least}"
            );
        }
    }
}
