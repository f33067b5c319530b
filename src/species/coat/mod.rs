//! Coat patterns as data: which hairs of a body have which pigment.
//!
//! A recipe is a small TOML file; those of well-known animals are built in. Zones hold pigment, layers
//! paint hairs with them one over the other: everywhere or in a pattern, within limits on the body.

mod fields;
mod library;
mod read;

pub(crate) use fields::{COAT, COATS};
pub use library::{COAT_LIBRARY, coat_names};
pub(crate) use read::coat_of;

use super::model::PigmentBand;
use crate::io::Picture;
use crate::skin::Landmark;
use serde::Serialize;
use std::sync::Arc;

/// Most zones of a recipe.
pub const MAX_ZONES: usize = 8;

/// A coat of several colors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoatRecipe {
    /// Name of a built-in recipe or of the file without its extension, `leopard`.
    pub name: String,
    /// What it looks like, a sentence or two.
    pub summary: String,
    /// Length of the body, nose to root of the tail, for which millimeters are meant; on built-in bodies
    /// of another size the pattern is scaled. 0 where millimeters are to be taken as they are.
    pub body_mm: f64,
    /// Factor on the length of all hairs, 0.05..3.
    pub hair: f64,
    /// Pigments beside the species' own.
    pub zones: Vec<CoatZone>,
    /// In the order in which they are painted.
    pub layers: Vec<CoatLayer>,
}

/// Hairs of one pigment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoatZone {
    /// Name, unique in the recipe.
    pub name: String,
    /// Bands of the most visible class of hair; empty for the species' own.
    pub guard: Vec<PigmentBand>,
    /// Bands of all other classes; empty for the species' own.
    pub under: Vec<PigmentBand>,
    /// Factor on the length of its hairs, 0.05..3.
    pub hair: f64,
}

/// What one layer paints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoatLayer {
    /// The pigment: 0 the species' own, else one more than the index of the zone.
    pub zone: usize,
    /// Which hairs.
    pub pattern: CoatPattern,
    /// Share of these hairs that are painted, 0..1.
    pub strength: f64,
    /// Width of the pattern's borders as share of its whole range, 0 sharp .. 1.
    pub edge: f64,
    /// Other numbers give another pattern of the same kind.
    pub seed: u64,
    /// Where on the body; none for everywhere.
    pub limits: Vec<CoatLimit>,
}

/// Patterns of a layer. Lengths in millimeters.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CoatPattern {
    /// All hairs.
    Plain,
    /// Spots, stripes or a net by reaction and diffusion.
    Turing(Turing),
    /// Rosettes of spots by reaction and diffusion in two stages.
    Rosettes {
        /// The spots that open into rosettes.
        spots: Turing,
        /// Whether what the rings enclose is painted, not the rings.
        inside: bool,
    },
    /// Irregular patches by noise.
    Patches {
        /// Mean distance of patches.
        size_mm: f64,
        /// Share of the skin painted, 0..1.
        cover: f64,
        /// How ragged their borders are, 0 smooth .. 1.
        rough: f64,
    },
    /// Where a picture is bright, by texture coordinates.
    Map {
        /// What the file holds, linear.
        #[serde(skip)]
        picture: Arc<Picture>,
    },
}

/// A pattern of a local activator and a lateral inhibitor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turing {
    /// Distance of neighboring spots or stripes.
    pub wavelength_mm: f64,
    /// -1 small round spots, 0 stripes, 1 a net round unpainted spots.
    pub balance: f64,
    /// How strongly stripes keep to their direction, 0 any way .. 1.
    pub order: f64,
    /// The direction of stripes.
    pub lay: Lay,
    /// Share of the skin painted, 0..1; as the pattern has it if not given.
    pub cover: Option<f64>,
    /// Wavelength at the ends of the body (nose, ears, paws, tip of the tail) over that of the trunk.
    pub fine: f64,
}

/// The direction of stripes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lay {
    /// Across the lay of the hair: rings on legs and tail.
    Across,
    /// Along the lay of the hair.
    Along,
}

/// A limit of a layer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoatLimit {
    /// Where.
    pub extent: Extent,
    /// How it joins with the limits before it.
    pub join: Join,
}

/// How limits join.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Join {
    /// Only within it.
    And,
    /// Within it too.
    Or,
    /// Only outside of it.
    Not,
}

/// A part of the body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// Around a landmark, by the way along the skin.
    Near {
        /// The landmark.
        landmark: Landmark,
        /// Distance of the border.
        within_mm: f64,
        /// Width of the border.
        soft_mm: f64,
        /// How far the border strays either way.
        ragged_mm: f64,
    },
    /// Skin that faces a direction.
    Facing {
        /// The direction.
        side: Side,
        /// Cosine of the angle to it where the limit begins.
        from: f64,
        /// Cosine where it is fully in.
        to: f64,
    },
}

/// Directions of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The sky.
    Up,
    /// The ground.
    Down,
    /// Head first.
    Front,
    /// Toward the tail.
    Back,
}

impl CoatRecipe {
    /// Names of the parts of the coat, the species' own pigment first.
    pub fn parts(&self) -> Vec<String> {
        let own = std::iter::once("own".to_owned());
        own.chain(self.zones.iter().map(|z| z.name.clone()))
            .collect()
    }
}
