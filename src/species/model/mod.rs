//! A validated species: plain data, every value finite and in range. Nothing after this module can
//! meet a bad number. Lengths carry their unit in the name, angles are degrees as in the files.

mod comb;
mod mesh;
mod structure;
mod vary;

pub use comb::*;
pub use mesh::*;
pub use structure::*;
pub use vary::*;

use super::coat::CoatRecipe;
use super::dye::Dye;
use serde::Serialize;

/// One animal.
#[derive(Clone, Debug, Serialize)]
pub struct Species {
    /// File name without extension, `red-fox`.
    pub id: String,
    /// Common name, `Red fox`.
    pub name: String,
    /// Scientific name, `Vulpes vulpes`; empty for made-up fibers.
    pub latin: String,
    /// Scientific family, `Canidae`; empty for made-up fibers.
    pub family: String,
    /// Family for people, `Dogs and foxes`; the library lists by it. Empty if the file names none.
    pub group: String,
    /// Other common names and former scientific ones; a built-in species is found by them.
    pub synonyms: Vec<String>,
    /// One or two sentences for people who browse the library.
    pub summary: String,
    /// Hair classes, the most visible (`guard`) first; never empty.
    pub classes: Vec<HairClass>,
    /// The skin under the fur, linear reflectance 0..1.
    pub skin_color: [f64; 3],
    /// What all classes share in how they grow.
    #[serde(skip_serializing_if = "SharedGroom::is_plain")]
    pub groom: SharedGroom,
    /// Which hairs have other pigment than `classes` say; `None` for a coat of one color.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coat: Option<CoatRecipe>,
    /// The species file as read, with overrides listed at its end: provenance for tables and images.
    #[serde(skip)]
    pub text: String,
}

/// One kind of hair of an animal: `guard`, `under`.
#[derive(Clone, Debug, Serialize)]
pub struct HairClass {
    /// Name of the class, unique in the species.
    pub name: String,
    /// Structures along the hair, ascending in `at`; never empty.
    pub stations: Vec<Station>,
    /// Pigment from the tip toward the root; never empty, the last band has `to_mm = infinity`.
    pub pigment: Vec<PigmentBand>,
    /// How this class grows on the skin.
    pub groom: ClassGroom,
}

/// The micro-structure at one place along the hair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Station {
    /// Position along the hair, 0 root .. 1 tip. Between stations the renderer blends.
    pub at: f64,
    /// What the hair is made of there.
    pub structure: Structure,
}

/// Pigment of a zone, counted from the tip because the tip grows first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PigmentBand {
    /// The zone ends this far from the tip, millimeters; infinity for the zone at the root.
    pub to_mm: f64,
    /// Width of the transition to the next zone, millimeters.
    pub softness_mm: f64,
    /// Eumelanin concentration, in the units of hair shaders for a fiber of 40 um radius.
    pub eumelanin: f64,
    /// Pheomelanin concentration, same units.
    pub pheomelanin: f64,
    /// A color asked for: there is no melanin then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dye: Option<Dye>,
}

impl Species {
    /// The pigment of a class's hairs in each part of the coat, its own first.
    pub fn pigments(&self, class: usize) -> Vec<&[PigmentBand]> {
        let own: &[PigmentBand] = &self.classes[class].pigment;
        let zones = self.coat.iter().flat_map(|coat| &coat.zones);
        let of = zones.map(|zone| {
            let bands = if class == 0 { &zone.guard } else { &zone.under };
            if bands.is_empty() { own } else { bands }
        });
        std::iter::once(own).chain(of).collect()
    }
}

/// Radius for which melanin concentrations are stated, micrometers: a human hair.
pub const REFERENCE_RADIUS_UM: f64 = 40.0;

/// Absorption of unit eumelanin per reference radius, linear Rec.709.
///
/// The spectrum is the measured one of Sarna & Swartz 1988, scaled at 550 nm to the value of hair
/// shaders (0.697, d'Eon 2011), so that their concentrations hold here. A channel's coefficient is
/// what is taken from its share of daylight (D65, CIE 1931) on one reference radius of way. Shaders
/// have (0.419, 0.697, 1.37): a power law of skin at 650, 550 and 450 nm.
pub const EUMELANIN: [f64; 3] = [0.388, 0.737, 1.37];

/// Absorption of unit pheomelanin per reference radius, linear Rec.709.
///
/// As [`EUMELANIN`], with 0.4 at 550 nm. Shaders have (0.187, 0.4, 1.05), half of the measured
/// distance between red and green: no amount of that makes thick fur redder than tan, because what
/// comes back from many hairs goes with the root of the absorption.
pub const PHEOMELANIN: [f64; 3] = [0.119, 0.425, 1.16];

