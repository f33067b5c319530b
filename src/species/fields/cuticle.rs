//! The fields of the scales.

use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

pub(super) const SCALES: &[&str] = &[
    "pitch_um",
    "height_um",
    "around",
    "jitter",
    "riser_roughness",
    "margin",
    "wear",
    "lifted",
];

/// Scale patterns: `smooth`, then those of [`crate::species::PATTERN_LIBRARY`].
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

/// Margin modifiers, in the order of [`crate::species::Margin`].
const MARGINS: &[Choice] = &[
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

pub(super) static CUTICLE: Shape = Shape {
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
