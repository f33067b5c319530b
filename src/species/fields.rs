//! The fields of a species file.

use super::material_fields::MATERIALS;
use super::shape::{Choice, Field, Kind, Range, Shape};

/// The whole file. Beside these keys it has one [`CLASS`] table for each name in `classes`.
pub(crate) static SPECIES: Shape = Shape {
    name: "species",
    doc: "One animal: its hairs, its skin, and where each number comes from.",
    cited: false,
    fields: &[
        Field::required("name", Kind::Text(100), "Common name."),
        Field::optional("latin", Kind::Text(100), "Scientific name."),
        Field::optional("family", Kind::Text(60), "Scientific family, `Canidae`."),
        Field::optional(
            "group",
            Kind::Text(60),
            "Family for people, `Dogs and foxes`; lists are ordered by it.",
        ),
        Field::optional(
            "synonyms",
            Kind::Texts(16, 60),
            "Other common names and former scientific ones.",
        ),
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
    "Mean outer diameter here: that of the circle of equal area.",
);
const ASPECT: Field = Field::layered(
    "aspect",
    Kind::Number(number(1.0, 5.0, "")),
    "Major over minor axis of the section.",
);
const IOR: Field = Field::layered(
    "ior",
    Kind::Number(number(1.0, 3.0, "")),
    "Refractive index of cuticle and cortex.",
);
const CUTICLE_FIELD: Field =
    Field::layered("cuticle", Kind::Table(&CUTICLE), "The scales outside.");
const MEDULLA_FIELD: Field = Field::layered("medulla", Kind::Table(&MEDULLA), "The core.");

const MATERIALS_FIELD: Field = Field::optional(
    "materials",
    Kind::Table(&MATERIALS),
    "What parts are made of, where that is not keratin and air.",
);

const TWIST: Field = Field::optional(
    "twist_turns_per_cm",
    Kind::Number(number(-20.0, 20.0, "turns per cm")),
    "Turns of the section about the axis; 0 when left out. Tables average over all rotations.",
);
const SECTION: Field = Field::optional(
    "section",
    Kind::Choice(SECTIONS),
    "Shape of the cross-section; an ellipse when left out.",
);
const SQUARENESS: Field = Field::layered(
    "squareness",
    Kind::Number(number(2.0, 8.0, "")),
    "Superellipse: exponent, 2 an ellipse, 8 nearly a box.",
);
const BEND: Field = Field::layered(
    "bend",
    Kind::Number(number(0.0, 0.6, "")),
    "Concavo-convex: rise at the ends of the major axis over the half axis.",
);
const DENT: Field = Field::layered(
    "dent",
    Kind::Number(number(0.0, 0.4, "")),
    "Bean: depth of the dent over the radius there.",
);
const CORTEX_FIELD: Field = Field::optional(
    "cortex",
    Kind::Table(&CORTEX),
    "How pigment and air lie between cuticle and medulla; even and without air when left out.",
);

const MESH_FIELD: Field = Field::optional(
    "mesh",
    Kind::Table(&MESH),
    "A fiber modeled elsewhere, in place of section, scales and voids; materials are read as ever.",
);

/// Sections, in the order of [`super::Section`].
pub(crate) const SECTIONS: &[Choice] = &[
    Choice {
        name: "ellipse",
        doc: "most hair; a circle with aspect 1",
        keys: &[],
    },
    Choice {
        name: "superellipse",
        doc: "oblong with flat sides (rat)",
        keys: &["squareness"],
    },
    Choice {
        name: "dumb-bell",
        doc: "Cassini oval, waisted beyond an aspect of 1.73 (rabbit, hare)",
        keys: &[],
    },
    Choice {
        name: "concavo-convex",
        doc: "an ellipse bent along its major axis (mouse)",
        keys: &["bend"],
    },
    Choice {
        name: "bean",
        doc: "an ellipse with a dent in one flat side",
        keys: &["dent"],
    },
];

static CORTEX: Shape = Shape {
    name: "cortex",
    doc: "Pigment and air between cuticle and medulla. What is left out is 0.",
    cited: true,
    fields: &[
        Field::optional(
            "toward_medulla",
            Kind::Number(number(-1.0, 1.0, "")),
            "How the pigment leans: -1 toward the cuticle, 0 even, 1 toward the medulla.",
        ),
        Field::optional(
            "clear_rim",
            Kind::Number(number(0.0, 0.9, "")),
            "Share of the cortex under the cuticle without pigment.",
        ),
        Field::optional(
            "streaks",
            Kind::Number(number(0.0, 2.0, "")),
            "Streaks of pigment along the axis: deviation of the logarithm of its density.",
        ),
        Field::optional(
            "fusi_per_mm",
            Kind::Number(number(0.0, 1000.0, "per mm")),
            "Cortical fusi, slender slits of air, per millimeter of hair.",
        ),
    ],
};

/// What a part of a mesh bounds, in the order of [`super::MeshRole`].
pub(crate) const MESH_ROLES: &[Choice] = &[
    Choice {
        name: "cuticle",
        doc: "the outer surface, with the roughness of the cuticle's faces",
        keys: &[],
    },
    Choice {
        name: "riser",
        doc: "what of the outer surface has the roughness of risers; closed together with `cuticle`",
        keys: &[],
    },
    Choice {
        name: "cortex",
        doc: "the cortex, where the cuticle is a layer of its own around it",
        keys: &[],
    },
    Choice {
        name: "medulla",
        doc: "the outline of the medulla: a medium where `medulla.kind` says so, else a void",
        keys: &[],
    },
    Choice {
        name: "void",
        doc: "voids, closed surfaces in cortex or medulla",
        keys: &[],
    },
    Choice {
        name: "ignored",
        doc: "no part of the fiber",
        keys: &[],
    },
];

/// Which axis of a mesh points to the tip, in the order of [`super::MeshAxis`].
pub(crate) const MESH_AXES: &[Choice] = &[
    Choice {
        name: "x",
        doc: "+X points to the tip",
        keys: &[],
    },
    Choice {
        name: "y",
        doc: "+Y points to the tip, as what is up in Maya and glTF",
        keys: &[],
    },
    Choice {
        name: "z",
        doc: "+Z points to the tip",
        keys: &[],
    },
];

/// What becomes of the two ends of a mesh, in the order of [`super::MeshEnds`].
pub(crate) const MESH_ENDS: &[Choice] = &[
    Choice {
        name: "open",
        doc: "the mesh is open there and its rims match one period apart",
        keys: &[],
    },
    Choice {
        name: "capped",
        doc: "the mesh is closed by flat caps, which are taken away so that pieces join",
        keys: &[],
    },
];

static MESH: Shape = Shape {
    name: "mesh",
    doc: "One period of a fiber as a triangle mesh from another program. It is repeated along the \
          axis; diameter, aspect, section, scales and voids are those of the mesh.",
    cited: false,
    fields: &[
        Field::layered(
            "file",
            Kind::Text(1000),
            "An .obj, .ply, .glb or .gltf file, relative to this one.",
        ),
        Field::optional(
            "period_um",
            Kind::Setting(number(0.1, 1e5, "um")),
            "Length after which the mesh repeats; its extent along the axis when left out.",
        ),
        Field::optional(
            "ends",
            Kind::Choice(MESH_ENDS),
            "How the mesh ends; open when left out.",
        ),
        Field::optional(
            "unit_um",
            Kind::Setting(number(1e-6, 1e6, "um")),
            "Micrometers in a unit of the file; 1 when left out.",
        ),
        Field::optional(
            "axis",
            Kind::Choice(MESH_AXES),
            "The axis of the file that points to the tip; z when left out, y for glTF.",
        ),
        Field::optional(
            "parts",
            Kind::Words(MESH_ROLES),
            "Role of each part (object, group or node) that is not named cuticle, riser, cortex, \
             medulla or void.",
        ),
    ],
};

static STRUCTURE: Shape = Shape {
    name: "structure",
    doc: "Cross-section, surface and interior of a fiber, as far as it is shared.",
    cited: true,
    fields: &[
        DIAMETER,
        ASPECT,
        SECTION,
        SQUARENESS,
        BEND,
        DENT,
        TWIST,
        IOR,
        CUTICLE_FIELD,
        CORTEX_FIELD,
        MEDULLA_FIELD,
        MATERIALS_FIELD,
        MESH_FIELD,
    ],
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
        SECTION,
        SQUARENESS,
        BEND,
        DENT,
        TWIST,
        IOR,
        CUTICLE_FIELD,
        CORTEX_FIELD,
        MEDULLA_FIELD,
        MATERIALS_FIELD,
        MESH_FIELD,
    ],
};

