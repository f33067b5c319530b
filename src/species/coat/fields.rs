//! The fields of a coat recipe.

use crate::species::fields::{BAND, MAP_CHANNEL, MAP_FILE, SPACES, choice, number};
use crate::species::shape::{Choice, Field, Kind, Shape};

/// The whole file.
pub(crate) static COAT: Shape = Shape {
    name: "coat",
    doc: "A coat of several colors: zones of pigment, and layers that say which hairs have them.",
    cited: false,
    fields: &[
        Field::required(
            "summary",
            Kind::Text(1000),
            "What it looks like and on which animal, a sentence or two.",
        ),
        Field::optional(
            "sources",
            Kind::Sources,
            "Literature by key; `source` refers to the keys.",
        ),
        Field::optional(
            "body_mm",
            Kind::Setting(number(10.0, 10_000.0, "mm")),
            "Length of the body from nose to root of the tail for which millimeters are meant: on the built-in body the pattern is scaled to it.",
        ),
        Field::optional(
            "hair",
            Kind::Setting(number(0.05, 3.0, "")),
            "Factor on the length of all hairs; 1 when left out.",
        ),
        Field::required(
            "zones",
            Kind::Tables(&ZONE, super::MAX_ZONES),
            "Pigments beside the species' own.",
        ),
        Field::required(
            "layers",
            Kind::Tables(&LAYER, 40),
            "What is painted, one over the other.",
        ),
    ],
};

static ZONE: Shape = Shape {
    name: "zone",
    doc: "Hairs of one pigment.",
    cited: false,
    fields: &[
        Field::required("name", Kind::Text(32), "Its name, for layers."),
        Field::optional(
            "guard",
            Kind::Tables(&BAND, 32),
            "Pigment bands of the first hair class from the tip to the root; the species' own when left out.",
        ),
        Field::optional(
            "under",
            Kind::Tables(&BAND, 32),
            "Pigment bands of all other hair classes; the species' own when left out.",
        ),
        Field::optional(
            "hair",
            Kind::Setting(number(0.05, 3.0, "")),
            "Factor on the length of its hairs; 1 when left out.",
        ),
    ],
};

static LAYER: Shape = Shape {
    name: "layer",
    doc: "Hairs that are painted with one zone.",
    cited: false,
    fields: &[
        Field::required(
            "zone",
            Kind::Text(32),
            "Name of a zone, or \"own\" for the pigment of the species.",
        ),
        Field::required("pattern", Kind::Choice(PATTERNS), "Which hairs."),
        Field::optional(
            "strength",
            Kind::Setting(number(0.0, 1.0, "")),
            "Share of these hairs that are painted, any of them; 1 when left out.",
        ),
        Field::optional(
            "edge",
            Kind::Setting(number(0.0, 1.0, "")),
            "Width of the pattern's borders as share of its whole range: hairs of both sides mix there; 0.25 when left out.",
        ),
        Field::optional(
            "seed",
            Kind::Count(number(0.0, 1e6, "")),
            "Another number gives another pattern of the same kind; 0 when left out.",
        ),
        Field::layered(
            "wavelength_mm",
            Kind::Setting(number(0.5, 2000.0, "mm")),
            "Turing and rosettes: distance of neighboring spots or stripes.",
        ),
        Field::optional(
            "balance",
            Kind::Setting(number(-1.0, 1.0, "")),
            "Turing: -1 small round spots, 0 stripes, 1 a net round bare spots; 0 when left out.",
        ),
        Field::optional(
            "order",
            Kind::Setting(number(0.0, 1.0, "")),
            "Turing: how strongly stripes keep to their direction; 0 when left out.",
        ),
        Field::optional(
            "lay",
            Kind::Choice(LAYS),
            "Turing: the direction of stripes; across when left out.",
        ),
        Field::optional(
            "fine",
            Kind::Setting(number(0.2, 1.0, "")),
            "Turing and rosettes: wavelength at nose, ears, paws and tip of the tail over that of the trunk; 1 when left out.",
        ),
        Field::optional(
            "cover",
            Kind::Setting(number(0.0, 1.0, "")),
            "Turing, rosettes, patches: share of the skin painted, before limits.",
        ),
        Field::layered(
            "size_mm",
            Kind::Setting(number(0.5, 5000.0, "mm")),
            "Patches: how far they are from each other.",
        ),
        Field::optional(
            "rough",
            Kind::Setting(number(0.0, 1.0, "")),
            "Patches: how ragged their borders are; 0.4 when left out.",
        ),
        MAP_FILE,
        MAP_CHANNEL,
        Field::optional(
            "space",
            Kind::Choice(SPACES),
            "Map: how 8-bit and 16-bit values of a PNG are read; srgb when left out. EXR is linear.",
        ),
        Field::optional(
            "where",
            Kind::Tables(&LIMIT, 16),
            "Limits on the body, joined one after the other; everywhere when left out.",
        ),
    ],
};

