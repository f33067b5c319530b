//! Linear Rec.709 color and the view transform to sRGB.

use glam::Vec3;

/// Linear Rec.709 radiance, reflectance or throughput.
pub type Rgb = Vec3;

/// Rec.709 luminance of a linear color.
pub fn luminance(rgb: Rgb) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// sRGB opto-electronic transfer (IEC 61966-2-1) of a linear value, clamped to `[0, 1]`.
pub fn srgb_from_linear(value: f32) -> f32 {
    let v = value.clamp(0.0, 1.0);
    if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    }
}

/// Inverse of [`srgb_from_linear`] on `[0, 1]`.
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}
