//! Combing curves and whorls.

use super::{Reader, number, place_of, tables};
use crate::polyline_file;
use crate::skin::Landmark;
use crate::species::check::{Checked, Value};
use crate::species::model::{Comb, CombCurve, Hand, Whorl, WhorlCenter};
use crate::species::recipe::{missing, text, word};

impl Reader<'_> {
    pub(super) fn comb(&mut self, comb: &Checked) -> Comb {
        let list = |key| tables(comb, key).unwrap_or_default().iter();
        Comb {
            curves: list("curve").filter_map(|t| self.curve(t)).collect(),
            whorls: list("whorl").filter_map(|t| self.whorl(t)).collect(),
        }
    }

    fn curve(&mut self, table: &Checked) -> Option<CombCurve> {
        self.one_of(table, "points", "file")?;
        let (lines, is_placed) = match &table.get("points").map(|item| &item.value) {
            Some(Value::Points(points)) => {
                (vec![points.iter().map(|&p| vector(p)).collect()], false)
            }
            Some(_) => return None,
            None => self.lines(table)?,
        };
        Some(CombCurve {
            lines,
            is_placed,
            radius_mm: number(table, "radius_mm")?,
            strength: number(table, "strength").unwrap_or(1.0),
        })
    }

    /// The lines of a file, and whether they say themselves how they are placed.
    fn lines(&mut self, table: &Checked) -> Option<(Vec<Vec<[f32; 3]>>, bool)> {
        let file = text(table, "file")?;
        match polyline_file::read(&self.folder.join(file)) {
            Ok(lines) => Some((lines.lines, lines.is_placed)),
            Err(error) => {
                let hint = "the path of a file of lines is relative to this file".to_owned();
                let message = format!("`{}`: {error}", table.path_of("file"));
                self.problems
                    .push(place_of(table, "file"), message, Some(hint));
                None
            }
        }
    }

    fn whorl(&mut self, table: &Checked) -> Option<Whorl> {
        self.one_of(table, "center", "landmark")?;
        let center = match (
            table.get("center").map(|item| &item.value),
            word(table, "landmark"),
        ) {
            (Some(Value::Numbers(center)), _) => {
                WhorlCenter::Point(vector(center.as_slice().try_into().ok()?))
            }
            (_, Some(name)) => {
                let all = Landmark::ALL.into_iter();
                WhorlCenter::Landmark(all.into_iter().find(|l| l.name() == name)?)
            }
            _ => return None,
        };
        let spiral_deg = number(table, "spiral_deg").unwrap_or(60.0);
        Some(Whorl {
            center,
            radius_mm: number(table, "radius_mm")?,
            strength: number(table, "strength").unwrap_or(1.0),
            hand: match word(table, "hand") {
                Some("clockwise") => Hand::Clockwise,
                _ => Hand::CounterClockwise,
            },
            spiral_deg,
            rim_deg: number(table, "rim_deg").unwrap_or(spiral_deg),
        })
    }

    /// Reports a table that has both of two keys, or none.
    fn one_of(&mut self, table: &Checked, one: &str, other: &str) -> Option<()> {
        match (table.get(one), table.get(other)) {
            (None, None) => {
                missing(table, one, self.problems);
                None
            }
            (Some(_), Some(item)) => {
                let (one, other) = (table.path_of(one), table.path_of(other));
                let message = format!("`{other}` beside `{one}`: only one of them has a meaning");
                self.conflict(&item.place, message, "take one of them out");
                None
            }
            _ => Some(()),
        }
    }
}

fn vector(point: [f64; 3]) -> [f32; 3] {
    point.map(|x| x as f32)
}
