//! The fields of `structure.materials`: what parts are made of where that is not keratin and air.

use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

/// Materials of all parts.
pub(crate) static MATERIALS: Shape = Shape {
    name: "materials",
    doc: "What the parts of the fiber are made of, where that is not keratin and air. Values that \
          may differ by color are a number or three, for linear red, green and blue.",
    cited: false,
    fields: &[
        Field::optional(
            "cuticle",
            Kind::Table(&MATERIAL),
            "The outer surface: scale faces, and their risers if `riser` is left out.",
        ),
        Field::optional(
            "riser",
            Kind::Table(&RISER),
            "The steps at the free edges of scales.",
        ),
        Field::optional(
            "cortex",
            Kind::Table(&MATERIAL),
            "What fills the fiber between cuticle and medulla, and the medulla's walls.",
        ),
        Field::optional(
            "medulla",
            Kind::Table(&MATERIAL),
            "A medulla without voids: its outline and what fills it.",
        ),
        Field::optional(
            "void",
            Kind::Table(&MATERIAL),
            "The voids of the medulla: their walls and what fills them.",
        ),
    ],
};

/// What a boundary may be, in the order of [`crate::species::Boundary`].
pub(crate) const BOUNDARIES: &[Choice] = &[
    Choice {
        name: "dielectric",
        doc: "reflects and refracts, as keratin does",
        keys: &[],
    },
    Choice {
        name: "slab",
        doc: "layered cuticle: thin slabs that reflect more than one interface",
        keys: &["layers", "layer_index"],
    },
    Choice {
        name: "diffuse",
        doc: "opaque, reflects by Lambert's law",
        keys: &["albedo"],
    },
    Choice {
        name: "metal",
        doc: "opaque, reflects as a conductor",
        keys: &["metal", "extinction"],
    },
];

/// Metals with measured constants, in the order of `spectrum::METALS`.
pub(crate) const METALS: &[Choice] = &[
    Choice {
        name: "gold",
        doc: "Johnson and Christy 1972",
        keys: &[],
    },
    Choice {
        name: "silver",
        doc: "Johnson and Christy 1972",
        keys: &[],
    },
    Choice {
        name: "copper",
        doc: "Johnson and Christy 1972",
        keys: &[],
    },
    Choice {
        name: "aluminum",
        doc: "Rakic 1995",
        keys: &[],
    },
];

const BOUNDARY: Field = Field::optional(
    "boundary",
    Kind::Choice(BOUNDARIES),
    "What the outside does to light; dielectric when left out.",
);
const LAYERS: Field = Field::optional(
    "layers",
    Kind::Number(number(0.1, 20.0, "")),
    "Slab: how many; fractions as fits to measured hair give them, 0.4 to 2.",
);
const LAYER_INDEX: Field = Field::optional(
    "layer_index",
    Kind::Color(number(1.0, 3.0, "")),
    "Slab: index of the layers where both sides are alike; the fiber's `ior` when left out.",
);
const ALBEDO: Field = Field::optional(
    "albedo",
    Kind::Color(number(0.0, 1.0, "")),
    "Diffuse: share of the light reflected.",
);
const METAL: Field = Field::optional(
    "metal",
    Kind::Choice(METALS),
    "Metal: which one; or give `index` and `extinction`, or `index_file`.",
);
const INDEX: Field = Field::optional(
    "index",
    Kind::Color(number(0.01, 20.0, "")),
    "Refractive index of what fills the part, 1 to 3; with boundary metal the metal's n.",
);
const EXTINCTION: Field = Field::optional(
    "extinction",
    Kind::Color(number(0.0, 50.0, "")),
    "Metal: imaginary part k of the index.",
);
const INDEX_FILE: Field = Field::optional(
    "index_file",
    Kind::Text(500),
    "Measured index: a file of lines `wavelength, n` or `wavelength, n, k`, in nm or um, beside the \
     species file. Means over 50 nm around 611, 549 and 464 nm are used.",
);

static RISER: Shape = Shape {
    name: "riser_material",
    doc: "What risers are made of; their roughness is the cuticle's `riser_roughness`.",
    cited: true,
    fields: &[
        BOUNDARY,
        LAYERS,
        LAYER_INDEX,
        ALBEDO,
        METAL,
        INDEX,
        EXTINCTION,
        INDEX_FILE,
    ],
};

static MATERIAL: Shape = Shape {
    name: "material",
    doc: "Outside and inside of a part. What is left out is as the rest of the structure says.",
    cited: true,
    fields: &[
        BOUNDARY,
        Field::optional(
            "roughness",
            Kind::Number(number(0.0, 1.0, "")),
            "GGX roughness (alpha) of the boundary; the cuticle's own when left out, 0 elsewhere.",
        ),
        LAYERS,
        LAYER_INDEX,
        ALBEDO,
        METAL,
        INDEX,
        EXTINCTION,
        INDEX_FILE,
        Field::optional(
            "absorption_per_um",
            Kind::Color(number(0.0, 100.0, "per um")),
            "Absorption of what fills the part, beside that of the pigment.",
        ),
        Field::optional(
            "scattering_per_um",
            Kind::Color(number(0.0, 10.0, "per um")),
            "Scattering coefficient of what fills the part.",
        ),
        Field::optional(
            "asymmetry",
            Kind::Number(number(-0.99, 0.99, "")),
            "Henyey-Greenstein asymmetry g of the scattering.",
        ),
    ],
};
