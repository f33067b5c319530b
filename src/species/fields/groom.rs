//! The fields of how a hair class grows.

use super::comb::COMB;
use super::vary::VARY;
use super::{choice, number};
use crate::species::shape::{Choice, Field, Kind, Shape};

pub(super) static GROOM: Shape = Shape {
    name: "groom",
    doc: "How one hair class grows on the skin.",
    cited: true,
    fields: &[
        Field::required(
            "density_per_cm2",
            Kind::Number(number(0.1, 200_000.0, "per cm2")),
            "Hairs of this class per square centimeter of skin.",
        ),
        Field::required(
            "length_mm",
            Kind::Number(number(0.5, 2000.0, "mm")),
            "Mean length.",
        ),
        Field::required(
            "length_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Standard deviation of the logarithm of the length.",
        ),
        Field::required(
            "diameter_um",
            Kind::Number(number(1.0, 1000.0, "um")),
            "Widest diameter along the hair.",
        ),
        Field::required(
            "diameter_sigma",
            Kind::Number(number(0.0, 1.0, "")),
            "Standard deviation of the logarithm of the diameter.",
        ),
        Field::required(
            "stalk",
            Kind::Number(number(0.05, 1.0, "")),
            "Diameter of the stalk over the widest diameter.",
        ),
        Field::required(
            "shield",
            Kind::Numbers(2, number(0.0, 1.0, "")),
            "Where the stalk begins to widen and where it is widest, 0 root to 1 tip.",
        ),
        Field::required(
            "taper_from",
            Kind::Number(number(0.0, 0.99, "")),
            "Where the tip begins to taper, 0 root to 1 tip; 0.99 is a cut end.",
        ),
        Field::required(
            "emergence_deg",
            Kind::Number(number(1.0, 90.0, "degrees")),
            "Angle between skin and hair at the root, 90 upright.",
        ),
        Field::required(
            "bend_deg",
            Kind::Number(number(-360.0, 360.0, "degrees")),
            "Bend along the hair under gravity and lay, root to tip.",
        ),
        Field::optional(
            "gravity",
            Kind::Number(number(0.0, 4.0, "")),
            "Factor on what turns hair downhill: lying hair a little toward its tip, hair on hanging skins wholly; \
             1 when left out, 0 none.",
        ),
        Field::required(
            "stray_deg",
            Kind::Number(number(0.0, 90.0, "degrees")),
            "Random deviation of direction.",
        ),
        Field::optional(
            "roll_deg",
            Kind::Number(number(0.0, 90.0, "degrees")),
            "Random roll of the hair about its axis, from lying with the flat side of its section to the \
             skin: standard deviation. 90, any way, when left out; of effect in tables with azimuths.",
        ),
        Field::required(
            "crimp_mm",
            Kind::Number(number(0.0, 20.0, "mm")),
            "Amplitude of the crimp, 0 straight.",
        ),
        Field::required(
            "crimp_wavelength_mm",
            Kind::Number(number(0.1, 1000.0, "mm")),
            "Wavelength of the crimp.",
        ),
        Field::optional(
            "curl_mm",
            Kind::Number(number(0.0, 50.0, "mm")),
            "Radius of curls, 0 none; 0 when left out. Hairs of a clump curl together.",
        ),
        Field::optional(
            "curl_pitch_mm",
            Kind::Number(number(0.5, 1000.0, "mm")),
            "Way along the hair in one turn of a curl; 10 when left out.",
        ),
        Field::optional(
            "frizz_mm",
            Kind::Number(number(0.0, 50.0, "mm")),
            "How far single hairs wander from their course, at the tip; 0 when left out.",
        ),
        Field::optional(
            "trim_mm",
            Kind::Number(number(0.1, 5000.0, "mm")),
            "Hairs are cut to this length, with blunt ends; uncut when left out.",
        ),
        Field::optional(
            "wet",
            Kind::Number(number(0.0, 1.0, "")),
            "How wet: hairs lie down and stick together in larger clumps, 0 dry .. 1; 0 when left out.",
        ),
        Field::required(
            "clump",
            Kind::Number(number(0.0, 1.0, "")),
            "Share of the way to the clump's center at the tip.",
        ),
        Field::required(
            "clump_mm",
            Kind::Number(number(0.01, 100.0, "mm")),
            "Size of a clump.",
        ),
        Field::optional(
            "vary",
            Kind::Tables(&VARY, 16),
            "What of this is not the same everywhere; factors of several join.",
        ),
    ],
};

pub(super) static SHARED: Shape = Shape {
    name: "shared-groom",
    doc: "What all hair classes share in how they grow.",
    cited: false,
    fields: &[
        Field::optional(
            "comb",
            Kind::Table(&COMB),
            "Lines and whorls along which hair lies, in place of the lay of the skin.",
        ),
        Field::optional(
            "pores",
            Kind::Table(&PORES),
            "Hairs leave the skin in groups; each by itself when left out.",
        ),
        Field::optional(
            "keep_widths",
            Kind::Flag,
            "Whether strands keep their width where fewer are asked for than grow by default; when left out they are \
             widened, so that a preview covers as much.",
        ),
        Field::optional(
            "symmetry",
            Kind::Setting(number(0.0, 1.0, "")),
            "How alike both sides of the body are in the patterns of its coat and in noises that vary its hair: 0, \
             each its own, when left out; 1 mirror images.",
        ),
        Field::optional(
            "collision",
            Kind::Choice(COLLISIONS),
            "How strands are held against the skin; near when left out.",
        ),
    ],
};

static PORES: Shape = Shape {
    name: "pores",
    doc: "Compound follicles: hairs that leave the skin together, the others behind the guard hair.",
    cited: true,
    fields: &[
        Field::optional(
            "density_per_cm2",
            Kind::Number(number(0.1, 200_000.0, "per cm2")),
            "Groups per square centimeter of skin, so that each has as many hairs as the densities of the \
             classes make; as many as hairs of the first class when left out.",
        ),
        Field::required(
            "spread_mm",
            Kind::Number(number(0.0, 10.0, "mm")),
            "How far hairs stand from the first of their group at most.",
        ),
        Field::optional(
            "arrangement",
            Kind::Choice(ARRANGEMENTS),
            "How they stand; a cluster when left out.",
        ),
        Field::optional(
            "uneven",
            Kind::Setting(number(0.0, 1.0, "")),
            "How unequal groups are: 0 all alike, 1 from none to twice as many; 0.3 when left out.",
        ),
    ],
};

const ARRANGEMENTS: &[Choice] = &[
    choice("cluster", "in half a disc on the side to which hair lies"),
    choice("row", "in a row across the lay, behind the first hair"),
];

const COLLISIONS: &[Choice] = &[
    choice(
        "near",
        "hair is lifted off the skin that lies around it: a sharp fold or ridge may cut through",
    ),
    choice(
        "exact",
        "no strand passes through the skin: it is bent along the triangles it would enter, or ends before them",
    ),
];
