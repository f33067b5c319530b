//! The keys of a scene file: those of `vair render` by their names, and lamps.

use super::MOST_SETS;
use crate::scene::MOST_LAMPS;
use crate::species::fields::{choice, number};
use crate::species::shape::{Choice, Field, Kind, Shape};

/// The whole file.
pub(crate) static SCENE: Shape = Shape {
    name: "scene",
    doc: "A picture: what is seen, in which light, and from where. Keys are options of `vair render`, with _ for -; options on the command line go before them.",
    cited: false,
    fields: &[
        Field::required(
            "species",
            Kind::Text(1000),
            "A built-in species or the path of a species file, relative to this file.",
        ),
        Field::optional(
            "coat",
            Kind::Text(1000),
            "Pattern of the coat: a built-in one, the path of a recipe, or none.",
        ),
        Field::optional(
            "color",
            Kind::Settings(3, number(0.0, 1.0, "")),
            "All hair dyed, whatever its coat: what it shows on the average in a white room, linear Rec.709.",
        ),
        Field::optional(
            "set",
            Kind::Texts(MOST_SETS, 1000),
            "Overrides of fields of the species: \"guard.pigment.0.eumelanin=2\".",
        ),
        Field::optional(
            "skin",
            Kind::Text(1000),
            "What the fur grows on: body, ball, swatch, tress, or the path of a mesh.",
        ),
        Field::optional(
            "skin_units",
            Kind::Choice(UNITS),
            "What a unit of the skin's file is.",
        ),
        Field::optional(
            "skin_up",
            Kind::Choice(UPS),
            "Which axis of the skin's file points up.",
        ),
        Field::optional(
            "strands",
            Kind::Count(number(1.0, 1e9, "")),
            "Strands in all.",
        ),
        Field::optional(
            "seed",
            Kind::Count(number(0.0, 9e15, "")),
            "Seed of fiber, fur and picture.",
        ),
        Field::optional(
            "env",
            Kind::Text(1000),
            "The light from far away: studio, sky, white, black, or the path of an EXR or HDR file.",
        ),
        Field::optional(
            "env_turn",
            Kind::Setting(number(-3600.0, 3600.0, "degrees")),
            "Turns this light about the vertical.",
        ),
        Field::optional(
            "env_visible",
            Kind::Flag,
            "Shows it behind the subject instead of a backdrop.",
        ),
        Field::optional("ground", Kind::Flag, "Whether there is a floor."),
        Field::optional(
            "lamps",
            Kind::Tables(&LAMP, MOST_LAMPS),
            "Lamps beside the light from far away. They look at the middle of the subject, throw no shadow of their own, and the camera does not see them.",
        ),
        Field::optional(
            "view",
            Kind::Settings(2, number(-360.0, 360.0, "degrees")),
            "Camera: degrees around the subject (0 is +Z, 90 is +X) and above it.",
        ),
        Field::optional(
            "fov",
            Kind::Setting(number(1.0, 150.0, "degrees")),
            "Field of view along the shorter side.",
        ),
        Field::optional(
            "zoom",
            Kind::Setting(number(0.01, 1000.0, "")),
            "1 frames the subject, 2 shows half of it.",
        ),
        Field::optional(
            "shift",
            Kind::Settings(2, number(-1000.0, 1000.0, "")),
            "Shifts the camera across and up, in radii of the subject.",
        ),
        Field::optional(
            "lens",
            Kind::Setting(number(0.0, 1000.0, "mm")),
            "Diameter of the lens; 0 is a pinhole.",
        ),
        Field::optional(
            "focus",
            Kind::Setting(number(1.0, 1e6, "mm")),
            "Distance from the camera that is sharp.",
        ),
        Field::optional(
            "res",
            Kind::Settings(2, number(1.0, 65536.0, "pixels")),
            "Width and height of the picture.",
        ),
        Field::optional(
            "spp",
            Kind::Count(number(1.0, 16_777_216.0, "")),
            "Samples a pixel.",
        ),
        Field::optional(
            "sampler",
            Kind::Choice(SAMPLERS),
            "How directions are drawn.",
        ),
        Field::optional(
            "filter",
            Kind::Choice(FILTERS),
            "How samples spread over and around their pixel.",
        ),
        Field::optional(
            "look",
            Kind::Choice(LOOKS),
            "How the PNG shows bright parts.",
        ),
        Field::optional(
            "exposure",
            Kind::Setting(number(-20.0, 20.0, "stops")),
            "Exposure of the PNG.",
        ),
    ],
};

