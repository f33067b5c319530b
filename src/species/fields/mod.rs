//! The fields of a species file.

mod comb;
mod cuticle;
mod groom;
mod materials;
mod medulla;
mod mesh;
mod structure;
mod vary;

pub(crate) use cuticle::PATTERNS;
pub(crate) use medulla::MEDULLAE;
pub(crate) use vary::{CHANNELS, MAP_CHANNEL, MAP_FILE, SPACES, VARIED, choice};

use super::coat::COATS;
use super::shape::{Field, Kind, Range, Shape};
use groom::{GROOM, SHARED};
use structure::{STATION, STRUCTURE};

/// The whole file. Beside these keys it has one [`CLASS`] table for each name in `classes`.
pub(crate) static SPECIES: Shape = Shape {
    name: "species",
    doc: "One animal: its hairs, its skin, and where each number comes from.",
    cited: false,
    fields: &[
        Field::required("name", Kind::Text(100), "Common name."),
        Field::optional("latin", Kind::Text(100), "Scientific name."),
        Field::optional("family", Kind::Text(60), "Scientific family, `Canidae`."),
        Field::optional(
            "group",
            Kind::Text(60),
            "Family for people, `Dogs and foxes`; lists are ordered by it.",
        ),
        Field::optional(
            "synonyms",
            Kind::Texts(16, 60),
            "Other common names and former scientific ones.",
        ),
        Field::required(
            "summary",
            Kind::Text(1000),
            "One or two sentences for people who browse.",
        ),
        Field::required(
            "classes",
            Kind::Names,
            "Names of the hair classes, the most visible first; each has a table of its name.",
        ),
        Field::optional(
            "sources",
            Kind::Sources,
            "Literature by key; `source` refers to the keys.",
        ),
        Field::required("skin", Kind::Table(&SKIN), "The skin under the fur."),
        Field::optional(
            "coat",
            Kind::ChoiceOrFile(COATS),
            "Pattern of the coat: a built-in one or the path of a recipe; one color when left out.",
        ),
        Field::optional(
            "groom",
            Kind::Table(&SHARED),
            "What all classes share in how they grow.",
        ),
        Field::optional(
            "structure",
            Kind::Table(&STRUCTURE),
            "What all classes and stations share; a class or station overrides it.",
        ),
    ],
};

/// One hair class.
pub(crate) static CLASS: Shape = Shape {
    name: "class",
    doc: "One kind of hair of the animal.",
    cited: false,
    fields: &[
        Field::optional(
            "structure",
            Kind::Table(&STRUCTURE),
            "What all stations of this class share; a station overrides it.",
        ),
        Field::required(
            "stations",
            Kind::Tables(&STATION, 8),
            "Micro-structures along the hair, ascending in `at`.",
        ),
        Field::required(
            "pigment",
            Kind::Tables(&BAND, 32),
            "Pigment bands from the tip toward the root; the last one is open and has no `to_mm`.",
        ),
        Field::required(
            "groom",
            Kind::Table(&GROOM),
            "How this class grows on the skin.",
        ),
    ],
};

static SKIN: Shape = Shape {
    name: "skin",
    doc: "The skin under the fur.",
    cited: true,
    fields: &[Field::required(
        "color",
        Kind::Numbers(3, number(0.0, 1.0, "")),
        "Linear Rec.709 reflectance, red green blue.",
    )],
};

pub(crate) static BAND: Shape = Shape {
    name: "band",
    doc: "Pigment of a zone, counted from the tip because the tip grows first.",
    cited: true,
    fields: &[
        Field::layered(
            "to_mm",
            Kind::Number(number(0.01, 2000.0, "mm")),
            "The zone ends this far from the tip; left out in the last zone.",
        ),
        Field::layered(
            "softness_mm",
            Kind::Number(number(0.0, 100.0, "mm")),
            "Width of the transition to the next zone; left out in the last zone.",
        ),
        Field::layered(
            "eumelanin",
            Kind::Number(number(0.0, 50.0, "")),
            "Eumelanin (black, brown) concentration for a fiber of 40 um radius.",
        ),
        Field::layered(
            "pheomelanin",
            Kind::Number(number(0.0, 50.0, "")),
            "Pheomelanin (yellow, orange) concentration for a fiber of 40 um radius.",
        ),
        Field::layered(
            "color",
            Kind::Settings(3, number(0.0, 1.0, "")),
            "In place of melanin: what a coat all of such hair shows on the average in a white room, linear Rec.709.",
        ),
    ],
};

pub(crate) const fn number(min: f64, max: f64, unit: &'static str) -> Range {
    Range { min, max, unit }
}
