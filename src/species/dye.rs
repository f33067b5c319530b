//! Hair of a color that somebody asked for, in place of melanin.

use super::coat::CoatRecipe;
use super::model::{HairClass, PigmentBand, Species};
use crate::math::fresnel;
use serde::Serialize;

/// A color asked for, and the absorption that gives it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Dye {
    /// What a coat shows on the average in a white room, where it grows and from the side from which its skin looks
    /// best, when all of its hair is dyed so: linear Rec.709, each 0..=1.
    pub color: [f64; 3],
    /// Absorption of the cortex per micrometer for linear R, G, B: from a formula for smooth hair without
    /// a medulla, until [`match_colors`](crate::assembly::match_colors) has looked at the coat itself.
    pub absorption_per_um: [f64; 3],
}

impl Dye {
    /// A dye of a color; how strong it has to be is not known yet.
    pub(crate) fn new(color: [f64; 3]) -> Self {
        Self {
            color,
            absorption_per_um: [0.0; 3],
        }
    }
}

impl PigmentBand {
    /// Hair that absorbs so much, per micrometer for linear R, G, B, from tip to root.
    pub(crate) fn absorbing(absorption_per_um: [f64; 3]) -> Self {
        Self::without_melanin(Some(Dye {
            color: [0.0; 3],
            absorption_per_um,
        }))
    }

    /// Hair without melanin from tip to root.
    pub(crate) fn without_melanin(dye: Option<Dye>) -> Self {
        Self {
            to_mm: f64::INFINITY,
            softness_mm: 0.0,
            eumelanin: 0.0,
            pheomelanin: 0.0,
            dye,
        }
    }
}

impl Species {
    /// Dyes all of its hair, from tip to root and whatever its coat.
    ///
    /// * `color`: see [`Dye::color`].
    pub fn dye(&mut self, color: [f64; 3]) {
        self.coat = None;
        for class in &mut self.classes {
            class.pigment = vec![PigmentBand::without_melanin(Some(Dye::new(color)))];
        }
        let [r, g, b] = color;
        self.text
            .push_str(&format!("\n# All hair dyed: {r} {g} {b}\n"));
        self.estimate_dyes();
    }

    /// Whether a color was asked for anywhere.
    pub fn is_dyed(&self) -> bool {
        let mut bands = (0..self.classes.len()).flat_map(|class| self.pigments(class).concat());
        bands.any(|band| band.dye.is_some())
    }

    /// All dyes of its hair and its coat.
    pub(crate) fn dyes_mut(&mut self) -> impl Iterator<Item = &mut Dye> {
        fn of(bands: &mut [PigmentBand]) -> impl Iterator<Item = &mut Dye> {
            bands.iter_mut().filter_map(|band| band.dye.as_mut())
        }
        let Self { classes, coat, .. } = self;
        let zones = coat.iter_mut().flat_map(|CoatRecipe { zones, .. }| zones);
        let painted = zones.flat_map(|zone| [&mut zone.guard, &mut zone.under]);
        let bands = classes.iter_mut().map(|HairClass { pigment, .. }| pigment);
        bands.chain(painted).flat_map(|bands| of(bands))
    }

    /// Gives every dye the strength that it needs on smooth hair as thick as that of the first class.
    pub(crate) fn estimate_dyes(&mut self) {
        let radius_um = 0.5 * self.classes[0].groom.diameter_um;
        for dye in self.dyes_mut() {
            dye.absorption_per_um = dye.color.map(|c| depth_of(c) / radius_um);
        }
    }
}

/// Index of refraction of hair.
const ETA: f64 = 1.55;

/// Mean cosine of the light that one hair scatters on: most goes through.
const MEAN_COSINE: f64 = 0.5;

/// Offsets across the hair at which light enters.
const OFFSETS: usize = 16;

/// Most absorption per radius that is looked for: nothing gets darker beyond.
const DEEPEST: f64 = 40.0;

/// Reflectance of a deep coat of smooth hairs without a medulla.
///
/// * `depth`: absorption of the hair, per radius.
pub(crate) fn coat_color(depth: f64) -> f64 {
    coat(hair(depth))
}

/// Absorption per radius at which [`coat_color`] has a value; the nearest where it never has.
fn depth_of(color: f64) -> f64 {
    let (mut pale, mut dark) = (0.0, DEEPEST);
    for _ in 0..60 {
        let middle = 0.5 * (pale + dark);
        if coat_color(middle) > color {
            pale = middle;
        } else {
            dark = middle;
        }
    }
    0.5 * (pale + dark)
}

/// Share of light that a clear-walled hair of some absorption per radius scatters, lit from the side.
fn hair(depth: f64) -> f64 {
    let mean: f64 = (0..OFFSETS)
        .map(|i| {
            let h = (i as f64 + 0.5) / OFFSETS as f64;
            let (f, _) = fresnel::dielectric((1.0 - h * h).sqrt(), ETA);
            let cos_inside = (1.0 - (h / ETA).powi(2)).sqrt();
            let t = (-2.0 * depth * cos_inside).exp();
            f + (1.0 - f).powi(2) * t / (1.0 - f * t)
        })
        .sum();
    mean / OFFSETS as f64
}

/// Reflectance of a deep coat of hairs that scatter a share of the light: van de Hulst's formula for a
/// half space (1980).
fn coat(albedo: f64) -> f64 {
    let s = ((1.0 - albedo) / (1.0 - albedo * MEAN_COSINE))
        .max(0.0)
        .sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clear_hair_is_white_and_dark_hair_dark() {
        assert!((hair(0.0) - 1.0).abs() < 1e-12);
        assert!((coat(1.0) - 1.0).abs() < 1e-12);
        let mut last = 1.0;
        for depth in [0.01, 0.1, 0.5, 2.0, 10.0] {
            let color = coat_color(depth);
            assert!(color < last && color > 0.0, "{depth}: {color}");
            last = color;
        }
        assert!(last < 0.02);
    }

    #[test]
    fn the_formula_is_turned_around() {
        for color in [0.03, 0.1, 0.4, 0.9] {
            assert!((coat_color(depth_of(color)) - color).abs() < 1e-9);
        }
        assert_eq!(depth_of(1.0), 0.5f64.powi(61) * DEEPEST);
        assert!(depth_of(0.0) > 0.99 * DEEPEST);
    }
}
