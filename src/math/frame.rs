//! Angle conventions shared by the whole program.
//!
//! In the fiber frame the tangent, root to tip, is +Z. Directions are unit vectors that leave the
//! fiber: `wi` to the light, `wo` to the viewer. `theta` is the inclination from the normal plane,
//! in `[-pi/2, pi/2]`, positive toward the tip; `alpha = pi/2 - theta` is the polar angle from +Z.

use glam::{DVec3, Mat3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Inclination of a unit direction from the normal plane, radians in `[-pi/2, pi/2]`.
pub fn theta_of(w: DVec3) -> f64 {
    // asin loses half the digits near the poles; atan2 does not.
    w.z.atan2(w.x.hypot(w.y))
}

/// The unit direction of inclination `theta` and azimuth `phi`, both in radians.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let (sin_t, cos_t) = theta.sin_cos();
    let (sin_p, cos_p) = phi.sin_cos();
    DVec3::new(cos_t * cos_p, cos_t * sin_p, sin_t)
}

/// The paper's bin of a query direction: `floor(bins * alpha / pi)`, clamped to `bins - 1` at pi.
pub fn paper_bin(theta: f64, bins: usize) -> usize {
    let alpha = FRAC_PI_2 - theta;
    ((bins as f64 * alpha / PI).floor().max(0.0) as usize).min(bins - 1)
}

/// Moves a unit direction along its meridian by the angle whose sine and cosine are given, toward
/// +Z for a positive angle, and on over the pole if it comes to that. Azimuth is kept (or turned by
/// pi beyond the pole). This is the cone frame of the tables: with the angle `theta_q - theta_node`
/// a specular cone stays where it is while the query inclination changes.
pub fn shift_inclination(w: DVec3, sin: f64, cos: f64) -> DVec3 {
    let c = w.x.hypot(w.y);
    if c < 1e-12 {
        // On the pole every meridian will do.
        return DVec3::new(-w.z.signum() * sin, 0.0, w.z * cos);
    }
    let scale = (c * cos - w.z * sin) / c;
    DVec3::new(w.x * scale, w.y * scale, w.z * cos + c * sin)
}

/// Right-handed basis at a strand: columns are X (toward `wo`, orthogonal to the tangent), Y and Z
/// (the tangent). For `wo` along the tangent any X will do.
pub fn strand_frame(tangent: Vec3, wo: Vec3) -> Mat3 {
    let x = (wo - tangent * wo.dot(tangent)).try_normalize();
    let x = x.unwrap_or_else(|| tangent.any_orthonormal_vector());
    Mat3::from_cols(x, tangent.cross(x), tangent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_round_trip() {
        for i in -8..=8 {
            let theta = f64::from(i) * FRAC_PI_2 / 8.0;
            assert!((theta_of(direction(theta, 0.7)) - theta).abs() < 1e-14);
        }
    }

    #[test]
    fn shifts_add_to_the_inclination_and_pass_the_pole() {
        let shift = |theta: f64, phi: f64, delta: f64| {
            shift_inclination(direction(theta, phi), delta.sin(), delta.cos())
        };
        assert!((shift(0.3, 1.1, 0.2) - direction(0.5, 1.1)).length() < 1e-14);
        assert!((shift(0.3, 1.1, -0.7) - direction(-0.4, 1.1)).length() < 1e-14);
        assert!((shift(1.5, 1.1, 0.2) - direction(PI - 1.7, 1.1 + PI)).length() < 1e-14);
        assert!((shift(FRAC_PI_2, 0.0, 0.2).length() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn last_bin_takes_its_end() {
        assert_eq!(paper_bin(FRAC_PI_2, 16), 0);
        assert_eq!(paper_bin(-FRAC_PI_2, 16), 15);
        assert_eq!(paper_bin(1e-9, 16), 7);
        assert_eq!(paper_bin(-1e-9, 16), 8);
    }

    #[test]
    fn frame_is_orthonormal_even_along_the_tangent() {
        for wo in [Vec3::X, Vec3::Z, Vec3::new(0.1, -0.3, 0.9).normalize()] {
            let m = strand_frame(Vec3::Z, wo);
            assert!((m.determinant() - 1.0).abs() < 1e-5);
            assert!((m.transpose() * wo).y.abs() < 1e-6);
        }
    }
}
