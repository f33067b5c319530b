//! The fields of the core.

use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

/// Medulla types, in the order of [`crate::species::MedullaKind`].
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

/// Whether a medulla runs through, in the order of [`crate::species::Continuity`].
const CONTINUITIES: &[Choice] = &[
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

pub(super) static MEDULLA: Shape = Shape {
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
            Kind::Number(number(0.15, 3.0, "")),
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
