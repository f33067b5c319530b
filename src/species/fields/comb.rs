//! The fields of combing curves and whorls.

use super::{choice, number};
use crate::species::shape::{Choice, Field, Kind, Shape};

/// Largest coordinate of a place, in the unit of the skin.
const FARTHEST: f64 = 1e6;

pub(super) static COMB: Shape = Shape {
    name: "comb",
    doc: "The lay of the hair: curves that it follows and whorls that it turns about, blended with the lay \
          that the skin has by itself.",
    cited: false,
    fields: &[
        Field::optional(
            "curve",
            Kind::Tables(&CURVE, 64),
            "Curves that hair follows.",
        ),
        Field::optional(
            "whorl",
            Kind::Tables(&WHORL, 64),
            "Whorls that hair turns about.",
        ),
    ],
};

static CURVE: Shape = Shape {
    name: "comb-curve",
    doc: "A line on the skin, or the lines of a file, from root to tip: hair beside it lies along it.",
    cited: false,
    fields: &[
        Field::layered(
            "points",
            Kind::Points(1000, number(-FARTHEST, FARTHEST, "")),
            "Points of the line, in the coordinates of the skin's file; of built-in skins in meters, Y up.",
        ),
        Field::layered(
            "file",
            Kind::Text(1000),
            "Lines of an .obj file (in the coordinates of the skin's file) or curves of a .usd, .usda or .usdc \
             file (in the unit and axis that it states), beside this file; in place of `points`.",
        ),
        Field::required(
            "radius_mm",
            Kind::Setting(number(0.1, 10_000.0, "mm")),
            "How far from the line its pull reaches; half of it is lost at half of that.",
        ),
        Field::optional(
            "strength",
            Kind::Setting(number(0.0, 1.0, "")),
            "Share of the way from the skin's own lay to that of the line, on it; 1 when left out.",
        ),
    ],
};

static WHORL: Shape = Shape {
    name: "whorl",
    doc: "A place that hair turns about: at `center`, or at each place of a `landmark`.",
    cited: false,
    fields: &[
        Field::layered(
            "center",
            Kind::Settings(3, number(-FARTHEST, FARTHEST, "")),
            "Its center, in the coordinates of the skin's file; of built-in skins in meters, Y up. The \
             nearest place of the skin is taken.",
        ),
        Field::layered(
            "landmark",
            Kind::Choice(PLACES),
            "A named place of the body, in place of `center`.",
        ),
        Field::required(
            "radius_mm",
            Kind::Setting(number(0.1, 10_000.0, "mm")),
            "How far from the center its pull reaches; half of it is lost at half of that.",
        ),
        Field::optional(
            "strength",
            Kind::Setting(number(0.0, 1.0, "")),
            "Share of the way from the skin's own lay to that of the whorl, near its center; 1 when left out.",
        ),
        Field::optional(
            "hand",
            Kind::Choice(HANDS),
            "Which way hair goes round, seen from outside; counter-clockwise when left out.",
        ),
        Field::optional(
            "spiral_deg",
            Kind::Setting(number(0.0, 180.0, "degrees")),
            "Angle between the hair and the way out of the center, near it: 0 a star, 90 circles, 180 into the \
             center; 60 when left out.",
        ),
        Field::optional(
            "rim_deg",
            Kind::Setting(number(0.0, 180.0, "degrees")),
            "The same angle at the radius; as `spiral_deg` when left out.",
        ),
    ],
};

/// In the order of [`crate::species::Hand`].
const HANDS: &[Choice] = &[
    choice("counter-clockwise", "to the left around the center"),
    choice("clockwise", "to the right around the center"),
];

/// Landmarks that are points, not lines.
const PLACES: &[Choice] = &[
    choice("nose", "tip of the nose"),
    choice("cheeks", "sides of the face below the eyes"),
    choice("eyes", "the eyes"),
    choice("crown", "between the ears"),
    choice("ears", "tips of the ears"),
    choice("shoulders", "shoulder blades"),
    choice("rump", "haunches"),
    choice("tail-tip", "tip of the tail"),
    choice("paws", "the paws"),
];
