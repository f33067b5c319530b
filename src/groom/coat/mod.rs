//! Which pigment each hair has: layers of a recipe painted over the skin, and a hair's choice.
//!
//! Every point of a net over the skin has a share for each zone. A hair takes one zone, at random with
//! the shares at its root as probabilities: where two colors meet, hairs of both stand mixed.

mod layers;
mod net;
#[cfg(test)]
mod tests;
mod turing;

use super::GroomError;
use super::follicle::Surface;
use super::noise::Symmetry;
use crate::progress::{Cancel, Silent};
use crate::sampling::hash64;
use crate::skin::{Mirror, Skin};
use crate::species::{CoatLayer, CoatPattern, CoatRecipe, MAX_ZONES, Species};
use glam::Vec3;
use net::Net;
use rayon::prelude::*;
use turing::POINTS_A_WAVE;

/// Most points of a net; larger skins or finer patterns get a coarser one, which is said.
const MOST_POINTS: f64 = 250_000.0;
/// Least points, so that borders are where they should be.
const LEAST_POINTS: f64 = 6_000.0;

/// How strongly a thick coat darkens with the root of its pigment, and how much light gets to its depth.
const DEPTH: f64 = 1.6;
const SHADE: f64 = 0.6;

/// Shares of the zones at each point; zone 0 is the species' own.
type Shares = [f32; MAX_ZONES + 1];

/// A painted skin.
pub(super) struct Coat {
    net: Net,
    shares: Vec<Shares>,
    /// Of a body with sides that are mirror images: where one of them looks up what it is painted with.
    mirror: Option<Mirror>,
    /// Factor on hair length of each zone.
    hair: Vec<f32>,
    seed: u64,
    /// What could not be painted, one sentence each.
    pub(super) warnings: Vec<String>,
}

impl Coat {
    /// Paints a skin.
    ///
    /// * `symmetry`: of the patterns. * `seed`: of everything random.
    ///
    /// # Errors
    /// A skin without area, or canceled.
    pub(super) fn paint(
        skin: &Skin,
        recipe: &CoatRecipe,
        symmetry: Symmetry<'_>,
        seed: u64,
        cancel: &Cancel,
    ) -> Result<Self, GroomError> {
        let surface = Surface::even(skin)?;
        let scale = scale_of(skin, recipe);
        let mut warnings = Vec::new();
        let (count, spacing) = points(surface.weighted_area(), recipe, scale, &mut warnings);
        let seed = hash64(seed ^ 0x636f_6174);
        let follicles = surface.scatter(seed, count, &Silent, cancel)?.follicles;
        let net = Net::new(&surface, &follicles, spacing);
        let painter = layers::Painter::new(skin, &surface, &follicles, &net, scale, symmetry, seed);
        let shares = painter.paint(recipe, &mut warnings, cancel)?;
        let zones = recipe.zones.iter().map(|z| z.hair);
        // What is painted by hand stays where it was painted.
        let is_map = |layer: &CoatLayer| matches!(layer.pattern, CoatPattern::Map { .. });
        let exact = symmetry.amount >= 1.0 && !recipe.layers.iter().any(is_map);
        Ok(Self {
            mirror: symmetry.mirror.filter(|_| exact).cloned(),
            shares,
            hair: std::iter::once(1.0)
                .chain(zones)
                .map(|h| (h * recipe.hair) as f32)
                .collect(),
            net,
            seed,
            warnings,
        })
    }

    /// What shines through a thin coat at each vertex of the skin: a factor on the species' skin color, as
    /// dark or pale as the depth of the painted hair.
    pub(super) fn skin_tint(&self, skin: &Skin, species: &Species) -> Vec<Vec3> {
        let own = Vec3::from_array(species.skin_color.map(|c| c as f32)).max(Vec3::splat(0.01));
        let pigments = species.pigments(0);
        let deep = |zone: usize| {
            let root = pigments[zone][pigments[zone].len() - 1];
            // Light that returns from many hairs goes with the root of their absorption; the depth of
            // a coat is in shade.
            let radius = crate::species::REFERENCE_RADIUS_UM;
            let returned = |a: f64| SHADE * (-DEPTH * (a * radius).sqrt()).exp();
            Vec3::from_array(root.absorption_per_um().map(|a| returned(a) as f32)) / own
        };
        let tints: Vec<Vec3> = (0..pigments.len())
            .map(|zone| if zone == 0 { Vec3::ONE } else { deep(zone) })
            .collect();
        let at = |near: &mut Vec<(u32, f32)>, i: usize| {
            let mut sum = Vec3::ZERO;
            let mut all = 0.0;
            self.weights(skin.positions[i], skin.normals[i], near);
            for &(point, weight) in near.iter() {
                for (tint, share) in tints.iter().zip(&self.shares[point as usize]) {
                    sum += *tint * (weight * share);
                    all += weight * share;
                }
            }
            if all > 0.0 { sum / all } else { Vec3::ONE }
        };
        let vertices = (0..skin.positions.len()).into_par_iter();
        vertices.map_with(Vec::new(), at).collect()
    }

