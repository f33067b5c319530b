//! The fields of a species file.

use super::shape::{Choice, Field, Kind, Range, Shape};

/// The whole file. Beside these keys it has one [`CLASS`] table for each name in `classes`.
pub(crate) static SPECIES: Shape = Shape {
    name: "species",
    doc: "One animal: its hairs, its skin, and where each number comes from.",
    cited: false,
    fields: &[
        Field::required("name", Kind::Text(100), "Common name."),
        Field::optional("latin", Kind::Text(100), "Scientific name."),
        Field::required(
            "summary",
            Kind::Text(1000),
            "One or two sentences for people who browse.",
        ),
        Field::required(
            "classes",
            Kind::Names,
            "Names of the hair classes, the most visible first; each has a table of its name.",
        ),
        Field::optional(
            "sources",
            Kind::Sources,
            "Literature by key; `source` refers to the keys.",
        ),
        Field::required("skin", Kind::Table(&SKIN), "The skin under the fur."),
        Field::optional(
            "structure",
            Kind::Table(&STRUCTURE),
            "What all classes and stations share; a class or station overrides it.",
        ),
    ],
};

/// One hair class.
pub(crate) static CLASS: Shape = Shape {
    name: "class",
    doc: "One kind of hair of the animal.",
    cited: false,
    fields: &[
        Field::optional(
            "structure",
            Kind::Table(&STRUCTURE),
            "What all stations of this class share; a station overrides it.",
        ),
        Field::required(
            "stations",
            Kind::Tables(&STATION, 8),
            "Micro-structures along the hair, ascending in `at`.",
        ),
        Field::required(
            "pigment",
            Kind::Tables(&BAND, 32),
            "Pigment bands from the tip toward the root; the last one is open and has no `to_mm`.",
        ),
        Field::required(
            "groom",
            Kind::Table(&GROOM),
            "How this class grows on the skin.",
        ),
    ],
};

static SKIN: Shape = Shape {
    name: "skin",
    doc: "The skin under the fur.",
    cited: true,
    fields: &[Field::required(
        "color",
        Kind::Numbers(3, number(0.0, 1.0, "")),
        "Linear Rec.709 reflectance, red green blue.",
    )],
};

const DIAMETER: Field = Field::layered(
    "diameter_um",
    Kind::Number(number(1.0, 1000.0, "um")),
    "Mean outer diameter here: the geometric mean of the two axes.",
);
const ASPECT: Field = Field::layered(
    "aspect",
    Kind::Number(number(1.0, 5.0, "")),
    "Major over minor axis of the elliptical section.",
);
const IOR: Field = Field::layered(
    "ior",
    Kind::Number(number(1.0, 3.0, "")),
    "Refractive index of cuticle and cortex.",
);
const CUTICLE_FIELD: Field =
    Field::layered("cuticle", Kind::Table(&CUTICLE), "The scales outside.");
const MEDULLA_FIELD: Field = Field::layered("medulla", Kind::Table(&MEDULLA), "The core.");

static STRUCTURE: Shape = Shape {
    name: "structure",
    doc: "Cross-section, surface and interior of a fiber, as far as it is shared.",
    cited: true,
    fields: &[DIAMETER, ASPECT, IOR, CUTICLE_FIELD, MEDULLA_FIELD],
};

static STATION: Shape = Shape {
    name: "station",
    doc: "The micro-structure at one place along the hair. What is left out here comes from the \
          `structure` of the class, then from the `structure` of the species.",
    cited: true,
    fields: &[
        Field::required(
            "at",
            Kind::Number(number(0.0, 1.0, "")),
            "Position along the hair, 0 root to 1 tip.",
        ),
        DIAMETER,
        ASPECT,
        IOR,
        CUTICLE_FIELD,
        MEDULLA_FIELD,
    ],
};

const SCALES: &[&str] = &[
    "pitch_um",
    "height_um",
    "around",
    "jitter",
    "riser_roughness",
];

