//! The model in words, for people who read rather than compute.

use super::fields::{MEDULLAE, PATTERNS};
use super::model::{Continuity, HairClass, MedullaKind, PigmentBand, Station};
use super::pattern::CuticlePattern;
use super::shape::Choice;

impl CuticlePattern {
    /// What the scales look like: `long pointed petals`.
    pub fn description(&self) -> &str {
        match (meaning(PATTERNS, self.name()), self) {
            ("", Self::Scales(recipe)) => &recipe.summary,
            (known, _) => known,
        }
    }
}

impl MedullaKind {
    /// What the core looks like: `uniserial ladder: one void a rung`.
    pub fn description(&self) -> &'static str {
        meaning(MEDULLAE, self.name())
    }
}

impl Continuity {
    /// As files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Continuous => "continuous",
            Self::Interrupted => "interrupted",
            Self::Fragmentary => "fragmentary",
        }
    }
}

impl HairClass {
    /// The station where the hair is thickest; of equals the one nearest to the root.
    pub fn widest(&self) -> Option<&Station> {
        let width = |s: &Station| s.structure.diameter_um;
        self.stations
            .iter()
            .reduce(|a, b| if width(b) > width(a) { b } else { a })
    }
}

/// Share of pheomelanin in the pigment from which a hair counts as yellow or orange.
const YELLOW: f64 = 0.7;

/// Below this share pheomelanin does not show beside eumelanin.
const GRAY: f64 = 0.1;

impl PigmentBand {
    /// Color of a hair with this pigment: `dark brown`, `orange`. A word for the field guide; what the
    /// hair looks like in light is the renderer's to say.
    pub fn color_word(&self) -> &'static str {
        let (dark, yellow) = (self.eumelanin, self.pheomelanin);
        let amount = dark + 0.5 * yellow;
        let share = if amount > 0.0 {
            yellow / (dark + yellow)
        } else {
            0.0
        };
        let of = |steps: &[(f64, &'static str)], last| {
            let found = steps.iter().find(|(below, _)| amount < *below);
            found.map_or(last, |(_, word)| *word)
        };
        if share > YELLOW {
            of(
                &[
                    (0.01, "white"),
                    (0.2, "cream"),
                    (0.9, "buff"),
                    (1.7, "tan"),
                    (2.6, "orange"),
                ],
                "rust",
            )
        } else if share < GRAY {
            of(
                &[
                    (0.05, "white"),
                    (0.5, "pale gray"),
                    (1.0, "gray"),
                    (2.0, "dark gray"),
                    (3.5, "black-brown"),
                ],
                "black",
            )
        } else {
            of(
                &[
                    (0.05, "white"),
                    (0.3, "cream"),
                    (0.6, "pale brown"),
                    (1.2, "gray-brown"),
                    (2.4, "brown"),
                    (4.8, "dark brown"),
                ],
                "black-brown",
            )
        }
    }
}

fn meaning(choices: &'static [Choice], name: &str) -> &'static str {
    choices
        .iter()
        .find(|c| c.name == name)
        .map_or("", |c| c.doc)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_and_medulla_has_a_meaning() {
        for choice in PATTERNS.iter().chain(MEDULLAE) {
            assert!(choice.doc.len() > 5, "{}", choice.name);
        }
        assert_eq!(
            CuticlePattern::built_in("pectinate").unwrap().description(),
            "a comb of long narrow teeth"
        );
        assert_eq!(MedullaKind::None.description(), "no medulla");
    }

    #[test]
    fn colors_of_known_hairs() {
        let word = |eumelanin, pheomelanin| {
            let band = PigmentBand {
                to_mm: f64::INFINITY,
                softness_mm: 0.0,
                eumelanin,
                pheomelanin,
            };
            band.color_word()
        };
        // Concentrations of hair shaders: blond 0.3, brown 1.3, black 8; red with little eumelanin.
        assert_eq!(word(0.0, 0.0), "white");
        assert_eq!(word(8.0, 0.0), "black");
        assert_eq!(word(1.3, 0.6), "brown");
        assert_eq!(word(0.02, 4.0), "orange");
        assert_eq!(word(0.6, 0.0), "gray");
        assert_eq!(word(0.0, 0.6), "buff");
    }
}