static LAMP: Shape = Shape {
    name: "lamp",
    doc: "A lamp. Lengths are in radii of the subject, which are half the diagonal of its bounds.",
    cited: false,
    fields: &[
        Field::required("shape", Kind::Choice(LAMPS), "What it is."),
        Field::required(
            "yaw",
            Kind::Setting(number(-360.0, 360.0, "degrees")),
            "Where it stands around the subject: 0 is +Z, 90 is +X.",
        ),
        Field::required(
            "pitch",
            Kind::Setting(number(-90.0, 90.0, "degrees")),
            "How high it stands above the level of the subject's middle.",
        ),
        Field::optional(
            "with_camera",
            Kind::Flag,
            "Whether yaw counts from the camera instead of +Z; false when left out.",
        ),
        Field::required(
            "strength",
            Kind::Setting(number(0.0, 1e6, "")),
            "Radiance of white paint that faces it in the middle of the subject, as a light meter tells it: moving or resizing a lamp changes shadows only.",
        ),
        Field::optional(
            "color",
            Kind::Settings(3, number(0.0, 1e3, "")),
            "Linear Rec.709, times strength; white when left out.",
        ),
        Field::layered(
            "distance",
            Kind::Setting(number(0.1, 1e6, "radii")),
            "From the middle of the subject to that of the lamp.",
        ),
        Field::layered(
            "size",
            Kind::Settings(2, number(1e-6, 1e6, "radii")),
            "Width and height of a rectangle.",
        ),
        Field::layered(
            "radius",
            Kind::Setting(number(1e-6, 1e6, "radii")),
            "Of a sphere; less than its distance.",
        ),
        Field::optional(
            "diameter",
            Kind::Setting(number(0.01, 170.0, "degrees")),
            "How large the sun looks; 0.53 when left out, as from the earth.",
        ),
    ],
};

const LAMPS: &[Choice] = &[
    Choice {
        name: "rect",
        doc: "a rectangle that shines toward the subject",
        keys: &["distance", "size"],
    },
    Choice {
        name: "sphere",
        doc: "a ball",
        keys: &["distance", "radius"],
    },
    Choice {
        name: "sun",
        doc: "a disk at infinite distance",
        keys: &["diameter"],
    },
];

const UNITS: &[Choice] = &[
    choice("m", "meters"),
    choice("cm", "centimeters"),
    choice("mm", "millimeters"),
    choice("in", "inches"),
];

const UPS: &[Choice] = &[choice("y", "as in glTF"), choice("z", "as in Blender")];

const SAMPLERS: &[Choice] = &[
    choice("qsir", "resampled products of scattering and environment"),
    choice(
        "qsir-one-ray",
        "resampled products, one ray for direct and indirect light",
    ),
    choice("bsdf", "the scattering table alone"),
    choice("env", "the environment for direct light"),
    choice("mis", "both, by multiple importance sampling"),
];

const FILTERS: &[Choice] = &[
    choice("gaussian", "a narrow Gaussian"),
    choice("box", "even over the pixel"),
    choice("tent", "a tent of two pixels"),
];

const LOOKS: &[Choice] = &[
    choice("soft", "as they are up to one half, then rolled off"),
    choice("filmic", "toe and shoulder of film, darker in all"),
    choice(
        "neutral",
        "colors as they are up to 0.8; brighter ones keep their hue",
    ),
    choice("srgb", "as they are, cut at white"),
];
