//! Colors for volumes.

use glam::Vec3;

/// Share of the light that one encounter scatters, for a deep volume to have a color: the `color` that
/// volume shaders ask for. With the color itself, fur would be darker than its strands.
///
/// Van de Hulst's reflectance of a half space (1980), `R = (1 - s) (1 - 0.139 s) / (1 + 1.17 s)` with
/// `s^2 = 1 - albedo` for a phase function without direction, solved for the albedo.
///
/// * `reflectance`: linear, 0 .. 1 in each channel; beyond is cut off.
pub fn scattering_albedo(reflectance: Vec3) -> Vec3 {
    Vec3::from_array(reflectance.to_array().map(|r| {
        let r = f64::from(r.clamp(0.0, 1.0));
        let b = 1.139 + 1.17 * r;
        let s = (b - (b * b - 4.0 * 0.139 * (1.0 - r)).sqrt()) / (2.0 * 0.139);
        (1.0 - s * s).clamp(0.0, 1.0) as f32
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deep_volume_has_the_color_again() {
        for r in [0.0f32, 0.02, 0.3, 0.8, 1.0] {
            let albedo = f64::from(scattering_albedo(Vec3::splat(r)).x);
            let s = (1.0 - albedo).sqrt();
            let back = (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
            assert!((back - f64::from(r)).abs() < 1e-3, "{r}: {back}");
            assert!(albedo >= f64::from(r));
        }
    }
}
