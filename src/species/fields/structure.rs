//! The fields of a structure and of a station: sizes, section, cortex.

use super::cuticle::CUTICLE;
use super::materials::MATERIALS;
use super::medulla::MEDULLA;
use super::mesh::MESH;
use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

pub(super) const DIAMETER: Field = Field::layered(
    "diameter_um",
    Kind::Number(number(1.0, 1000.0, "um")),
    "Mean outer diameter here: that of the circle of equal area.",
);
pub(super) const ASPECT: Field = Field::layered(
    "aspect",
    Kind::Number(number(1.0, 5.0, "")),
    "Major over minor axis of the section.",
);
pub(super) const IOR: Field = Field::layered(
    "ior",
    Kind::Number(number(1.0, 3.0, "")),
    "Refractive index of cuticle and cortex.",
);
pub(super) const CUTICLE_FIELD: Field =
    Field::layered("cuticle", Kind::Table(&CUTICLE), "The scales outside.");
pub(super) const MEDULLA_FIELD: Field =
    Field::layered("medulla", Kind::Table(&MEDULLA), "The core.");

pub(super) const MATERIALS_FIELD: Field = Field::optional(
    "materials",
    Kind::Table(&MATERIALS),
    "What parts are made of, where that is not keratin and air.",
);

pub(super) const TWIST: Field = Field::optional(
    "twist_turns_per_cm",
    Kind::Number(number(-20.0, 20.0, "turns per cm")),
    "Turns of the section about the axis, counterclockwise seen from the tip; 0 when left out.",
);
pub(super) const SECTION: Field = Field::optional(
    "section",
    Kind::Choice(SECTIONS),
    "Shape of the cross-section; an ellipse when left out.",
);
pub(super) const SQUARENESS: Field = Field::layered(
    "squareness",
    Kind::Number(number(2.0, 8.0, "")),
    "Superellipse: exponent, 2 an ellipse, 8 nearly a box.",
);
pub(super) const BEND: Field = Field::layered(
    "bend",
    Kind::Number(number(0.0, 0.6, "")),
    "Concavo-convex: rise at the ends of the major axis over the half axis.",
);
pub(super) const DENT: Field = Field::layered(
    "dent",
    Kind::Number(number(0.0, 0.4, "")),
    "Bean: depth of the dent over the radius there.",
);
pub(super) const CORTEX_FIELD: Field = Field::optional(
    "cortex",
    Kind::Table(&CORTEX),
    "How pigment and air lie between cuticle and medulla; even and without air when left out.",
);

pub(super) const MESH_FIELD: Field = Field::optional(
    "mesh",
    Kind::Table(&MESH),
    "A fiber modeled elsewhere, in place of section, scales and voids; materials are read as ever.",
);

/// Sections, in the order of [`crate::species::Section`].
const SECTIONS: &[Choice] = &[
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

pub(super) static CORTEX: Shape = Shape {
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

/// The fields of a structure, after those given: a station has all of them.
macro_rules! structure_fields {
    ($($first:expr)?) => {
        &[
            $($first,)?
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
        ]
    };
}

pub(super) static STRUCTURE: Shape = Shape {
    name: "structure",
    doc: "Cross-section, surface and interior of a fiber, as far as it is shared.",
    cited: true,
    fields: structure_fields!(),
};

pub(super) static STATION: Shape = Shape {
    name: "station",
    doc: "The micro-structure at one place along the hair. What is left out here comes from the \
          `structure` of the class, then from the `structure` of the species.",
    cited: true,
    fields: structure_fields!(Field::required(
        "at",
        Kind::Number(number(0.0, 1.0, "")),
        "Position along the hair, 0 root to 1 tip.",
    )),
};
