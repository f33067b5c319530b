//! A bake's sums to a file and back.

use super::SumsError;
use super::difference::differences;
use super::progressive::{Bake, lock};
use super::sums_file::{self, Header};
use std::path::Path;

impl Bake<'_> {
    /// Name of the bake whatever its number of photons, 64 hexadecimal digits: where kept sums are
    /// found again.
    pub fn name(&self) -> String {
        self.header.recipe.hash()
    }

    /// Writes the exact sums of what is done so far, to be resumed or merged.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), SumsError> {
        let check = lock(&self.hand).check;
        let done = self.done();
        let header = Header {
            spans: vec![done.span.clone()],
            check,
            ..self.header.clone()
        };
        if done.tallies.is_empty() {
            let plan = &self.header.plan;
            let nothing: Vec<_> = (0..plan.units()).map(|_| plan.empty_tally()).collect();
            return Ok(sums_file::write(path, &header, &nothing)?);
        }
        Ok(sums_file::write(path, &header, &done.tallies)?)
    }

    /// Whether a file holds all sums that this bake is to have, as far as its header says.
    pub fn holds_all(&self, path: &Path) -> bool {
        sums_file::read_header(path).is_ok_and(|header| {
            header.spans == [self.range.clone()]
                && header.recipe == self.header.recipe
                && header.plan.settings == self.header.plan.settings
                && header.provenance == self.header.provenance
                && header.dye == self.header.dye
        })
    }

    /// Takes over the sums that [`Bake::save`] wrote, in place of its own.
    ///
    /// # Errors
    /// [`SumsError`]: no sums, damaged ones, those of another bake, or of photons that this one does not
    /// want. Nothing has changed then.
    pub fn resume(&self, path: &Path) -> Result<(), SumsError> {
        let (header, tallies) = sums_file::read(path)?;
        let foreign = |differs: String| SumsError::Foreign {
            path: path.to_owned(),
            of: "this one".to_owned(),
            differs,
        };
        if let Some(differs) = differences(&header.recipe.0, &self.header.recipe.0) {
            return Err(foreign(differs));
        }
        let span = match &header.spans[..] {
            [span] if span.start == self.range.start && span.end <= self.range.end => span.clone(),
            spans => {
                let wanted = &self.range;
                return Err(foreign(format!(
                    "it has photons {spans:?}, wanted are {wanted:?}"
                )));
            }
        };
        self.take_over(span, tallies, header.check);
        Ok(())
    }
}
