//! From scene radiance to display values.

use crate::color::{Rgb, srgb_from_linear};
use glam::Vec3;

/// How bright scenes become pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// Linear up to one half, then a shoulder that comes to white smoothly:
    /// `1/2 + (1 - exp(1 - 2 x)) / 2`. Radiance 1 becomes 0.816, 2 becomes 0.975. Each channel by
    /// itself, so that bright highlights lose their color as they do on film.
    #[default]
    Soft,
    /// Toe and shoulder of film by Hable 2010, each channel by itself; 5.6 becomes white. Less contrast in highlights,
    /// more in shadows, and darker: middle gray comes out at 0.13.
    Filmic,
    /// PBR Neutral of the Khronos Group (2024): color as authored up to 0.8, where diffuse reflection in white light ends,
    /// but for the 0.04 that a gloss adds; brighter ones are compressed with their hue and end in white.
    Neutral,
    /// Cut at 1.
    Srgb,
}

impl Look {
    /// Linear display values, to be cut to 0..1, of a radiance that is not negative.
    fn map(self, radiance: Rgb) -> Rgb {
        match self {
            Self::Soft => radiance.map(|x| match x > 0.5 {
                true => 0.5 + 0.5 * (1.0 - (1.0 - 2.0 * x).exp()),
                false => x,
            }),
            Self::Filmic => radiance.map(|x| filmic(FILMIC_BIAS * x) / filmic(FILMIC_WHITE)),
            Self::Neutral => neutral(radiance),
            Self::Srgb => radiance,
        }
    }
}

const FILMIC_BIAS: f32 = 2.0;
const FILMIC_WHITE: f32 = 11.2;

/// Hable, *Filmic tonemapping operators*, 2010 (after *Uncharted 2: HDR lighting*, GDC 2010), with its numbers.
fn filmic(x: f32) -> f32 {
    // Strength and angle of the shoulder's linear part, and the toe's strength, numerator and denominator.
    let [shoulder, linear, angle, toe, above, below] = [0.15, 0.50, 0.10, 0.20, 0.02, 0.30];
    let numerator = x * (shoulder * x + angle * linear) + toe * above;
    let denominator = x * (shoulder * x + linear) + toe * below;
    numerator / denominator - above / below
}

/// The Khronos PBR Neutral specification, <https://github.com/KhronosGroup/ToneMapping>.
fn neutral(color: Rgb) -> Rgb {
    const F90: f32 = 0.04;
    const START: f32 = 0.8 - F90;
    const DESATURATION: f32 = 0.15;
    let least = color.min_element();
    let offset = match least <= 2.0 * F90 {
        true => least - least * least / (4.0 * F90),
        false => F90,
    };
    let color = color - offset;
    let peak = color.max_element();
    if peak <= START {
        return color;
    }
    let rest = 1.0 - START;
    let compressed = 1.0 - rest * rest / (peak + 1.0 - 2.0 * START);
    let kept = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    Rgb::splat(compressed).lerp(color * (compressed / peak), kept)
}

/// The view transform of a PNG: exposure, look, sRGB encoding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewTransform {
    /// Stops: radiance is multiplied by 2 to this power.
    pub exposure_ev: f32,
    /// What happens to bright parts.
    pub look: Look,
}

impl ViewTransform {
    /// sRGB-encoded display values 0..1 of a linear Rec.709 radiance.
    pub fn display(&self, radiance: Rgb) -> Vec3 {
        let scaled = radiance.max(Rgb::ZERO) * self.exposure_ev.exp2();
        // What overflows is as bright as it gets.
        self.look
            .map(scaled.min(Rgb::splat(1e9)))
            .map(srgb_from_linear)
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

    const LOOKS: [Look; 4] = [Look::Soft, Look::Filmic, Look::Neutral, Look::Srgb];

    fn view(look: Look) -> ViewTransform {
        ViewTransform {
            exposure_ev: 0.0,
            look,
        }
    }

    #[test]
    fn middle_gray_is_plain_srgb_and_white_is_approached() {
        let view = ViewTransform::default();
        assert_eq!(view.bytes(Rgb::splat(0.18)), [118; 3]);
        assert_eq!(view.bytes(Rgb::splat(0.5)), [188; 3]);
        assert_eq!(view.bytes(Rgb::splat(100.0)), [255; 3]);
        let clip = ViewTransform {
            exposure_ev: 1.0,
            look: Look::Srgb,
        };
        assert_eq!(clip.bytes(Rgb::splat(0.5)), [255; 3]);
        assert_eq!(clip.bytes(Rgb::splat(-1.0)), [0; 3]);
    }

    #[test]
    fn looks_rise_from_black_to_white_without_a_corner() {
        for look in LOOKS {
            let gray = |i: usize| look.map(Rgb::splat(i as f32 / 100.0)).x;
            assert!(gray(0).abs() < 1e-6);
            for i in 1..1_000 {
                assert!(gray(i) >= gray(i - 1), "{look:?} at {i}");
                let (before, after) = (gray(i) - gray(i - 1), gray(i + 1) - gray(i));
                assert!((before - after).abs() < 0.0015, "{look:?} at {i}");
            }
            assert_eq!(view(look).bytes(Rgb::splat(f32::MAX)), [255; 3], "{look:?}");
        }
    }

    /// Values worked out by hand from the formulas.
    #[test]
    fn looks_go_through_their_fixed_points() {
        let filmic = |x: f32| Look::Filmic.map(Rgb::splat(x)).x;
        assert!((filmic(5.6) - 1.0).abs() < 1e-6);
        assert!((filmic(0.18) - 0.128_4).abs() < 1e-4, "{}", filmic(0.18));
        let neutral = |x: f32| Look::Neutral.map(Rgb::splat(x)).x;
        // Twice the gloss of 0.04 leaves 0.04, and what is above it has 0.04 taken off up to 0.8.
        for (from, to) in [(0.04, 0.01), (0.08, 0.04), (0.5, 0.46), (0.8, 0.76)] {
            assert!(
                (neutral(from) - to).abs() < 1e-6,
                "{from}: {}",
                neutral(from)
            );
        }
        assert!((neutral(1.04) - (1.0 - 0.0576 / 0.48)).abs() < 1e-6);
    }

    /// The hue, of three channels the place of the middle one between the others, stays under compression.
    #[test]
    fn the_neutral_look_keeps_hues() {
        let place = |c: Rgb| (c.y - c.z) / (c.x - c.z);
        let orange = Rgb::new(0.9, 0.4, 0.1);
        for bright in [0.5, 1.0, 3.0, 20.0] {
            let shown = Look::Neutral.map(orange * bright);
            assert!((place(shown) - place(orange)).abs() < 1e-4, "{bright}");
            assert!(shown.max_element() < 1.0 && shown.min_element() >= 0.0);
        }
        // A look that works on each channel by itself turns it to yellow.
        assert!(place(Look::Filmic.map(orange * 3.0)) > place(orange) + 0.1);
    }
}
