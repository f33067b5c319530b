//! Color along a strand, without a bake: what a coat of such hair looks like from afar.

use super::look::{ClassLook, HairLook};
use crate::bsdf::{Zone, bracket_zone};
use crate::groom::Groom;
use crate::species::{HairClass, PigmentBand, Species, coat_color};
use glam::Vec3;

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
                        color: Vec3::from_array(match &band.dye {
                            Some(dye) => dye.color.map(|c| c as f32),
                            None => depth.map(|d| coat_color(d) as f32),
                        }),
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
