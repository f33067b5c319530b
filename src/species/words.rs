//! The model in words, for people who read rather than compute.

use super::fields::{MEDULLAE, PATTERNS};
use super::model::{Continuity, HairClass, MedullaKind, PigmentBand, REFERENCE_RADIUS_UM, Station};
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
const GRAY: f64 = 0.06;

/// Share of keratin in a lattice, which is most of the hair: light meets little else than air there.
const KERATIN_OF_A_LATTICE: f64 = 0.2;

impl HairClass {
    /// Color of a coat of hairs with such pigment: `dark brown`, `orange`. A word for the field guide;
    /// what the coat looks like in light is the renderer's to say.
    ///
    /// Light goes some five radii through a hair whether it has a medulla or not, being caught between
    /// its scales (bakes of all built-in animals): what counts is the pigment times the thickness.
    pub fn color_word(&self, band: &PigmentBand) -> &'static str {
        if band.dye.is_some() {
            return "dyed";
        }
        let (dark, yellow) = (band.eumelanin, band.pheomelanin);
        let is_lattice =
            |s: &Station| matches!(s.structure.medulla.kind, MedullaKind::Lattice { .. });
        let keratin = match self.widest() {
            Some(station) if is_lattice(station) => KERATIN_OF_A_LATTICE,
            _ => 1.0,
        };
        let thickness = keratin * self.groom.diameter_um / (2.0 * REFERENCE_RADIUS_UM);
        let amount = (dark + 0.5 * yellow) * thickness;
        let share = if dark + yellow > 0.0 {
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
                    (0.02, "white"),
                    (0.05, "cream"),
                    (0.15, "buff"),
                    (0.25, "tan"),
                    (0.9, "orange"),
                ],
                "rust",
            )
        } else if share < GRAY {
            of(
                &[
                    (0.02, "white"),
                    (0.15, "pale gray"),
                    (0.4, "gray"),
                    (0.9, "dark gray"),
                    (1.4, "black-brown"),
                ],
                "black",
            )
        } else {
            of(
                &[
                    (0.02, "white"),
                    (0.08, "cream"),
                    (0.2, "pale brown"),
                    (0.3, "gray-brown"),
                    (0.8, "brown"),
                    (3.0, "dark brown"),
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
        let class = |id: &str| {
            crate::species::load(id, &[])
                .unwrap()
                .classes
                .swap_remove(0)
        };
        let human = class("human");
        let word = |eumelanin, pheomelanin| {
            human.color_word(&PigmentBand {
                to_mm: f64::INFINITY,
                softness_mm: 0.0,
                eumelanin,
                pheomelanin,
                dye: None,
            })
        };
        // Concentrations of hair shaders: blond 0.3, brown 1.3, black 8; red with little eumelanin.
        assert_eq!(word(0.0, 0.0), "white");
        assert_eq!(word(8.0, 0.0), "black");
        assert_eq!(word(0.3, 0.1), "brown");
        assert_eq!(word(1.3, 0.1), "dark brown");
        assert_eq!(word(0.02, 0.8), "orange");
        assert_eq!(word(0.02, 2.4), "rust");
        for (id, words) in [
            ("red-fox", &["dark brown", "orange", "dark brown"][..]),
            ("wolf", &["black", "white", "black", "white"]),
            ("mink", &["dark brown"]),
            ("polar-bear", &["white"]),
        ] {
            let class = class(id);
            let found: Vec<&str> = class.pigment.iter().map(|b| class.color_word(b)).collect();
            assert_eq!(found, words, "{id}");
        }
    }
}