/// Scale patterns, in the order of [`super::CuticlePattern`].
pub(crate) const PATTERNS: &[Choice] = &[
    Choice {
        name: "smooth",
        doc: "no scales: a bare cylinder",
        keys: &[],
    },
    Choice {
        name: "coronal",
        doc: "one scale wraps the shaft: a stack of paper cups",
        keys: SCALES,
    },
    Choice {
        name: "irregular-wave",
        doc: "wavy margins that change from row to row",
        keys: SCALES,
    },
    Choice {
        name: "mosaic",
        doc: "jittered polygonal tiles",
        keys: SCALES,
    },
    Choice {
        name: "diamond-petal",
        doc: "overlapping rhombic petals in alternating rows",
        keys: SCALES,
    },
];

static CUTICLE: Shape = Shape {
    name: "cuticle",
    doc: "The scales outside.",
    cited: true,
    fields: &[
        Field::layered(
            "pattern",
            Kind::Choice(PATTERNS),
            "Shape and arrangement of the scales.",
        ),
        Field::layered(
            "pitch_um",
            Kind::Number(number(1.0, 200.0, "um")),
            "Axial distance between scale margins.",
        ),
        Field::layered(
            "height_um",
            Kind::Number(number(0.0, 20.0, "um")),
            "Height of the free edge; the scale tilt is atan(height / pitch).",
        ),
        Field::layered(
            "around",
            Kind::Whole(number(1.0, 64.0, "scales")),
            "Scales, or waves, once round the fiber.",
        ),
        Field::layered(
            "jitter",
            Kind::Number(number(0.0, 1.0, "")),
            "Random variation of pitch, height and position; 1 is the natural amount.",
        ),
        Field::layered(
            "roughness",
            Kind::Number(number(0.0, 1.0, "")),
            "GGX roughness (alpha) of the scale faces, 0 smooth.",
        ),
        Field::layered(
            "riser_roughness",
            Kind::Number(number(0.0, 1.0, "")),
            "GGX roughness (alpha) of the steps at the free edges.",
        ),
    ],
};

/// Medulla types, in the order of [`super::MedullaKind`].
pub(crate) const MEDULLAE: &[Choice] = &[
    Choice {
        name: "none",
        doc: "no medulla",
        keys: &[],
    },
    Choice {
        name: "ladder",
        doc: "uniserial ladder: one void a rung",
        keys: &["pitch_um", "septum_um", "void_ior"],
    },
    Choice {
        name: "froth",
        doc: "hard-core spheres of air, log-normal in size",
        keys: &["radius_um", "radius_sigma", "air_fraction", "void_ior"],
    },
    Choice {
        name: "medium",
        doc: "cells below resolution: a homogeneous scattering medium",
        keys: &["scattering_per_um", "asymmetry"],
    },
];

static MEDULLA: Shape = Shape {
    name: "medulla",
    doc: "The core of the fiber.",
    cited: true,
    fields: &[
        Field::layered("kind", Kind::Choice(MEDULLAE), "What fills it."),
        Field::layered(
            "ratio",
            Kind::Number(number(0.0, 0.95, "")),
            "Medullary index: medulla diameter over fiber diameter; 0 with kind \"none\" only.",
        ),
        Field::layered(
            "void_ior",
            Kind::Number(number(1.0, 3.0, "")),
            "Refractive index of the voids: 1.0003 for air, 1.33 for a flooded medulla.",
        ),
        Field::layered(
            "pigment",
            Kind::Number(number(0.0, 10.0, "")),
            "Pigment between the voids relative to the cortex.",
        ),
        Field::layered(
            "pitch_um",
            Kind::Number(number(1.0, 200.0, "um")),
            "Ladder: distance between rungs.",
        ),
        Field::layered(
            "septum_um",
            Kind::Number(number(0.05, 100.0, "um")),
            "Ladder: wall between two voids.",
        ),
        Field::layered(
            "radius_um",
            Kind::Number(number(0.2, 100.0, "um")),
            "Froth: median radius of a void.",
        ),
        Field::layered(
            "radius_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Froth: standard deviation of the logarithm of the radius.",
        ),
        Field::layered(
            "air_fraction",
            Kind::Number(number(0.0, 0.5, "")),
            "Froth: share of the medulla's volume that is air.",
        ),
        Field::layered(
            "scattering_per_um",
            Kind::Number(number(0.0, 10.0, "per um")),
            "Medium: scattering coefficient.",
        ),
        Field::layered(
            "asymmetry",
            Kind::Number(number(-0.99, 0.99, "")),
            "Medium: Henyey-Greenstein asymmetry g.",
        ),
    ],
};

