//! Sums of shards put together, and what can be wrong with them.

use super::difference::differences;
use super::sums_file::{self, Header};
use super::tally::Tally;
use super::{BakeError, Shard};
use crate::blame::Blame;
use crate::io::FileError;
use crate::math::unicube::Unicube;
use crate::table::Undyed;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Sums that cannot be read or do not belong together.
#[derive(Debug, thiserror::Error)]
pub enum SumsError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not a file of sums, or no longer what was written.
    #[error("{} does not hold the sums of a bake: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What gave it away.
        what: String,
    },
    /// Sums of another bake.
    #[error("{} is of another bake than {of}: {differs}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it was held against: a file or this command.
        of: String,
        /// The fields that differ, with both values.
        differs: String,
    },
    /// Two files have the same photons.
    #[error(
        "{} and {} both hold photons {} to {}",
        first.display(), second.display(), span.start, span.end - 1
    )]
    Overlap {
        /// A file.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// What they share.
        span: Range<u64>,
    },
    /// Photons are missing for a table.
    #[error("{missing} of {photons} are missing")]
    Gap {
        /// Which, in words.
        missing: String,
        /// Photons of the whole bake.
        photons: u64,
    },
    /// The sums make no table.
    #[error(transparent)]
    Bake(#[from] BakeError),
}

impl SumsError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            Self::Bake(error) => error.blame(),
            Self::Damaged { .. }
            | Self::Foreign { .. }
            | Self::Overlap { .. }
            | Self::Gap { .. } => Blame::Input,
        }
    }
}

/// Exact sums of some photons of a bake, from files.
#[derive(Debug)]
pub struct Sums {
    header: Header,
    tallies: Vec<Tally>,
}

impl Sums {
    /// Puts the sums of files together, in whatever order they are named. Which files belong together
    /// and that no photon is in two of them is made sure before the first one is read in full.
    ///
    /// # Errors
    /// [`SumsError`], with the names of the files and what differs.
    pub fn merge(paths: &[PathBuf]) -> Result<Self, SumsError> {
        let headers = paths
            .iter()
            .map(|path| sums_file::read_header(path))
            .collect::<Result<Vec<_>, _>>()?;
        let mut spans: Vec<(Range<u64>, &Path)> = Vec::new();
        for (path, header) in paths.iter().zip(&headers) {
            if let Some(differs) = differences(&identity(header), &identity(&headers[0])) {
                return Err(SumsError::Foreign {
                    path: path.clone(),
                    of: paths[0].display().to_string(),
                    differs,
                });
            }
            spans.extend(
                header
                    .spans
                    .iter()
                    .map(|span| (span.clone(), path.as_path())),
            );
        }
        spans.sort_by_key(|(span, _)| span.start);
        for pair in spans.windows(2) {
            let [(a, first), (b, second)] = pair else {
                continue;
            };
            if b.start < a.end {
                return Err(SumsError::Overlap {
                    first: first.to_path_buf(),
                    second: second.to_path_buf(),
                    span: b.start..a.end.min(b.end),
                });
            }
        }
        let mut sum: Option<Self> = None;
        for path in paths {
            let (header, tallies) = sums_file::read(path)?;
            match &mut sum {
                None => sum = Some(Self { header, tallies }),
                Some(sum) => {
                    for (a, b) in sum.tallies.iter_mut().zip(&tallies) {
                        a.add(b);
                    }
                }
            }
        }
        let mut sum = sum.ok_or_else(|| SumsError::Gap {
            missing: "all".to_owned(),
            photons: 0,
        })?;
        sum.header.spans = joined(spans.into_iter().map(|(span, _)| span));
        Ok(sum)
    }

    /// Photons in the sums, of each channel.
    pub fn photons(&self) -> u64 {
        self.header.photons()
    }

    /// Photons of the whole bake.
    pub fn photons_of_bake(&self) -> u64 {
        self.header.plan.settings.photons
    }