const SCALES: &[&str] = &[
    "pitch_um",
    "height_um",
    "around",
    "jitter",
    "riser_roughness",
    "margin",
    "wear",
    "lifted",
];

/// Scale patterns: `smooth`, then those of [`super::PATTERN_LIBRARY`].
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
        name: "coronal-dentate",
        doc: "coronal with a toothed rim",
        keys: SCALES,
    },
    Choice {
        name: "broad-petal",
        doc: "short wide petals",
        keys: SCALES,
    },
    Choice {
        name: "diamond-petal",
        doc: "overlapping rhombic petals in alternating rows",
        keys: SCALES,
    },
    Choice {
        name: "lanceolate-petal",
        doc: "long pointed petals",
        keys: SCALES,
    },
    Choice {
        name: "otter-fin",
        doc: "four fins a level, the next level turned by half a fin",
        keys: SCALES,
    },
    Choice {
        name: "pectinate",
        doc: "a comb of long narrow teeth",
        keys: SCALES,
    },
    Choice {
        name: "mosaic",
        doc: "jittered polygonal tiles",
        keys: SCALES,
    },
    Choice {
        name: "mosaic-rippled",
        doc: "mosaic with rippled outlines",
        keys: SCALES,
    },
    Choice {
        name: "regular-wave",
        doc: "equal waves in every row",
        keys: SCALES,
    },
    Choice {
        name: "irregular-wave",
        doc: "wavy margins that change from row to row",
        keys: SCALES,
    },
    Choice {
        name: "close-wave",
        doc: "near rows with small irregular ripples",
        keys: SCALES,
    },
    Choice {
        name: "single-chevron",
        doc: "two V a turn",
        keys: SCALES,
    },
    Choice {
        name: "double-chevron",
        doc: "four V a turn",
        keys: SCALES,
    },
    Choice {
        name: "human-imbricate",
        doc: "human: irregular margins without a wave",
        keys: SCALES,
    },
    Choice {
        name: "torn-paper",
        doc: "deep ragged margins",
        keys: SCALES,
    },
    Choice {
        name: "squat-polygon",
        doc: "wide low polygons",
        keys: SCALES,
    },
];