impl PigmentBand {
    /// Absorption coefficient per micrometer for linear R, G, B. Physical: it does not depend on
    /// the diameter, so fine underhair is paler than guard hair of the same pigment.
    pub fn absorption_per_um(&self) -> [f64; 3] {
        if let Some(dye) = &self.dye {
            return dye.absorption_per_um;
        }
        std::array::from_fn(|c| {
            (self.eumelanin * EUMELANIN[c] + self.pheomelanin * PHEOMELANIN[c])
                / REFERENCE_RADIUS_UM
        })
    }
}

impl HairClass {
    /// The pigment at a position along the hair, for hairs of mean length.
    ///
    /// * `at`: 0 root .. 1 tip.
    pub fn band_at(&self, at: f64) -> &PigmentBand {
        let from_tip_mm = (1.0 - at) * self.groom.length_mm;
        let band = self.pigment.iter().find(|band| from_tip_mm <= band.to_mm);
        // The last band has no end; a class has at least one.
        band.unwrap_or(&self.pigment[self.pigment.len() - 1])
    }
}

/// What all hair classes share in how they grow.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SharedGroom {
    /// Lines and whorls along which hair lies.
    #[serde(skip_serializing_if = "Comb::is_empty")]
    pub comb: Comb,
    /// Groups in which hairs leave the skin; `None` if each does by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pores: Option<Pores>,
    /// Whether strands fewer than by default keep the width that an opaque coat asks for; else they are
    /// widened to cover as much as the default ones.
    pub keep_widths: bool,
    /// How alike both sides of a body are in patterns and noises, 0 each its own .. 1 mirror images.
    pub symmetry: f64,
    /// How strands are held against the skin.
    #[serde(skip_serializing_if = "Collision::is_near")]
    pub collision: Collision,
}

/// How strands are held against the skin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Collision {
    /// They are lifted off the skin around them, coarsely.
    #[default]
    Near,
    /// None passes through a triangle of the skin.
    Exact,
}

impl Collision {
    fn is_near(&self) -> bool {
        *self == Self::Near
    }
}

impl SharedGroom {
    /// Whether nothing is said.
    fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// Compound follicles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pores {
    /// Groups per square centimeter; `None` for as many as hairs of the first class.
    pub density_per_cm2: Option<f64>,
    /// How far hairs stand from the first of their group at most, millimeters.
    pub spread_mm: f64,
    /// How they stand.
    pub arrangement: Arrangement,
    /// How unequal groups are, 0 all alike .. 1.
    pub uneven: f64,
}

/// How the hairs of a group stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// In half a disc on the side to which hair lies.
    #[default]
    Cluster,
    /// In a row across the lay.
    Row,
}

/// How one hair class grows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassGroom {
    /// Follicles per square centimeter of skin.
    pub density_per_cm2: f64,
    /// Mean length, millimeters.
    pub length_mm: f64,
    /// Standard deviation of the logarithm of the length.
    pub length_sigma: f64,
    /// Widest diameter along the hair, micrometers.
    pub diameter_um: f64,
    /// Standard deviation of the logarithm of the diameter.
    pub diameter_sigma: f64,
    /// Diameter of the stalk over the widest diameter, 0..1.
    pub stalk: f64,
    /// Where the stalk begins to widen and where it is widest, 0..1 along the hair.
    pub shield: [f64; 2],
    /// Where the tip begins to taper, 0..1.
    pub taper_from: f64,
    /// Angle between skin and hair at the root, degrees, 0 flat .. 90 upright.
    pub emergence_deg: f64,
    /// Bend along the hair under gravity and lay, degrees root to tip.
    pub bend_deg: f64,
    /// Factor on what turns hair downhill: a little where it lies, wholly on skins that it hangs from.
    pub gravity: f64,
    /// Random deviation of direction, degrees.
    pub stray_deg: f64,
    /// How far the flat side of the section is turned from lying to the skin: standard deviation over
    /// the hairs, degrees, 0 all flat .. 90 any way.
    pub roll_deg: f64,
    /// Amplitude of the crimp, millimeters, 0 straight.
    pub crimp_mm: f64,
    /// Wavelength of the crimp, millimeters.
    pub crimp_wavelength_mm: f64,
    /// Radius of curls, millimeters, 0 none.
    pub curl_mm: f64,
    /// Way along the hair in one turn of a curl, millimeters.
    pub curl_pitch_mm: f64,
    /// How far single hairs wander from their course at the tip, millimeters.
    pub frizz_mm: f64,
    /// Hairs are cut to this length, millimeters; infinity for uncut ones.
    pub trim_mm: f64,
    /// How wet, 0 dry .. 1.
    pub wet: f64,
    /// Share of the way to the clump's center at the tip, 0..1.
    pub clump: f64,
    /// Size of a clump, millimeters.
    pub clump_mm: f64,
    /// What of this is not the same everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub vary: Vec<Vary>,
}