    /// Points that say how a place is painted, with weights.
    fn weights(&self, position: Vec3, normal: Vec3, near: &mut Vec<(u32, f32)>) {
        let mirror = self.mirror.as_ref();
        if let Some((p, n)) = mirror.and_then(|mirror| mirror.fold(position, normal)) {
            self.net.weights(p, n, near);
            if !near.is_empty() {
                return;
            }
        }
        self.net.weights(position, normal, near);
    }

    /// The zone of a hair, and the factor on its length.
    ///
    /// * `id`: of the strand, the same for any density. * `near`: memory to be used.
    pub(super) fn choose(
        &self,
        id: u32,
        position: Vec3,
        normal: Vec3,
        near: &mut Vec<(u32, f32)>,
    ) -> (u8, f32) {
        let mut shares = [0.0; MAX_ZONES + 1];
        self.weights(position, normal, near);
        for &(point, weight) in near.iter() {
            for (sum, share) in shares.iter_mut().zip(&self.shares[point as usize]) {
                *sum += weight * share;
            }
        }
        let total: f32 = shares.iter().sum();
        let luck = (hash64(self.seed ^ hash64(u64::from(id) + 1)) >> 40) as f32;
        let mut left = luck / (1u64 << 24) as f32 * total;
        for (zone, &share) in shares.iter().enumerate() {
            if left < share {
                return (zone as u8, self.hair[zone]);
            }
            left -= share;
        }
        (0, self.hair[0])
    }

    /// What [`Coat::choose`] gives for the length at least.
    pub(super) fn least_hair(&self) -> f32 {
        self.hair.iter().copied().fold(f32::INFINITY, f32::min)
    }
}

/// Meters of the skin in a millimeter of the recipe.
fn scale_of(skin: &Skin, recipe: &CoatRecipe) -> f32 {
    match skin.body {
        Some(length) if recipe.body_mm > 0.0 => length / recipe.body_mm as f32,
        _ => 1e-3,
    }
}

/// How many points a recipe needs on an area, and their distance.
fn points(area: f64, recipe: &CoatRecipe, scale: f32, warnings: &mut Vec<String>) -> (usize, f32) {
    // Points in a hexagonal packing have sqrt(3)/2 of their distance squared each.
    let spacing_of = |count: f64| (area / count / 0.866).sqrt();
    let finest = recipe
        .layers
        .iter()
        .filter_map(|layer| match &layer.pattern {
            CoatPattern::Turing(turing) => Some(turing.wavelength_mm * turing.fine),
            CoatPattern::Rosettes { spots, .. } => {
                Some(layers::FRAGMENT * spots.wavelength_mm * spots.fine)
            }
            CoatPattern::Patches { size_mm, .. } => Some(0.5 * size_mm),
            CoatPattern::Plain | CoatPattern::Map { .. } => None,
        });
    let finest = finest.fold(f64::INFINITY, f64::min);
    let wanted = finest * f64::from(scale) / f64::from(POINTS_A_WAVE);
    let mut count = (area / (0.866 * wanted * wanted)).max(LEAST_POINTS);
    if count > MOST_POINTS {
        let least = spacing_of(MOST_POINTS) * f64::from(POINTS_A_WAVE);
        warnings.push(format!(
            "the finest pattern of the coat, {:.3} m on this skin, is coarser than asked for: {least:.3} m \
             (a skin of {area:.2} m2 has {MOST_POINTS} points)",
            finest * f64::from(scale),
        ));
    }
    let is_map = |layer: &CoatLayer| matches!(layer.pattern, CoatPattern::Map { .. });
    if count > MOST_POINTS || recipe.layers.iter().any(is_map) {
        // A picture has any detail: as fine as the net goes.
        count = MOST_POINTS;
    }
    (count as usize, spacing_of(count) as f32)
}
