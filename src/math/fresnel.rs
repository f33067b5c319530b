//! Reflection and refraction at dielectrics, thin layers and conductors, unpolarized.

use glam::DVec3;

/// Unpolarized Fresnel reflectance of a smooth dielectric boundary.
///
/// * `cos_i`: cosine between the direction and the normal on its own side, in `[0, 1]`.
/// * `eta`: index on the far side over the index on the near side, > 0.
/// * Returns the reflectance in `[0, 1]` and the cosine of the refracted direction; the cosine is 0
///   and the reflectance 1 beyond the critical angle.
#[inline]
pub fn dielectric(cos_i: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (
        0.5 * (parallel * parallel + perpendicular * perpendicular),
        cos_t,
    )
}

/// Whether a photon is reflected by a smooth dielectric boundary, and the cosine of the refracted
/// direction: [`dielectric`] compared with `u` without a division.
///
/// * `inverse`: the inverse of `eta`. * `u`: uniform in `[0, 1)`.
#[inline]
pub fn reflects(cos_i: f64, eta: f64, inverse: f64, u: f64) -> (bool, f64) {
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) * (inverse * inverse);
    if sin2_t >= 1.0 {
        return (true, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let (p, s) = (eta * cos_i + cos_t, cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) * s;
    let perpendicular = (cos_i - eta * cos_t) * p;
    let all = p * s;
    (
        2.0 * u * (all * all) < parallel * parallel + perpendicular * perpendicular,
        cos_t,
    )
}

/// Unpolarized reflectance of a stack of thin slabs, and the cosine behind it.
///
/// One slab of single-interface reflectance `r` reflects `r + (1 - r)^2 r / (1 - r^2)`, light
/// bouncing in it taken into account; `l` of them reflect `l f / (1 + (l - 1) f)`. Each polarization
/// by itself (Yan et al. 2015, "Physically-accurate fur reflectance"; Stokes' pile of plates).
///
/// * `cos_i`, `eta`: as for [`dielectric`]. * `layers`: how many slabs, > 0, fractions allowed.
#[inline]
pub fn layered(cos_i: f64, eta: f64, layers: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let stack = |amplitude: f64| {
        let r = amplitude * amplitude;
        // The same as in the formula above, without its 0 / 0 at r = 1.
        let slab = 2.0 * r / (1.0 + r);
        layers * slab / (1.0 + (layers - 1.0) * slab)
    };
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (0.5 * (stack(parallel) + stack(perpendicular)), cos_t)
}

/// Unpolarized reflectance of a smooth conductor (Born and Wolf, Principles of Optics, 14.2).
///
/// * `cos_i`: cosine between the direction and the normal, in `[0, 1]`.
/// * `n`, `k`: real and imaginary part of its index over the index of the medium before it.
#[inline]
pub fn conductor(cos_i: f64, n: f64, k: f64) -> f64 {
    let cos2 = cos_i * cos_i;
    let sin2 = 1.0 - cos2;
    let (n2, k2) = (n * n, k * k);
    let t0 = n2 - k2 - sin2;
    let a2b2 = (t0 * t0 + 4.0 * n2 * k2).sqrt();
    let a = (0.5 * (a2b2 + t0)).max(0.0).sqrt();
    let perpendicular =
        (a2b2 + cos2 - 2.0 * a * cos_i) / (a2b2 + cos2 + 2.0 * a * cos_i).max(f64::MIN_POSITIVE);
    let (t3, t4) = (cos2 * a2b2 + sin2 * sin2, 2.0 * a * cos_i * sin2);
    let parallel = if t3 + t4 > 0.0 {
        perpendicular * (t3 - t4) / (t3 + t4)
    } else {
        perpendicular
    };
    (0.5 * (parallel + perpendicular)).clamp(0.0, 1.0)
}

/// Mirror direction of a ray traveling along `dir` at a surface with unit normal `n`.
#[inline]
pub fn reflect(dir: DVec3, n: DVec3) -> DVec3 {
    dir - 2.0 * dir.dot(n) * n
}

/// Refracted direction of a ray traveling along unit `dir`.
///
/// * `n`: unit normal that faces the ray (`dir . n < 0`).
/// * `eta`: index on the far side over the index on the near side.
/// * `cos_t`: the cosine from [`dielectric`].
#[inline]
pub fn refract(dir: DVec3, n: DVec3, eta: f64, cos_t: f64) -> DVec3 {
    refract_by(dir, n, 1.0 / eta, cos_t)
}

/// [`refract`] given the inverse of `eta`.
#[inline]
pub fn refract_by(dir: DVec3, n: DVec3, inverse: f64, cos_t: f64) -> DVec3 {
    let cos_i = -dir.dot(n);
    renormalize(inverse * dir + (inverse * cos_i - cos_t) * n)
}

/// Takes the rounding off the length of a direction that was unit but for that: one step of
/// Newton's, which doubles the digits, without division and root.
#[inline]
pub fn renormalize(dir: DVec3) -> DVec3 {
    dir * (1.5 - 0.5 * dir.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_and_brewster() {
        let (r, cos_t) = dielectric(1.0, 1.5);
        assert!((r - 0.04).abs() < 1e-12 && (cos_t - 1.0).abs() < 1e-12);
        // At Brewster's angle only the perpendicular half is left.
        let cos_b = (1.0f64 / (1.0 + 1.5 * 1.5)).sqrt();
        let (r, cos_t) = dielectric(cos_b, 1.5);
        let perpendicular = (cos_b - 1.5 * cos_t) / (cos_b + 1.5 * cos_t);
        assert!((r - 0.5 * perpendicular * perpendicular).abs() < 1e-12);
    }

    #[test]
    fn total_internal_reflection_and_reversal() {
        assert_eq!(dielectric(0.1, 1.0 / 1.5), (1.0, 0.0));
        for i in 1..100 {
            let cos_i = f64::from(i) / 100.0;
            let (r, cos_t) = dielectric(cos_i, 1.55);
            let (back, cos_back) = dielectric(cos_t, 1.0 / 1.55);
            assert!((r - back).abs() < 1e-12 && (cos_back - cos_i).abs() < 1e-12);
        }
    }

    #[test]
    fn conductors_are_dielectrics_without_extinction() {
        for eta in [1.55, 1.0 / 1.55] {
            for i in 0..=100 {
                let cos_i = f64::from(i) / 100.0;
                let (expected, _) = dielectric(cos_i, eta);
                let found = conductor(cos_i, eta, 0.0);
                assert!((found - expected).abs() < 1e-9, "{cos_i}: {found}");
            }
        }
        // At normal incidence ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2); gold at 617 nm.
        let expected = (0.79f64 * 0.79 + 3.272 * 3.272) / (1.21 * 1.21 + 3.272 * 3.272);
        assert!((conductor(1.0, 0.21, 3.272) - expected).abs() < 1e-12);
        assert!((conductor(0.0, 0.21, 3.272) - 1.0).abs() < 1e-12);
        assert!(conductor(0.5, 1.0, 1e6) > 1.0 - 1e-5);
    }

    #[test]
    fn layers_reflect_by_the_formula() {
        // Keratin in air at normal incidence: one slab 0.089, half a one 0.047, two 0.163, five 0.33.
        for (layers, expected) in [(1.0, 0.0889), (0.5, 0.0465), (2.0, 0.1633), (5.0, 0.3280)] {
            let (found, cos_t) = layered(1.0, 1.55, layers);
            assert!((found - expected).abs() < 1e-4, "{layers}: {found}");
            assert!((cos_t - 1.0).abs() < 1e-12);
        }
        for i in 1..100 {
            let cos_i = f64::from(i) / 100.0;
            let (forward, cos_t) = layered(cos_i, 1.55, 1.7);
            let (back, _) = layered(cos_t, 1.0 / 1.55, 1.7);
            assert!((forward - back).abs() < 1e-12);
            assert!(forward > dielectric(cos_i, 1.55).0);
        }
        assert_eq!(layered(0.1, 1.0 / 1.55, 0.5), (1.0, 0.0));
    }

    #[test]
    fn the_choice_is_the_reflectance() {
        for eta in [1.55, 1.0 / 1.55, 1.02] {
            for i in 0..=50 {
                let cos_i = f64::from(i) / 50.0;
                let (reflectance, cos_t) = dielectric(cos_i, eta);
                let choose = |u| reflects(cos_i, eta, 1.0 / eta, u);
                assert!(choose(reflectance * (1.0 - 1e-9) - 1e-15).0);
                assert!(!choose(reflectance * (1.0 + 1e-9) + 1e-15).0 || reflectance == 1.0);
                assert!((choose(0.5).1 - cos_t).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        let dir = DVec3::new(0.6, 0.2, -0.7).normalize();
        let n = DVec3::Z;
        let (_, cos_t) = dielectric(-dir.dot(n), 1.55);
        let t = refract(dir, n, 1.55, cos_t);
        let sin_in = dir.cross(n).length();
        let sin_out = t.cross(n).length();
        assert!((sin_in - 1.55 * sin_out).abs() < 1e-12);
        assert!((reflect(dir, n) - DVec3::new(dir.x, dir.y, -dir.z)).length() < 1e-12);
    }
}
