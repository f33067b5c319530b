//! The fields of a pattern recipe.

use crate::species::fields::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

/// The whole file.
pub(crate) static PATTERN: Shape = Shape {
    name: "pattern",
    doc: "A scale pattern: how the scales of a cuticle lie and how their free edges run.",
    cited: true,
    fields: &[
        Field::required(
            "summary",
            Kind::Text(1000),
            "What it looks like and on which hair, a sentence or two.",
        ),
        Field::optional(
            "sources",
            Kind::Sources,
            "Literature by key; `source` refers to the keys.",
        ),
        Field::required(
            "generator",
            Kind::Choice(GENERATORS),
            "How the scales are laid out.",
        ),
        Field::optional(
            "rise",
            Kind::Number(number(0.5, 4.0, "")),
            "Exponent of the height along a scale: 1 flat, above 1 flared; 1 when left out.",
        ),
        Field::layered(
            "length",
            Kind::Number(number(1.0, 6.0, "pitches")),
            "Petals: length.",
        ),
        Field::layered(
            "width",
            Kind::Number(number(0.3, 2.0, "")),
            "Petals: width over the turn's share of one scale; above 1 petals of a row overlap.",
        ),
        Field::layered(
            "waist",
            Kind::Number(number(0.0, 0.95, "")),
            "Petals: where along the length the taper begins.",
        ),
        Field::layered(
            "taper",
            Kind::Number(number(0.3, 5.0, "")),
            "Petals: exponent of the taper, 1 straight flanks, above 1 rounder.",
        ),
        Field::layered(
            "stagger",
            Kind::Number(number(0.0, 0.5, "scales")),
            "Petals: shift of every other row round the fiber.",
        ),
        Field::layered(
            "scatter",
            Kind::Number(number(0.0, 0.5, "")),
            "Mosaic: how far seeds stray either way, in pitches and widths.",
        ),
        Field::optional(
            "margin",
            Kind::Tables(&TERM, 8),
            "Terms that add up to the course of the free edge.",
        ),
    ],
};

/// Generators, in the order of [`super::PatternLayout`].
const GENERATORS: &[Choice] = &[
    Choice {
        name: "rows",
        doc: "rows round the fiber, a pitch apart, with the margin terms as free edge",
        keys: &[],
    },
    Choice {
        name: "petals",
        doc: "separate petals, `around` in a row",
        keys: &["length", "width", "waist", "taper", "stagger"],
    },
    Choice {
        name: "mosaic",
        doc: "polygons: Voronoi cells of staggered seeds",
        keys: &["scatter"],
    },
];

static TERM: Shape = Shape {
    name: "term",
    doc: "One term of a free edge: a curve round the fiber, positive toward the tip.",
    cited: true,
    fields: &[
        Field::required("wave", Kind::Choice(WAVES), "The curve."),
        Field::required(
            "amplitude",
            Kind::Number(number(0.0, 8.0, "pitches")),
            "Half of the way from valley to crest.",
        ),
        Field::required(
            "cycles",
            Kind::Number(number(0.1, 400.0, "")),
            "Cycles, or values of a noise, in what `per` says; rounded so that the edge closes.",
        ),
        Field::required(
            "per",
            Kind::Choice(&[
                Choice {
                    name: "turn",
                    doc: "one turn round the fiber, however many scales it has",
                    keys: &[],
                },
                Choice {
                    name: "scale",
                    doc: "one scale: multiplied by the cuticle's `around`",
                    keys: &[],
                },
            ]),
            "What `cycles` count in.",
        ),
        Field::optional(
            "phase",
            Kind::Choice(PHASES),
            "How the phase changes from row to row; same when left out.",
        ),
        Field::layered(
            "sharpness",
            Kind::Number(number(0.2, 5.0, "")),
            "Comb: 1 a zigzag, below 1 broad teeth with narrow gaps, above 1 needles.",
        ),
        Field::optional(
            "rows",
            Kind::Whole(number(1.0, 64.0, "rows")),
            "Noise: new values after so many rows, faded over in between; 1 when left out.",
        ),
        Field::optional(
            "gate",
            Kind::Number(number(0.1, 400.0, "")),
            "Noise: multiplied by the magnitude of a noise of so many values: patches of raggedness.",
        ),
    ],
};

/// Curves, in the order of [`super::MarginWave`].
const WAVES: &[Choice] = &[
    Choice {
        name: "sine",
        doc: "a sine",
        keys: &["phase"],
    },
    Choice {
        name: "triangle",
        doc: "a zigzag",
        keys: &["phase"],
    },
    Choice {
        name: "comb",
        doc: "teeth",
        keys: &["phase", "sharpness"],
    },
    Choice {
        name: "noise",
        doc: "smooth random values that close round the fiber",
        keys: &["rows", "gate"],
    },
];

/// Phases, in the order of [`super::RowPhase`].
const PHASES: &[Choice] = &[
    Choice {
        name: "same",
        doc: "the same in all rows",
        keys: &[],
    },
    Choice {
        name: "alternate",
        doc: "half a cycle off in every other row",
        keys: &[],
    },
    Choice {
        name: "wander",
        doc: "slowly to and fro within some seven rows",
        keys: &[],
    },
    Choice {
        name: "random",
        doc: "any, in every row",
        keys: &[],
    },
];
