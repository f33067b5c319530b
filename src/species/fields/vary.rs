//! The fields of what varies over the skin.

use super::number;
use crate::species::shape::{Choice, Field, Kind, Shape};

/// A number of the groom that is not the same everywhere.
pub(super) static VARY: Shape = Shape {
    name: "vary",
    doc: "A number of the groom that varies over the skin: by a picture or by noise.",
    cited: false,
    fields: &[
        Field::required("what", Kind::Choice(VARIED), "What varies."),
        Field::required("by", Kind::Choice(BY), "What it varies with."),
        Field::optional(
            "from",
            Kind::Setting(number(-360.0, 360.0, "")),
            "The factor, or the angle of a turn in degrees, where the picture is black or the noise lowest; 0 when left out.",
        ),
        Field::optional(
            "to",
            Kind::Setting(number(-360.0, 360.0, "")),
            "The factor or angle where the picture is white or the noise highest; 1 when left out.",
        ),
        MAP_FILE,
        MAP_CHANNEL,
        Field::optional(
            "space",
            Kind::Choice(SPACES),
            "Map: how 8-bit and 16-bit values of a PNG are read; linear when left out. EXR is linear.",
        ),
        Field::layered(
            "size_mm",
            Kind::Setting(number(0.5, 5000.0, "mm")),
            "Noise: the size of its largest features.",
        ),
        Field::optional(
            "rough",
            Kind::Setting(number(0.0, 1.0, "")),
            "Noise: how much finer features add; 0.4 when left out.",
        ),
        Field::optional(
            "seed",
            Kind::Count(number(0.0, 1e6, "")),
            "Noise: another number gives another one; 0 when left out.",
        ),
    ],
};

/// In the order of [`crate::species::VaryWhat::ALL`].
pub(crate) const VARIED: &[Choice] = &[
    choice(
        "length",
        "factor on the length; hair that becomes shorter than it is thick does not grow",
    ),
    choice(
        "length-spread",
        "factor on how unequal lengths are, `length_sigma`",
    ),
    choice("width", "factor on the diameter"),
    choice(
        "width-spread",
        "factor on how unequal diameters are, `diameter_sigma`",
    ),
    choice("density", "share of the hairs that grow, 0 to 1"),
    choice("stalk", "factor on the diameter of the stalk"),
    choice("shield", "factor on where the hair widens"),
    choice("taper", "factor on where the tip begins to taper"),
    choice(
        "tilt",
        "factor on the angle between skin and hair at the root",
    ),
    choice("bend", "factor on the bend, -10 to 10"),
    choice("gravity", "factor on what turns hair downhill"),
    choice("stray", "factor on the random deviation of direction"),
    choice("roll", "factor on the random roll about the axis"),
    choice("crimp", "factor on the amplitude of the crimp"),
    choice(
        "crimp-wavelength",
        "factor on the wavelength of the crimp, 0.1 to 10",
    ),
    choice("curl", "factor on the radius of curls"),
    choice(
        "curl-pitch",
        "factor on the way along the hair in one turn of a curl, 0.1 to 10",
    ),
    choice("frizz", "factor on how far single hairs wander"),
    choice(
        "trim",
        "factor on the length to which hairs are cut; cut to less than they are thick they do not grow",
    ),
    choice("wet", "factor on how wet hair is"),
    choice("clump", "factor on the pull toward the clump's center"),
    choice("clump-size", "factor on the size of clumps, 0.1 to 10"),
    choice(
        "comb",
        "factor on the strength of combing curves and whorls, 0 to 1",
    ),
    choice(
        "turn",
        "angle by which the lay is turned about the skin's normal, counter-clockwise, degrees",
    ),
];

const BY: &[Choice] = &[
    Choice {
        name: "map",
        doc: "a picture",
        keys: &["file", "channel", "space"],
    },
    Choice {
        name: "noise",
        doc: "soft patches without order",
        keys: &["size_mm", "rough", "seed"],
    },
];

/// The picture of a map.
pub(crate) const MAP_FILE: Field = Field::layered(
    "file",
    Kind::Text(1000),
    "Map: a picture over the texture coordinates of the skin, .png or .exr, beside this file.",
);

/// What of it counts.
pub(crate) const MAP_CHANNEL: Field = Field::optional(
    "channel",
    Kind::Choice(CHANNELS),
    "Map: what of the picture counts; luminance when left out.",
);

/// In the order of [`crate::io::Channel::ALL`].
pub(crate) const CHANNELS: &[Choice] = &[
    choice("luminance", "brightness of the color"),
    choice("red", "the red channel"),
    choice("green", "the green channel"),
    choice("blue", "the blue channel"),
    choice("alpha", "the opacity"),
];

pub(crate) const SPACES: &[Choice] = &[
    choice("srgb", "a picture: values are decoded"),
    choice("linear", "a map of numbers: values are taken as they are"),
];

/// A word that gives no other key a meaning.
pub(crate) const fn choice(name: &'static str, doc: &'static str) -> Choice {
    Choice {
        name,
        doc,
        keys: &[],
    }
}
