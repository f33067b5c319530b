//! Density as color: from near black over purple and orange to pale yellow, of steadily rising
//! lightness, so that it also reads in gray and for color-blind eyes.

use glam::Vec3;

/// Stops in OKLab (Ottosson 2020): lightness rises evenly, hue turns from blue to yellow.
const STOPS: [[f32; 3]; 7] = [
    [0.12, 0.00, -0.03],
    [0.26, 0.05, -0.11],
    [0.40, 0.13, -0.09],
    [0.54, 0.18, 0.02],
    [0.68, 0.13, 0.11],
    [0.82, 0.03, 0.13],
    [0.96, -0.02, 0.07],
];

/// The sRGB color of a value in 0..1.
pub(super) fn color(value: f32) -> Vec3 {
    let x = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let i = (x as usize).min(STOPS.len() - 2);
    let lab = Vec3::from(STOPS[i]).lerp(Vec3::from(STOPS[i + 1]), x - i as f32);
    srgb_of_oklab(lab)
}

/// The sRGB color of a signed value in -1..1: blue below, near white at zero, red above. Both ends are
/// equally dark, so that in gray the size of a difference is left.
pub(super) fn diverging(value: f32) -> Vec3 {
    const ZERO: Vec3 = Vec3::new(0.97, 0.0, 0.0);
    const ABOVE: Vec3 = Vec3::new(0.42, 0.16, 0.08);
    const BELOW: Vec3 = Vec3::new(0.42, -0.03, -0.16);
    let end = if value < 0.0 { BELOW } else { ABOVE };
    srgb_of_oklab(ZERO.lerp(end, value.abs().min(1.0)))
}

fn srgb_of_oklab(lab: Vec3) -> Vec3 {
    let (l, a, b) = (lab.x, lab.y, lab.z);
    let cone = |ka: f32, kb: f32| (l + ka * a + kb * b).powi(3);
    let (long, medium, short) = (
        cone(0.396_337_78, 0.215_803_76),
        cone(-0.105_561_346, -0.063_854_17),
        cone(-0.089_484_18, -1.291_485_5),
    );
    let linear = Vec3::new(
        4.076_741_7 * long - 3.307_711_6 * medium + 0.230_969_93 * short,
        -1.268_438 * long + 2.609_757_4 * medium - 0.341_319_38 * short,
        -0.004_196_086_3 * long - 0.703_418_6 * medium + 1.707_614_7 * short,
    );
    linear.map(crate::color::srgb_from_linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_rises_all_the_way() {
        let luma = |v: f32| {
            let c = color(v).map(crate::color::linear_from_srgb);
            crate::color::luminance(c)
        };
        for i in 0..100 {
            let v = i as f32 / 100.0;
            assert!(luma(v + 0.01) > luma(v), "{v}");
        }
        assert!(luma(0.0) < 0.01 && luma(1.0) > 0.8);
    }
}
