//! Where the numbers of a species come from.

use serde::Serialize;

/// Where a number comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Literature: keys of the file's `[sources]` table.
    Source(Vec<String>),
    /// Chosen by reasoning, which is stated.
    Estimate(String),
    /// Given by an override.
    Override,
}

/// A number of a species file with its origin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cited {
    /// Path of the key, `guard.stations.0.cuticle.pitch_um`.
    pub path: String,
    /// The number, or the numbers of a list.
    pub values: Vec<f64>,
    /// Unit, empty for ratios.
    pub unit: &'static str,
    /// What the number means.
    pub meaning: &'static str,
    /// Where it comes from.
    pub origin: Origin,
    /// Remark on a sourced number.
    pub note: Option<String>,
}

/// A reference of the `[sources]` table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reference {
    /// Key that `source` uses.
    pub key: String,
    /// The literature.
    pub text: String,
}

/// Where all numbers of a species come from.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Origins {
    /// The literature, in the order of the file.
    pub references: Vec<Reference>,
    /// Every number, in the order of the file's description.
    pub numbers: Vec<Cited>,
}

impl Origins {
    /// The number at a path.
    pub fn at(&self, path: &str) -> Option<&Cited> {
        self.numbers.iter().find(|n| n.path == path)
    }

    /// The numbers that stand in a table, not in its inner tables.
    pub fn of_table(&self, table: &str) -> Vec<&Cited> {
        let inside = |n: &&Cited| n.path.rsplit_once('.').is_some_and(|(t, _)| t == table);
        self.numbers.iter().filter(inside).collect()
    }

    /// The numbers of the tables `layer + inner`, innermost layer first; a key that stands in
    /// several layers counts in the first.
    pub fn of_layers(&self, layers: &[String], inner: &str) -> Vec<&Cited> {
        let key = |n: &Cited| n.path.rsplit('.').next().map(str::to_owned);
        let mut found: Vec<&Cited> = Vec::new();
        for layer in layers {
            for number in self.of_table(&format!("{layer}{inner}")) {
                if found.iter().all(|f| key(f) != key(number)) {
                    found.push(number);
                }
            }
        }
        found
    }

    /// How many numbers have a source in the literature.
    pub fn sourced(&self) -> usize {
        self.count(|o| matches!(o, Origin::Source(_)))
    }

    /// How many numbers are estimates.
    pub fn estimated(&self) -> usize {
        self.count(|o| matches!(o, Origin::Estimate(_)))
    }

    fn count(&self, which: impl Fn(&Origin) -> bool) -> usize {
        self.numbers.iter().filter(|n| which(&n.origin)).count()
    }
}
