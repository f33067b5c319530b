//! From scene radiance to display values.

use crate::color::{Rgb, srgb_from_linear};
use glam::Vec3;

/// How bright scenes become pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// Linear up to one half, then a shoulder that comes to white smoothly:
    /// `1/2 + (1 - exp(1 - 2 x)) / 2`. Radiance 1 becomes 0.816, 2 becomes 0.975. Each channel by
    /// itself, so that bright highlights lose their color as they do on film.
    #[default]
    Shoulder,
    /// Cut at 1.
    Clip,
}

/// The view transform of a PNG: exposure, curve, sRGB encoding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewTransform {
    /// Stops: radiance is multiplied by 2 to this power.
    pub exposure_ev: f32,
    /// What happens to bright parts.
    pub curve: Curve,
}

impl ViewTransform {
    /// sRGB-encoded display values 0..1 of a linear Rec.709 radiance.
    pub fn display(&self, radiance: Rgb) -> Vec3 {
        let scaled = radiance.max(Rgb::ZERO) * self.exposure_ev.exp2();
        scaled.map(|x| {
            srgb_from_linear(match self.curve {
                Curve::Shoulder if x > 0.5 => 0.5 + 0.5 * (1.0 - (1.0 - 2.0 * x).exp()),
                Curve::Shoulder | Curve::Clip => x,
            })
        })
    }

    /// The same as bytes, rounded to nearest.
    pub fn bytes(&self, radiance: Rgb) -> [u8; 3] {
        let v = self.display(radiance) * 255.0 + 0.5;
        [v.x as u8, v.y as u8, v.z as u8]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_gray_is_plain_srgb_and_white_is_approached() {
        let view = ViewTransform::default();
        assert_eq!(view.bytes(Rgb::splat(0.18)), [118; 3]);
        assert_eq!(view.bytes(Rgb::splat(0.5)), [188; 3]);
        assert_eq!(view.bytes(Rgb::splat(100.0)), [255; 3]);
        let clip = ViewTransform {
            exposure_ev: 1.0,
            curve: Curve::Clip,
        };
        assert_eq!(clip.bytes(Rgb::splat(0.5)), [255; 3]);
        assert_eq!(clip.bytes(Rgb::splat(-1.0)), [0; 3]);
    }

    #[test]
    fn the_curve_rises_smoothly() {
        let view = ViewTransform::default();
        let values: Vec<f32> = (0..400)
            .map(|i| view.display(Rgb::splat(i as f32 / 100.0)).x)
            .collect();
        assert!(values.windows(2).all(|v| v[1] >= v[0]));
        // No corner where the shoulder begins.
        let slope = |i: usize| values[i + 1] - values[i];
        assert!((slope(49) - slope(50)).abs() < 0.1 * slope(49));
    }
}