/// Margin modifiers, in the order of [`super::Margin`].
pub(crate) const MARGINS: &[Choice] = &[
    Choice {
        name: "smooth",
        doc: "as the pattern gives it",
        keys: &[],
    },
    Choice {
        name: "crenate",
        doc: "shallow pointed notches",
        keys: &[],
    },
    Choice {
        name: "rippled",
        doc: "deeper rounded ripples",
        keys: &[],
    },
    Choice {
        name: "scalloped",
        doc: "round lobes",
        keys: &[],
    },
    Choice {
        name: "dentate",
        doc: "teeth",
        keys: &[],
    },
];

static CUTICLE: Shape = Shape {
    name: "cuticle",
    doc: "The scales outside.",
    cited: true,
    fields: &[
        Field::layered(
            "pattern",
            Kind::ChoiceOrFile(PATTERNS),
            "Shape and arrangement of the scales: a built-in pattern, or the path of a recipe (.toml) \
             relative to this file.",
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
        Field::optional(
            "margin",
            Kind::Choice(MARGINS),
            "Fine shape of the free edges; smooth when left out.",
        ),
        Field::optional(
            "wear",
            Kind::Number(number(0.0, 0.9, "")),
            "Share of scales that are worn away; 0 when left out, 0.3 at old tips.",
        ),
        Field::optional(
            "lifted",
            Kind::Number(number(0.0, 0.5, "")),
            "Share of scales that damage has lifted by 5 to 15 degrees; 0 when left out.",
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
        name: "multiserial",
        doc: "multiserial ladder: columns of cells, rungs aligned across them",
        keys: &["cell_um", "pitch_um", "septum_um", "void_ior"],
    },
    Choice {
        name: "lattice",
        doc: "close-packed polyhedra that fill almost the whole shaft",
        keys: &["cell_um", "wall_um", "void_ior"],
    },
    Choice {
        name: "s-channel",
        doc: "wedge discs, thick left and right by turns, one air channel winding between them",
        keys: &["pitch_um", "void_ior"],
    },
    Choice {
        name: "cloisonne",
        doc: "rows of flat ovals merged into H, X and Y shapes in a scalloped outline",
        keys: &["columns", "pitch_um", "height_um", "void_ior"],
    },
    Choice {
        name: "tire-tread",
        doc: "rows of flat cells in a tube with bumps at every row",
        keys: &["pitch_um", "cell_um", "septum_um", "void_ior"],
    },
    Choice {
        name: "globules",
        doc: "one column of globules of random size, a film of air round each",
        keys: &["spacing", "film_um", "void_ior"],
    },
    Choice {
        name: "amorphous",
        doc: "no cells seen: fine bubbles",
        keys: &["radius_um", "air_fraction", "void_ior"],
    },
    Choice {
        name: "froth",
        doc: "hard-core spheres of air, log-normal in size",
        keys: &["radius_um", "radius_sigma", "air_fraction", "void_ior"],
    },
    Choice {
        name: "medium",
        doc: "a homogeneous scattering medium",
        keys: &["scattering_per_um", "asymmetry"],
    },
];

/// Whether a medulla runs through, in the order of [`super::Continuity`].
pub(crate) const CONTINUITIES: &[Choice] = &[
    Choice {
        name: "continuous",
        doc: "without gaps",
        keys: &[],
    },
    Choice {
        name: "interrupted",
        doc: "gaps shorter than the pieces: about 40 um after every 60 um",
        keys: &[],
    },
    Choice {
        name: "fragmentary",
        doc: "isolated pieces: about 60 um every 260 um",
        keys: &[],
    },
];

static MEDULLA: Shape = Shape {
    name: "medulla",
    doc: "The core of the fiber.",
    cited: true,
    fields: &[
        Field::layered("kind", Kind::Choice(MEDULLAE), "What fills it."),
        Field::optional(
            "continuity",
            Kind::Choice(CONTINUITIES),
            "Whether it runs through; continuous when left out.",
        ),
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
            "Distance between rungs, rows or discs.",
        ),
        Field::layered(
            "septum_um",
            Kind::Number(number(0.05, 100.0, "um")),
            "Wall between two voids.",
        ),
        Field::layered(
            "cell_um",
            Kind::Number(number(1.0, 200.0, "um")),
            "Multiserial, lattice, tire-tread: width of a cell.",
        ),
        Field::layered(
            "wall_um",
            Kind::Number(number(0.1, 20.0, "um")),
            "Lattice: wall between two cells.",
        ),
        Field::layered(
            "columns",
            Kind::Whole(number(1.0, 12.0, "")),
            "Cloisonne: ovals across.",
        ),
        Field::layered(
            "height_um",
            Kind::Number(number(0.5, 100.0, "um")),
            "Cloisonne: height of an oval along the hair.",
        ),
        Field::layered(
            "spacing",
            Kind::Number(number(0.6, 3.0, "")),
            "Globules: mean distance over the medulla's diameter.",
        ),
        Field::layered(
            "film_um",
            Kind::Number(number(0.1, 20.0, "um")),
            "Globules: thickness of the air round each.",
        ),
        Field::layered(
            "radius_um",
            Kind::Number(number(0.2, 100.0, "um")),
            "Froth, amorphous: median radius of a void.",
        ),
        Field::layered(
            "radius_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Froth: standard deviation of the logarithm of the radius.",
        ),
        Field::layered(
            "air_fraction",
            Kind::Number(number(0.0, 0.5, "")),
            "Froth, amorphous: share of the medulla's volume that is air.",
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

pub(super) const fn number(min: f64, max: f64, unit: &'static str) -> Range {
    Range { min, max, unit }
}
