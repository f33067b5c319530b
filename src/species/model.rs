//! A validated species: plain data, every value finite and in range. Nothing after this module can
//! meet a bad number. Lengths carry their unit in the name, angles are degrees as in the files.

use super::materials::Materials;
use super::pattern::CuticlePattern;
use crate::mesh_file::LoadedMesh;
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
    /// Diameter of the circle of equal area, micrometers, 1..1000: for an ellipse the geometric mean of
    /// its axes.
    pub diameter_um: f64,
    /// Major over minor axis of the section, 1..5.
    pub aspect: f64,
    /// Shape of the section.
    pub section: Section,
    /// Turns of the section about the axis, per centimeter. Tables do not see it: they average over
    /// all rotations of the fiber, as far as a hair turns within the width of a pixel.
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
        /// Mean distance between globules over the medulla's diameter, 0.6 .. 3.
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

/// One period of a fiber as triangles from a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FiberMesh {
    /// The path as it is opened.
    pub file: String,
    /// Length of a period, micrometers; the mesh's extent along its axis if not given.
    pub period_um: Option<f64>,
    /// What becomes of its two ends.
    pub ends: MeshEnds,
    /// Micrometers in a unit of the file.
    pub unit_um: f64,
    /// Which axis of the file points to the tip.
    pub axis: MeshAxis,
    /// Role of each part of the file, in the file's order.
    pub roles: Vec<MeshRole>,
    /// What the file holds.
    pub content: LoadedMesh,
}

/// What becomes of the two ends of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum MeshEnds {
    /// Open, with rims that match one period apart.
    #[default]
    Open,
    /// Closed by flat caps, which are taken away.
    Capped,
}

/// An axis of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshAxis {
    /// +X: (x, y, z) becomes (y, z, x).
    X,
    /// +Y: (x, y, z) becomes (x, -z, y).
    Y,
    /// +Z.
    Z,
}

/// What a part of a mesh bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshRole {
    /// The outer surface.
    Cuticle,
    /// What of the outer surface is as rough as risers.
    Riser,
    /// The cortex under a cuticle of its own.
    Cortex,
    /// The outline of the medulla.
    Medulla,
    /// Voids.
    Void,
    /// Nothing.
    Ignored,
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
