//! The fields of a fiber that comes as a mesh.

use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

/// What a part of a mesh bounds, in the order of [`crate::species::MeshRole`].
const MESH_ROLES: &[Choice] = &[
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

/// Which axis of a mesh points to the tip, in the order of [`crate::species::MeshAxis`].
const MESH_AXES: &[Choice] = &[
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

/// What becomes of the two ends of a mesh, in the order of [`crate::species::MeshEnds`].
const MESH_ENDS: &[Choice] = &[
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

pub(super) static MESH: Shape = Shape {
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
