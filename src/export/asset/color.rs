//! Color along a strand, without a bake: what a coat of such hair looks like from afar.

use super::look::{ClassLook, HairLook};
use crate::bsdf::{Zone, bracket_zone};
use crate::groom::Groom;
use crate::math::fresnel;
use crate::species::{HairClass, PigmentBand, Species};
use glam::Vec3;

/// Index of refraction of hair.
const ETA: f64 = 1.55;

/// Mean cosine of the light that one hair scatters on: most goes through.
const MEAN_COSINE: f64 = 0.5;

/// Offsets across the hair at which light enters.
const OFFSETS: usize = 16;

/// Pigment of one class in one part of a coat, from the tip to the root.
#[derive(Clone, Debug)]
pub(super) struct Zones {
    edges: Vec<Zone>,
    /// What each zone has.
    pub(super) values: Vec<Dye>,
}

/// What a zone of pigment gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dye {
    /// Color of a coat of such hair, linear Rec.709.
    pub(super) color: Vec3,
    /// Concentrations of eumelanin and pheomelanin, and nothing.
    pub(super) melanin: Vec3,
    /// Absorption per radius, for materials.
    pub(super) absorption: Vec3,
}

impl Zones {
    /// * `look`: the fitted absorption of each zone; that of the pigment if there is none.
    pub(super) fn new(
        class: &HairClass,
        pigment: &[PigmentBand],
        look: Option<&[HairLook]>,
    ) -> Self {
        let radius_um = 0.5 * class.groom.diameter_um;
        Self {
            edges: (pigment.iter())
                .map(|band| Zone {
                    to_mm: band.to_mm as f32,
                    softness_mm: band.softness_mm as f32,
                })
                .collect(),
            values: (pigment.iter().enumerate())
                .map(|(zone, band)| {
                    let depth = band.absorption_per_um().map(|a| a * radius_um);
                    Dye {
                        color: Vec3::from_array(depth.map(|d| coat(hair(d)) as f32)),
                        melanin: Vec3::new(band.eumelanin as f32, band.pheomelanin as f32, 0.0),
                        absorption: Vec3::from_array(
                            look.and_then(|look| look.get(zone))
                                .map_or(depth, |look| look.absorption)
                                .map(|a| a as f32),
                        ),
                    }
                })
                .collect(),
        }
    }

    /// Which zone is the longest on a hair of some length.
    pub(super) fn longest(&self, length_mm: f32) -> usize {
        let mut from = 0.0;
        let mut best = (0, 0.0);
        for (zone, edge) in self.edges.iter().enumerate() {
            let to = edge.to_mm.min(length_mm);
            if to - from > best.1 {
                best = (zone, to - from);
            }
            from = to.max(from);
        }
        best.0
    }

    /// The value at a distance from the tip.
    fn at(&self, tip_mm: f32, of: impl Fn(&Dye) -> Vec3) -> Vec3 {
        let (this, next, share) = bracket_zone(&self.edges, tip_mm);
        of(&self.values[this]).lerp(of(&self.values[next]), share)
    }

    /// Appends the values at the control points of a strand.
    pub(super) fn along(
        &self,
        groom: &Groom,
        strand: usize,
        of: impl Fn(&Dye) -> Vec3,
        out: &mut Vec<Vec3>,
    ) {
        let points = groom.strand(strand);
        if self.values.len() == 1 {
            out.extend(std::iter::repeat_n(of(&self.values[0]), points.len()));
            return;
        }
        let mut tip_mm = 1e3 * groom.length[strand];
        for (i, point) in points.iter().enumerate() {
            if i > 0 {
                tip_mm -= 1e3 * point.distance(points[i - 1]);
            }
            out.push(self.at(tip_mm.max(0.0), &of));
        }
    }
}

/// Pigment of one class in every part of a coat, that of the species itself first; never empty.
#[derive(Clone, Debug)]
pub(super) struct Coats(pub(super) Vec<Zones>);

impl Coats {
    /// * `class`: index of the hair class.
    pub(super) fn new(species: &Species, class: usize, look: Option<&ClassLook>) -> Self {
        let hair = &species.classes[class];
        let parts = species.pigments(class).into_iter().enumerate();
        Self(
            parts
                .map(|(part, pigment)| {
                    let look = look.and_then(|look| look.parts.get(part));
                    Zones::new(hair, pigment, look.map(Vec::as_slice))
                })
                .collect(),
        )
    }

    /// Whether all hair has the same pigment from root to tip.
    pub(super) fn is_even(&self) -> bool {
        let first = self.0[0].values[0];
        let mut all = self.0.iter().flat_map(|zones| &zones.values);
        all.all(|dye| *dye == first)
    }

    /// As [`Zones::along`], of the part of the coat that the strand belongs to.
    pub(super) fn along(
        &self,
        groom: &Groom,
        strand: usize,
        of: impl Fn(&Dye) -> Vec3,
        out: &mut Vec<Vec3>,
    ) {
        let part = groom.coat.get(strand).map_or(0, |&part| usize::from(part));
        self.0[part.min(self.0.len() - 1)].along(groom, strand, of, out);
    }
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
            let color = coat(hair(depth));
            assert!(color < last && color > 0.0, "{depth}: {color}");
            last = color;
        }
        assert!(last < 0.02);
    }
}
