//! Pigment bands from the tip to the root.

use super::{Reader, number, numbers, place_of, tables};
use crate::species::check::Checked;
use crate::species::dye::Dye;
use crate::species::model::PigmentBand;

impl Reader<'_> {
    /// The bands of a class, ascending, the last one open.
    pub(super) fn pigment(&mut self, class: &Checked) -> Option<Vec<PigmentBand>> {
        self.bands(class, "pigment")
    }

    /// Bands under any key.
    pub(crate) fn bands(&mut self, parent: &Checked, key: &str) -> Option<Vec<PigmentBand>> {
        let bands = tables(parent, key)?;
        let last = bands.len() - 1;
        let mut built = Vec::new();
        let mut from_mm = 0.0;
        for (index, band) in bands.iter().enumerate() {
            let content = self.content(band);
            let edge = if index == last {
                self.open_end(band);
                Some((f64::INFINITY, 0.0))
            } else {
                self.edge(band, from_mm)
            };
            if let Some((to_mm, _)) = edge {
                from_mm = to_mm;
            }
            if let (Some((to_mm, softness_mm)), Some(content)) = (edge, content) {
                built.push(PigmentBand {
                    to_mm,
                    softness_mm,
                    ..content
                });
            }
        }
        (built.len() == bands.len()).then_some(built)
    }

    /// What colors a band: melanin of both kinds, or a dye.
    fn content(&mut self, band: &Checked) -> Option<PigmentBand> {
        let melanin = ["eumelanin", "pheomelanin"];
        if band.get("color").is_none() {
            for key in melanin {
                if band.get(key).is_none() && !band.is_misspelt(key) {
                    let message = format!("`{}` is missing", band.path_of(key));
                    let hint = "a band has eumelanin and pheomelanin, 0 for none; or a color";
                    self.conflict(&band.place, message, hint);
                }
            }
            let [eumelanin, pheomelanin] = melanin.map(|key| number(band, key));
            return Some(PigmentBand {
                eumelanin: eumelanin?,
                pheomelanin: pheomelanin?,
                ..PigmentBand::without_melanin(None)
            });
        }
        for key in melanin {
            if let Some(item) = band.get(key) {
                let message = format!("`{}` stands beside a color", band.path_of(key));
                let hint = "the color says how much is absorbed: take out one or the other";
                self.conflict(&item.place, message, hint);
            }
        }
        let color = numbers(band, "color")?.try_into().ok()?;
        Some(PigmentBand::without_melanin(Some(Dye::new(color))))
    }

    /// End and softness of a band that starts `from_mm` from the tip.
    fn edge(&mut self, band: &Checked, from_mm: f64) -> Option<(f64, f64)> {
        for key in ["to_mm", "softness_mm"] {
            if band.get(key).is_none() && !band.is_misspelt(key) {
                let message = format!("`{}` is missing", band.path_of(key));
                self.conflict(
                    &band.place,
                    message,
                    "only the last band, at the root, is open",
                );
            }
        }
        let to_mm = number(band, "to_mm")?;
        let path = band.path_of("to_mm");
        if to_mm <= from_mm {
            let message =
                format!("`{path}` is {to_mm}, expected more than {from_mm} mm of the band before");
            self.conflict(
                place_of(band, "to_mm"),
                message,
                "bands go from the tip to the root",
            );
        }
        let softness_mm = number(band, "softness_mm")?;
        let width = to_mm - from_mm;
        if width > 0.0 && softness_mm > 2.0 * width {
            let path = band.path_of("softness_mm");
            let message = format!(
                "`{path}` is {softness_mm}, expected at most {} mm: twice the band's width",
                2.0 * width
            );
            let hint = "a wider transition would reach past the other end of the band";
            self.conflict(place_of(band, "softness_mm"), message, hint);
        }
        Some((to_mm, softness_mm))
    }

    fn open_end(&mut self, band: &Checked) {
        for key in ["to_mm", "softness_mm"] {
            if let Some(item) = band.get(key) {
                let message = format!(
                    "`{}` stands in the last band, expected no end there",
                    band.path_of(key)
                );
                self.conflict(&item.place, message, "the last band reaches to the root");
            }
        }
    }
}
