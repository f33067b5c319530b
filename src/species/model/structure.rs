//! The micro-structure of a fiber.

use super::FiberMesh;
use crate::species::{CuticlePattern, Materials};
use serde::Serialize;

/// Cross-section, surface and interior of a fiber.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Structure {
    /// Diameter of the circle of equal area, micrometers, 1..1000: for an ellipse the geometric mean of
    /// its axes.
    pub diameter_um: f64,
    /// Major over minor axis of the section, 1..5.
    pub aspect: f64,
    /// Shape of the section.
    pub section: Section,
    /// Turns of the section about the axis, per centimeter; positive counterclockwise seen from the
    /// tip.
    pub twist_turns_per_cm: f64,
    /// Refractive index of cuticle and cortex, 1..3.
    pub ior: f64,
    /// The scales outside.
    pub cuticle: Cuticle,
    /// What lies between cuticle and medulla.
    pub cortex: Cortex,
    /// The core.
    pub medulla: Medulla,
    /// What the parts are made of, where that is not plain keratin and air.
    pub materials: Materials,
    /// A fiber modeled elsewhere: it takes the place of section, scales and voids, whose materials
    /// are kept. Diameter and aspect are those of its box.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<FiberMesh>,
}

/// Shape of a cross-section; size and aspect are those of the [`Structure`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Section {
    /// Most hair.
    #[default]
    Ellipse,
    /// Oblong with flat sides: `|x/a|^q + |y/b|^q = 1` (rat).
    Superellipse {
        /// The exponent q, 2 (ellipse) .. 8 (box).
        squareness: f64,
    },
    /// Cassini oval, waisted beyond an aspect of 1.73 (rabbit, hare).
    DumbBell,
    /// An ellipse bent along its major axis: `y + bend x^2 / a` (mouse).
    ConcavoConvex {
        /// Rise at the ends of the major axis over the half axis a, 0..0.6.
        bend: f64,
    },
    /// An ellipse with a dent in one flat side.
    Bean {
        /// Depth of the dent over the radius there, 0..0.4.
        dent: f64,
    },
}

/// Pigment and air between cuticle and medulla.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cortex {
    /// How the pigment leans: its density is `1 + b (1 - 2u)`, u from 0 at the medulla to 1 at the
    /// cuticle; -1 (all toward the cuticle) .. 1 (toward the medulla), 0 even.
    pub toward_medulla: f64,
    /// Share of the cortex under the cuticle without pigment, 0..0.9.
    pub clear_rim: f64,
    /// Streaks of pigment along the axis: deviation of the logarithm of the density, 0..2.
    pub streaks: f64,
    /// Cortical fusi, slender slits of air, per millimeter of hair, 0..1000.
    pub fusi_per_mm: f64,
}

/// Scale pattern of the cuticle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cuticle {
    /// Shape and arrangement of the scales.
    #[serde(flatten)]
    pub pattern: CuticlePattern,
    /// Axial distance between scale margins, micrometers.
    pub pitch_um: f64,
    /// Height of the free edge, micrometers; the tilt is `atan(height / pitch)`.
    pub height_um: f64,
    /// Scales (or waves) once round the fiber.
    pub around: u32,
    /// Random variation of pitch, height and position, 0..1; 1 is the natural amount.
    pub jitter: f64,
    /// Fine shape of the free edges.
    pub margin: Margin,
    /// Share of scales that are worn away, 0 near the root .. 0.3 at old tips, at most 0.9.
    pub wear: f64,
    /// Share of scales that damage has lifted by a further 5 to 15 degrees, 0..0.5.
    pub lifted: f64,
    /// GGX roughness (alpha) of the scale faces, 0 smooth .. 1.
    pub roughness: f64,
    /// GGX roughness (alpha) of the risers at the free edges; they are below the wavelength in size
    /// and scatter rather than mirror.
    pub riser_roughness: f64,
}

/// Fine shape of a scale's free edge, added to what the pattern gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Margin {
    /// As the pattern gives it.
    #[default]
    Smooth,
    /// Shallow pointed notches.
    Crenate,
    /// Deeper rounded ripples.
    Rippled,
    /// Round lobes.
    Scalloped,
    /// Teeth.
    Dentate,
}

/// The core of the fiber.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Medulla {
    /// Medullary index: medulla diameter over fiber diameter, 0..0.95. 0 with `MedullaKind::None`.
    pub ratio: f64,
    /// What fills it.
    pub kind: MedullaKind,
    /// Whether it runs through.
    pub continuity: Continuity,
    /// Refractive index of the voids, 1.0003 for air, 1.33 for a flooded medulla.
    pub void_ior: f64,
    /// Pigment in the medulla's walls relative to the cortex, 0..10.
    pub pigment: f64,
}

