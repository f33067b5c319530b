//! Scale patterns as data: how the scales of a cuticle lie and how their free edges run.
//!
//! A recipe is a small TOML file; the ones of the microscopy literature are built in. Two generators
//! cover them all: rows with a margin curve round the fiber, and separate tiles (petals or polygons).

mod fields;
mod library;
mod read;

pub(crate) use fields::PATTERN;
pub use library::{PATTERN_LIBRARY, pattern_names};
pub(crate) use read::recipe_of;

use serde::ser::{Serialize, SerializeStruct, Serializer};

/// The scales of a cuticle.
#[derive(Clone, Debug, PartialEq)]
pub enum CuticlePattern {
    /// No scales: a bare cylinder.
    Smooth,
    /// Scales after a recipe.
    Scales(Box<PatternRecipe>),
}

/// How scales lie and how their free edges run, in units of pitch and scale width, so that one
/// recipe serves fine and coarse hair.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PatternRecipe {
    /// Name of a built-in recipe or of the file without its extension, `diamond-petal`.
    pub name: String,
    /// What it looks like, a sentence or two.
    #[serde(skip)]
    pub summary: String,
    /// Exponent p of the height `t^p` along a scale: 1 flat, above 1 flared, 0.5..4.
    pub rise: f64,
    /// How the scales are laid out.
    pub layout: PatternLayout,
    /// Terms that add up to the course of the free edge, toward the tip.
    pub margin: Vec<MarginTerm>,
}

/// Arrangement of scales.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PatternLayout {
    /// Rows that go round the fiber, a pitch apart, with the margin terms as free edge.
    Rows,
    /// Separate petals: in each row `around` of them, rows a pitch apart.
    Petals {
        /// Length of a petal in pitches, 1..6.
        length: f64,
        /// Width in shares of the turn over `around`, 0.3..2; above 1 petals of a row overlap.
        width: f64,
        /// Where along the length the taper begins, 0..0.95.
        waist: f64,
        /// Exponent q of the taper `1 - t^q`: 1 straight flanks, above rounder, below pointed.
        taper: f64,
        /// Shift of every other row in petals, 0..0.5.
        stagger: f64,
    },
    /// Polygons: Voronoi cells of staggered seeds, stretched by pitch and width.
    Mosaic {
        /// How far the seeds stray, in pitches and widths either way, 0..0.5.
        scatter: f64,
    },
}

/// A term of a free edge: how far it reaches toward the tip at a place round the fiber.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct MarginTerm {
    /// The curve, -1..1.
    pub wave: MarginWave,
    /// Its amplitude in pitches, 0..8.
    pub amplitude: f64,
    /// Cycles (or values of a noise) in one turn, or in one scale's share of it.
    pub cycles: f64,
    /// What the cycles count in.
    pub per: CyclesPer,
    /// How the phase changes from row to row.
    pub phase: RowPhase,
}

/// Curves of margin terms, -1..1.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MarginWave {
    /// A sine.
    Sine,
    /// A zigzag.
    Triangle,
    /// Teeth: `2 (1 - |2 x - 1|)^sharpness - 1`.
    Comb {
        /// 1 a zigzag; below 1 broad teeth with narrow gaps, above 1 needles. 0.2..5.
        sharpness: f64,
    },
    /// Value noise that closes round the fiber.
    Noise {
        /// After so many rows the values are new ones, faded over in between; 1..64.
        rows: u32,
        /// Multiplied by `|noise|` of so many values per turn (or scale); 0 for a plain noise.
        gate: f64,
    },
}

/// What the cycles of a margin term count in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CyclesPer {
    /// One turn round the fiber, however many scales it has.
    Turn,
    /// One scale: multiplied by the cuticle's `around`.
    Scale,
}

/// Phase of a margin term from row to row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RowPhase {
    /// The same in all rows.
    #[default]
    Same,
    /// Half a cycle off in every other row.
    Alternate,
    /// To and fro by 1.1 radians within some seven rows.
    Wander,
    /// Any, in every row.
    Random,
}

impl CuticlePattern {
    /// The name that files use: `smooth`, of a built-in recipe, or of a recipe's file.
    pub fn name(&self) -> &str {
        match self {
            Self::Smooth => "smooth",
            Self::Scales(recipe) => &recipe.name,
        }
    }

    /// A built-in pattern, `None` for an unknown name.
    pub fn built_in(name: &str) -> Option<Self> {
        if name == "smooth" {
            return Some(Self::Smooth);
        }
        let (_, text) = PATTERN_LIBRARY.iter().find(|(known, _)| *known == name)?;
        let recipe = read::parse(text, name, &format!("{name}.toml")).ok()?;
        Some(Self::Scales(Box::new(recipe)))
    }
}

/// The name, and the recipe beside it: a table's identity covers what was built.
impl Serialize for CuticlePattern {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut pattern = serializer.serialize_struct("CuticlePattern", 2)?;
        pattern.serialize_field("pattern", self.name())?;
        let recipe = match self {
            Self::Smooth => None,
            Self::Scales(recipe) => Some(recipe),
        };
        pattern.serialize_field("recipe", &recipe)?;
        pattern.end()
    }
}
