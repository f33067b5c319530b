//! What of a groom varies over the skin.

use crate::io::Picture;
use serde::Serialize;
use std::sync::Arc;

/// A number of the groom that is not the same everywhere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Vary {
    /// Which number.
    pub what: VaryWhat,
    /// What it varies with.
    pub by: VaryBy,
    /// Factor, or angle of a turn in degrees, where the map is black or the noise lowest.
    pub from: f64,
    /// Where the map is white or the noise highest.
    pub to: f64,
}

/// Numbers that vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VaryWhat {
    /// Factor on the length, 0..10.
    Length,
    /// Factor on the diameter, 0..10.
    Width,
    /// Share of the hairs that grow, 0..1.
    Density,
    /// Factor on the radius of curls, 0..10.
    Curl,
    /// Factor on the pull toward the clump's center, 0..10.
    Clump,
    /// Factor on how far single hairs wander, 0..10.
    Frizz,
    /// Factor on the emergence angle, 0..10.
    Tilt,
    /// Factor on the strength of combing curves and whorls, 0..1.
    Comb,
    /// Degrees by which the lay is turned about the skin's normal, counter-clockwise, -360..360.
    Turn,
}

impl VaryWhat {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Length,
        Self::Width,
        Self::Density,
        Self::Curl,
        Self::Clump,
        Self::Frizz,
        Self::Tilt,
        Self::Comb,
        Self::Turn,
    ];
}

/// What a number varies with: a value 0..1 at every place of the skin.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VaryBy {
    /// A picture over the texture coordinates, clamped to 0..1.
    Map {
        /// What the file holds, linear.
        #[serde(skip)]
        picture: Arc<Picture>,
    },
    /// Fractal noise.
    Noise {
        /// Size of its largest features, millimeters.
        size_mm: f64,
        /// How much finer features add, 0..1.
        rough: f64,
        /// Other numbers give other noise.
        seed: u64,
    },
}