static BAND: Shape = Shape {
    name: "band",
    doc: "Pigment of a zone, counted from the tip because the tip grows first.",
    cited: true,
    fields: &[
        Field::layered(
            "to_mm",
            Kind::Number(number(0.01, 2000.0, "mm")),
            "The zone ends this far from the tip; left out in the last zone.",
        ),
        Field::layered(
            "softness_mm",
            Kind::Number(number(0.0, 100.0, "mm")),
            "Width of the transition to the next zone; left out in the last zone.",
        ),
        Field::required(
            "eumelanin",
            Kind::Number(number(0.0, 50.0, "")),
            "Eumelanin (black, brown) concentration for a fiber of 40 um radius.",
        ),
        Field::required(
            "pheomelanin",
            Kind::Number(number(0.0, 50.0, "")),
            "Pheomelanin (yellow, orange) concentration for a fiber of 40 um radius.",
        ),
    ],
};

static GROOM: Shape = Shape {
    name: "groom",
    doc: "How one hair class grows on the skin.",
    cited: true,
    fields: &[
        Field::required(
            "density_per_cm2",
            Kind::Number(number(0.1, 200_000.0, "per cm2")),
            "Hairs of this class per square centimeter of skin.",
        ),
        Field::required(
            "length_mm",
            Kind::Number(number(0.5, 2000.0, "mm")),
            "Mean length.",
        ),
        Field::required(
            "length_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Standard deviation of the logarithm of the length.",
        ),
        Field::required(
            "diameter_um",
            Kind::Number(number(1.0, 1000.0, "um")),
            "Widest diameter along the hair.",
        ),
        Field::required(
            "diameter_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Standard deviation of the logarithm of the diameter.",
        ),
        Field::required(
            "stalk",
            Kind::Number(number(0.05, 1.0, "")),
            "Diameter of the stalk over the widest diameter.",
        ),
        Field::required(
            "shield",
            Kind::Numbers(2, number(0.0, 1.0, "")),
            "Where the stalk begins to widen and where it is widest, 0 root to 1 tip.",
        ),
        Field::required(
            "taper_from",
            Kind::Number(number(0.0, 0.99, "")),
            "Where the tip begins to taper, 0 root to 1 tip; 0.99 is a cut end.",
        ),
        Field::required(
            "emergence_deg",
            Kind::Number(number(1.0, 90.0, "degrees")),
            "Angle between skin and hair at the root, 90 upright.",
        ),
        Field::required(
            "bend_deg",
            Kind::Number(number(-360.0, 360.0, "degrees")),
            "Bend along the hair under gravity and lay, root to tip.",
        ),
        Field::required(
            "stray_deg",
            Kind::Number(number(0.0, 90.0, "degrees")),
            "Random deviation of direction.",
        ),
        Field::required(
            "crimp_mm",
            Kind::Number(number(0.0, 20.0, "mm")),
            "Amplitude of the crimp, 0 straight.",
        ),
        Field::required(
            "crimp_wavelength_mm",
            Kind::Number(number(0.1, 1000.0, "mm")),
            "Wavelength of the crimp.",
        ),
        Field::required(
            "clump",
            Kind::Number(number(0.0, 1.0, "")),
            "Share of the way to the clump's center at the tip.",
        ),
        Field::required(
            "clump_mm",
            Kind::Number(number(0.01, 100.0, "mm")),
            "Size of a clump.",
        ),
    ],
};

const fn number(min: f64, max: f64, unit: &'static str) -> Range {
    Range { min, max, unit }
}
