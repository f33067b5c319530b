//! What of a groom varies over the skin.

use crate::io::Picture;
use crate::species::fields::VARIED;
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

/// Numbers that vary: each by a factor, but [`Self::Turn`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VaryWhat {
    /// Length.
    Length,
    /// Spread of lengths.
    LengthSpread,
    /// Diameter.
    Width,
    /// Spread of diameters.
    WidthSpread,
    /// Share of the hairs that grow.
    Density,
    /// Diameter of the stalk.
    Stalk,
    /// Where the hair widens.
    Shield,
    /// Where the tip begins to taper.
    Taper,
    /// Emergence angle.
    Tilt,
    /// Bend.
    Bend,
    /// What turns hair downhill.
    Gravity,
    /// Random deviation of direction.
    Stray,
    /// Random roll about the axis.
    Roll,
    /// Amplitude of the crimp.
    Crimp,
    /// Wavelength of the crimp.
    CrimpWavelength,
    /// Radius of curls.
    Curl,
    /// Way along the hair in one turn of a curl.
    CurlPitch,
    /// How far single hairs wander.
    Frizz,
    /// Length to which hairs are cut.
    Trim,
    /// Wetness.
    Wet,
    /// Pull toward the clump's center.
    Clump,
    /// Size of clumps.
    ClumpSize,
    /// Strength of combing curves and whorls.
    Comb,
    /// Degrees by which the lay is turned about the skin's normal, counter-clockwise.
    Turn,
}

impl VaryWhat {
    /// All of them, in the order in which they are declared.
    pub const ALL: [Self; 24] = [
        Self::Length,
        Self::LengthSpread,
        Self::Width,
        Self::WidthSpread,
        Self::Density,
        Self::Stalk,
        Self::Shield,
        Self::Taper,
        Self::Tilt,
        Self::Bend,
        Self::Gravity,
        Self::Stray,
        Self::Roll,
        Self::Crimp,
        Self::CrimpWavelength,
        Self::Curl,
        Self::CurlPitch,
        Self::Frizz,
        Self::Trim,
        Self::Wet,
        Self::Clump,
        Self::ClumpSize,
        Self::Comb,
        Self::Turn,
    ];

    /// As files name it.
    pub fn name(self) -> &'static str {
        VARIED[self as usize].name
    }

    /// The least and the largest factor, or angle in degrees.
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::Turn => [-360.0, 360.0],
            Self::Density | Self::Comb => [0.0, 1.0],
            Self::Bend => [-10.0, 10.0],
            // Waves and clumps of no size are none.
            Self::CrimpWavelength | Self::CurlPitch | Self::ClumpSize => [0.1, 10.0],
            _ => [0.0, 10.0],
        }
    }
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