const TURING: &[&str] = &[
    "wavelength_mm",
    "balance",
    "order",
    "lay",
    "fine",
    "cover",
    "edge",
];
const ROSETTES: &[&str] = &["wavelength_mm", "fine", "cover", "edge"];

/// Patterns, in the order of [`super::CoatPattern`].
const PATTERNS: &[Choice] = &[
    Choice {
        name: "plain",
        doc: "all hairs",
        keys: &[],
    },
    Choice {
        name: "turing",
        doc: "spots, stripes or a net: a local activator and a lateral inhibitor",
        keys: TURING,
    },
    Choice {
        name: "rosettes",
        doc: "broken rings, as on a leopard",
        keys: ROSETTES,
    },
    Choice {
        name: "rosette-centers",
        doc: "what the rings of the same wavelength and seed enclose",
        keys: ROSETTES,
    },
    Choice {
        name: "patches",
        doc: "irregular patches",
        keys: &["size_mm", "cover", "rough", "edge"],
    },
    Choice {
        name: "map",
        doc: "where a picture is bright",
        keys: &["file", "channel", "space"],
    },
];

const LAYS: &[Choice] = &[
    Choice {
        name: "across",
        doc: "across the lay of the hair: down the flanks, round legs and tail",
        keys: &[],
    },
    Choice {
        name: "along",
        doc: "along the lay of the hair",
        keys: &[],
    },
];

static LIMIT: Shape = Shape {
    name: "limit",
    doc: "A part of the body: either `near` a landmark or `facing` a direction.",
    cited: false,
    fields: &[
        Field::optional(
            "join",
            Kind::Choice(&[
                choice("and", "only within it"),
                choice("or", "within it too"),
                choice("not", "only outside of it"),
            ]),
            "How it joins with the limits before; and when left out.",
        ),
        Field::optional(
            "near",
            Kind::Choice(LANDMARKS),
            "Around a landmark, by the way along the skin.",
        ),
        Field::layered(
            "within_mm",
            Kind::Setting(number(0.0, 10_000.0, "mm")),
            "Near: how far it reaches.",
        ),
        Field::optional(
            "soft_mm",
            Kind::Setting(number(0.0, 5000.0, "mm")),
            "Near: width of the border, in which hairs of both sides mix; 10 when left out.",
        ),
        Field::optional(
            "ragged_mm",
            Kind::Setting(number(0.0, 1000.0, "mm")),
            "Near: how far the border strays either way; 0 when left out.",
        ),
        Field::optional(
            "facing",
            Kind::Choice(&[
                choice("up", "the sky"),
                choice("down", "the ground"),
                choice("front", "head first"),
                choice("back", "toward the tail"),
            ]),
            "Skin that faces a direction.",
        ),
        Field::optional(
            "from",
            Kind::Setting(number(-1.0, 1.0, "")),
            "Facing: cosine of the angle to the direction where the limit begins; 0 when left out.",
        ),
        Field::optional(
            "to",
            Kind::Setting(number(-1.0, 1.0, "")),
            "Facing: cosine where it is reached; 0.6 when left out.",
        ),
    ],
};

/// In the order of [`crate::skin::Landmark::ALL`].
pub(super) const LANDMARKS: &[Choice] = &[
    choice("nose", "tip of the nose"),
    choice("chin", "under the muzzle, from its tip to the throat"),
    choice("cheeks", "sides of the face below the eyes"),
    choice("eyes", "the eyes"),
    choice("eye-line", "from beside the nose over the eye to the ear"),
    choice("crown", "between the ears"),
    choice("ears", "tips of the ears"),
    choice("bib", "from the throat down the breast"),
    choice("belly", "along the middle below"),
    choice("spine", "along the back to the root of the tail"),
    choice("shoulders", "shoulder blades"),
    choice("rump", "haunches"),
    choice("tail", "along the tail"),
    choice("tail-tip", "tip of the tail"),
    choice("paws", "the paws"),
];

/// Names of built-in coats, for the `coat` of a species.
pub(crate) const COATS: &[Choice] = &[
    choice("tabby", "mackerel tabby: stripes, rings on legs and tail"),
    choice("leopard", "rosettes on the trunk, spots elsewhere"),
    choice("zebra", "black and white stripes"),
    choice("badger", "striped face, gray back, black legs and belly"),
    choice("fox", "white bib and tail tip, black stockings and ears"),
    choice("cow", "black patches on white"),
    choice("countershaded", "pale below"),
    choice("siamese", "dark face, ears, paws and tail on a pale body"),
    choice("tortoiseshell", "black and orange patches with some white"),
];
