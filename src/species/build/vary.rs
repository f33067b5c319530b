//! What of a groom varies over the skin.

use super::{Reader, number, place_of, tables};
use crate::species::check::Checked;
use crate::species::fields::VARIED;
use crate::species::model::{Vary, VaryBy, VaryWhat};
use crate::species::recipe::{need, picture, word};

/// Where the picture is black or the noise lowest, and where it is white or highest, if nothing is said.
const FROM: f64 = 0.0;
const TO: f64 = 1.0;

impl Reader<'_> {
    /// The list behind `vary`; what is refused is left out.
    pub(super) fn vary(&mut self, groom: &Checked) -> Vec<Vary> {
        let list = tables(groom, "vary").unwrap_or_default();
        list.iter().filter_map(|table| self.one(table)).collect()
    }

    fn one(&mut self, table: &Checked) -> Option<Vary> {
        let word_of = word(table, "what")?;
        let what = VARIED.iter().position(|choice| choice.name == word_of)?;
        let what = VaryWhat::ALL[what];
        let by = match word(table, "by")? {
            "map" => VaryBy::Map {
                picture: picture(table, "linear", self.folder, self.problems)?,
            },
            _ => VaryBy::Noise {
                size_mm: need(table, "size_mm", self.problems)?,
                rough: number(table, "rough").unwrap_or(0.4),
                seed: number(table, "seed").unwrap_or(0.0) as u64,
            },
        };
        let [low, high] = what.range();
        for (key, default) in [("from", FROM), ("to", TO)] {
            let value = number(table, key).unwrap_or(default);
            if !(low..=high).contains(&value) {
                let path = table.path_of(key);
                let message = format!("`{path}` is {value}, expected {low} to {high}");
                let hint = format!("with what = \"{word_of}\" it is a factor: 1 changes nothing");
                self.conflict(place_of(table, key), message, &hint);
            }
        }
        Some(Vary {
            what,
            by,
            from: number(table, "from").unwrap_or(FROM),
            to: number(table, "to").unwrap_or(TO),
        })
    }
}
