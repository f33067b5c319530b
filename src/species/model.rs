//! A validated species: plain data, every value finite and in range. Nothing after this module can
//! meet a bad number. Lengths carry their unit in the name, angles are degrees as in the files.

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
    /// One or two sentences for people who browse the library.
    pub summary: String,
    /// Hair classes, the most visible (`guard`) first; never empty.
    pub classes: Vec<HairClass>,
    /// The skin under the fur, linear reflectance 0..1.
    pub skin_color: [f64; 3],
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

/// Cross-section, surface and interior of a fiber.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Structure {
    /// Mean outer diameter (geometric mean of the axes), micrometers, 1..1000.
    pub diameter_um: f64,
    /// Major over minor axis of the elliptical section, 1..5.
    pub aspect: f64,
    /// Refractive index of cuticle and cortex, 1..3.
    pub ior: f64,
    /// The scales outside.
    pub cuticle: Cuticle,
    /// The core.
    pub medulla: Medulla,
}

/// Scale pattern of the cuticle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cuticle {
    /// Shape and arrangement of the scales.
    pub pattern: CuticlePattern,
    /// Axial distance between scale margins, micrometers.
    pub pitch_um: f64,
    /// Height of the free edge, micrometers; the tilt is `atan(height / pitch)`.
    pub height_um: f64,
    /// Scales (or waves) once round the fiber.
    pub around: u32,
    /// Random variation of pitch, height and position, 0..1; 1 is the natural amount.
    pub jitter: f64,
    /// GGX roughness (alpha) of the scale faces, 0 smooth .. 1.
    pub roughness: f64,
    /// GGX roughness (alpha) of the risers at the free edges; they are below the wavelength in size
    /// and scatter rather than mirror.
    pub riser_roughness: f64,
}

/// The scale patterns of the microscopy literature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CuticlePattern {
    /// No scales: a bare cylinder.
    Smooth,
    /// One scale wraps the shaft; a stack of paper cups.
    Coronal,
    /// Wavy margins that change from row to row.
    IrregularWave,
    /// Jittered polygonal tiles.
    Mosaic,
    /// Overlapping rhombic petals in alternating rows.
    DiamondPetal,
}

/// The core of the fiber.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Medulla {
    /// Medullary index: medulla diameter over fiber diameter, 0..0.95. 0 with `MedullaKind::None`.
    pub ratio: f64,
    /// What fills it.
    pub kind: MedullaKind,
    /// Refractive index of the voids, 1.0003 for air, 1.33 for a flooded medulla.
    pub void_ior: f64,
    /// Pigment in the medulla's walls relative to the cortex, 0..10.
    pub pigment: f64,
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
    /// Hard-core spheres of air, log-normal in size.
    Froth {
        /// Median radius of a void.
        radius_um: f64,
        /// Standard deviation of the logarithm of the radius.
        radius_sigma: f64,
        /// Share of the medulla's volume that is air, 0..0.5.
        air_fraction: f64,
    },
    /// Cells below resolution: a homogeneous scattering medium.
    Medium {
        /// Scattering coefficient, per micrometer.
        scattering_per_um: f64,
        /// Henyey-Greenstein asymmetry, -0.99..0.99.
        asymmetry: f64,
    },
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
}

/// Radius for which melanin concentrations are stated, micrometers: a human hair.
pub const REFERENCE_RADIUS_UM: f64 = 40.0;

/// Absorption of unit eumelanin per reference radius, linear Rec.709 (pbrt after d'Eon 2011).
pub const EUMELANIN: [f64; 3] = [0.419, 0.697, 1.37];

/// Absorption of unit pheomelanin per reference radius, linear Rec.709 (pbrt after d'Eon 2011).
pub const PHEOMELANIN: [f64; 3] = [0.187, 0.4, 1.05];

impl PigmentBand {
    /// Absorption coefficient per micrometer for linear R, G, B. Physical: it does not depend on
    /// the diameter, so fine underhair is paler than guard hair of the same pigment.
    pub fn absorption_per_um(&self) -> [f64; 3] {
        std::array::from_fn(|c| {
            (self.eumelanin * EUMELANIN[c] + self.pheomelanin * PHEOMELANIN[c])
                / REFERENCE_RADIUS_UM
        })
    }
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
    /// Random deviation of direction, degrees.
    pub stray_deg: f64,
    /// Amplitude of the crimp, millimeters, 0 straight.
    pub crimp_mm: f64,
    /// Wavelength of the crimp, millimeters.
    pub crimp_wavelength_mm: f64,
    /// Share of the way to the clump's center at the tip, 0..1.
    pub clump: f64,
    /// Size of a clump, millimeters.
    pub clump_mm: f64,
}