    /// Writes the sums to a file, which may be merged further.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), SumsError> {
        Ok(sums_file::write(path, &self.header, &self.tallies)?)
    }

    /// The table of the whole bake, to the bit that of a bake in one piece.
    ///
    /// # Errors
    /// [`SumsError::Gap`] if photons are missing.
    pub fn tables(&self) -> Result<Undyed, SumsError> {
        let photons = self.photons_of_bake();
        let gaps = gaps(&self.header.spans, photons);
        if !gaps.is_empty() {
            return Err(SumsError::Gap {
                missing: in_words(&gaps, photons, self.header.shards),
                photons,
            });
        }
        let Header {
            plan, provenance, ..
        } = &self.header;
        let filter = plan.filter(&Unicube::new(plan.settings.face));
        Ok(plan.tables(&self.tallies, filter.as_ref(), photons, provenance)?)
    }

    /// Absorption per micrometer of R, G and B that the tables are to be dyed with; `None` if one
    /// table serves all colors.
    pub fn dye(&self) -> Option<[f64; 3]> {
        self.header.dye
    }
}

/// What shards of one bake share.
fn identity(header: &Header) -> serde_json::Value {
    serde_json::json!({
        "recipe": header.recipe,
        "photons": header.plan.settings.photons,
        "origin": header.provenance,
        "dye": header.dye,
    })
}

/// Ascending spans with neighbors joined.
fn joined(spans: impl Iterator<Item = Range<u64>>) -> Vec<Range<u64>> {
    let mut joined: Vec<Range<u64>> = Vec::new();
    for span in spans.filter(|span| !span.is_empty()) {
        match joined.last_mut() {
            Some(last) if last.end == span.start => last.end = span.end,
            _ => joined.push(span),
        }
    }
    joined
}

/// What ascending spans leave out of `0..photons`.
fn gaps(spans: &[Range<u64>], photons: u64) -> Vec<Range<u64>> {
    let mut gaps = Vec::new();
    let mut next = 0;
    for span in spans {
        if span.start > next {
            gaps.push(next..span.start);
        }
        next = span.end;
    }
    if next < photons {
        gaps.push(next..photons);
    }
    gaps
}

/// Gaps as shards where they are whole ones, as photons where not.
fn in_words(gaps: &[Range<u64>], photons: u64, shards: u64) -> String {
    let missing = |shard: &Shard| {
        let span = shard.span(photons);
        gaps.iter()
            .any(|gap| gap.start <= span.start && span.end <= gap.end)
    };
    let whole: Vec<Shard> = (1..=shards)
        .filter_map(|index| Shard::new(index, shards))
        .filter(missing)
        .collect();
    let photons_of = |spans: &[Range<u64>]| spans.iter().map(|s| s.end - s.start).sum::<u64>();
    let spans: Vec<_> = whole.iter().map(|shard| shard.span(photons)).collect();
    if shards > 1 && photons_of(&spans) == photons_of(gaps) {
        let names: Vec<String> = whole.iter().map(Shard::to_string).collect();
        return format!("the photons of shard {}", names.join(", "));
    }
    let spans: Vec<String> = gaps
        .iter()
        .map(|gap| format!("{} to {}", gap.start, gap.end - 1))
        .collect();
    format!("photons {}", spans.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_join_and_leave_gaps() {
        let spans = joined([0..10, 10..10, 10..20, 30..40].into_iter());
        assert_eq!(spans, [0..20, 30..40]);
        assert_eq!(gaps(&spans, 50), [20..30, 40..50]);
        let whole = joined([0..25, 25..50].into_iter());
        assert_eq!(gaps(&whole, 50), []);
        let words = |gap: Range<u64>| in_words(std::slice::from_ref(&gap), 100, 3);
        assert_eq!(words(33..66), "the photons of shard 2/3");
        assert_eq!(words(33..65), "photons 33 to 64");
        let both = [0..33, 66..100];
        assert_eq!(in_words(&both, 100, 3), "the photons of shard 1/3, 3/3");
    }
}