/// Whether a medulla of any kind runs through the hair or comes in pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Continuity {
    /// Without gaps.
    #[default]
    Continuous,
    /// Gaps shorter than the pieces: about 40 um after every 60 um.
    Interrupted,
    /// Isolated pieces: about 60 um every 260 um.
    Fragmentary,
}

/// The medulla types; sizes in micrometers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MedullaKind {
    /// No medulla.
    None,
    /// Uniserial ladder: one void a rung.
    Ladder {
        /// Distance between rungs.
        pitch_um: f64,
        /// Wall between two voids.
        septum_um: f64,
    },
    /// Multiserial ladder: columns of cells, rungs aligned across them ("corn cob").
    Multiserial {
        /// Width of a column.
        cell_um: f64,
        /// Distance between rungs.
        pitch_um: f64,
        /// Wall between two cells.
        septum_um: f64,
    },
    /// Close-packed polyhedra that fill almost the whole shaft.
    Lattice {
        /// Mean width of a cell.
        cell_um: f64,
        /// Wall between two cells.
        wall_um: f64,
    },
    /// Wedge discs, thick left and right by turns, with one air channel winding between them.
    SChannel {
        /// Distance between discs.
        pitch_um: f64,
    },
    /// Rows of flat ovals merged into H, X and Y shapes, in a scalloped outline.
    Cloisonne {
        /// Ovals across.
        columns: u32,
        /// Distance between rows.
        pitch_um: f64,
        /// Height of an oval.
        height_um: f64,
    },
    /// Rows of flat cells in a tube with bumps at every row.
    TireTread {
        /// Distance between rows.
        pitch_um: f64,
        /// Width of a cell.
        cell_um: f64,
        /// Wall between two cells.
        septum_um: f64,
    },
    /// One column of globules of random size, a film of air round each.
    Globules {
        /// Mean distance between globules over the medulla's diameter, 0.15 .. 3; below the
        /// size of a globule they are discs.
        spacing: f64,
        /// Thickness of the film.
        film_um: f64,
    },
    /// No cells seen: fine bubbles, below the resolution of the light microscope.
    Amorphous {
        /// Median radius of a bubble.
        radius_um: f64,
        /// Share of the medulla's volume that is air, 0..0.5.
        air_fraction: f64,
    },
    /// Hard-core spheres of air, log-normal in size.
    Froth {
        /// Median radius of a void.
        radius_um: f64,
        /// Standard deviation of the logarithm of the radius.
        radius_sigma: f64,
        /// Share of the medulla's volume that is air, 0..0.5.
        air_fraction: f64,
    },
    /// A homogeneous scattering medium.
    Medium {
        /// Scattering coefficient, per micrometer.
        scattering_per_um: f64,
        /// Henyey-Greenstein asymmetry, -0.99..0.99.
        asymmetry: f64,
    },
}

/// A bare smooth cylinder as thick as a human hair, with even pigment and no medulla.
impl Default for Structure {
    fn default() -> Self {
        Self {
            diameter_um: 80.0,
            aspect: 1.0,
            section: Section::default(),
            twist_turns_per_cm: 0.0,
            ior: 1.55,
            cuticle: Cuticle::default(),
            cortex: Cortex::default(),
            medulla: Medulla::default(),
            materials: Materials::default(),
            mesh: None,
        }
    }
}

/// No scales.
impl Default for Cuticle {
    fn default() -> Self {
        Self {
            pattern: CuticlePattern::Smooth,
            pitch_um: 10.0,
            height_um: 0.0,
            around: 1,
            jitter: 0.0,
            margin: Margin::default(),
            wear: 0.0,
            lifted: 0.0,
            roughness: 0.0,
            riser_roughness: 0.0,
        }
    }
}

/// No medulla.
impl Default for Medulla {
    fn default() -> Self {
        Self {
            ratio: 0.0,
            kind: MedullaKind::None,
            continuity: Continuity::default(),
            void_ior: 1.0003,
            pigment: 1.0,
        }
    }
}

impl MedullaKind {
    /// As files write it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Ladder { .. } => "ladder",
            Self::Multiserial { .. } => "multiserial",
            Self::Lattice { .. } => "lattice",
            Self::SChannel { .. } => "s-channel",
            Self::Cloisonne { .. } => "cloisonne",
            Self::TireTread { .. } => "tire-tread",
            Self::Globules { .. } => "globules",
            Self::Amorphous { .. } => "amorphous",
            Self::Froth { .. } => "froth",
            Self::Medium { .. } => "medium",
        }
    }
}
