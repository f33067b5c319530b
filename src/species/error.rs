//! What can be wrong with a species file, all of it at once.

use crate::blame::Blame;
use crate::io::FileError;
use std::fmt;
use std::ops::Range;

/// Why a species could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SpeciesError {
    /// Neither a built-in species nor the path of a TOML file.
    #[error("there is no built-in species \"{}\"", printable(name))]
    UnknownName {
        /// What was asked for.
        name: String,
        /// What to do: the closest names, or all of them.
        hint: String,
    },
    /// Several built-in species are called so.
    #[error("\"{}\" may be {}", printable(name), ids.join(" or "))]
    Ambiguous {
        /// What was asked for.
        name: String,
        /// The ids of the species.
        ids: Vec<&'static str>,
    },
    /// Neither a built-in coat nor the path of a TOML file.
    #[error("there is no built-in coat \"{}\" ({hint})", printable(name))]
    UnknownCoat {
        /// What was asked for.
        name: String,
        /// What to do.
        hint: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file was read and refused.
    #[error(transparent)]
    Invalid(#[from] SpeciesErrors),
}

impl SpeciesError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::File(error) => error.blame(),
            Self::UnknownName { .. }
            | Self::UnknownCoat { .. }
            | Self::Ambiguous { .. }
            | Self::Invalid(_) => Blame::Input,
        }
    }
}

/// Where something was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Bytes of the file.
    File(Range<usize>),
    /// The override of this index.
    Set(usize),
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub place: Place,
    /// What was found and what was expected, with the key's full path.
    pub message: String,
    /// How to mend it.
    pub hint: Option<String>,
}

/// More problems than this are counted, not kept.
const KEPT: usize = 200;

/// Everything that is wrong with one species file and its overrides; never empty.
#[derive(Clone, Debug)]
pub struct SpeciesErrors {
    /// The file as the user named it.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The overrides as given, `key=value`.
    pub overrides: Vec<String>,
    /// The problems, in the order of the file, overrides last; at most 200.
    pub problems: Vec<Problem>,
    /// How many there are in all.
    pub count: usize,
}

impl SpeciesErrors {
    /// For a file that was refused without a problem: a defect of this module, said rather than hidden.
    pub(crate) fn unexplained(file: &str, text: &str, overrides: &[String]) -> Self {
        Self {
            file: file.to_owned(),
            text: text.to_owned(),
            overrides: overrides.to_vec(),
            problems: vec![Problem {
                place: Place::File(0..0),
                message: "the file was refused without a reason; this is a defect".to_owned(),
                hint: None,
            }],
            count: 1,
        }
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let mut end = byte.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let line = before.bytes().filter(|b| *b == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// `file:line:column` or `--set key=value`.
    pub fn locate(&self, place: &Place) -> String {
        match place {
            Place::File(span) => {
                let (line, column) = self.line_column(span.start);
                format!("{}:{line}:{column}", printable(&self.file))
            }
            Place::Set(index) => {
                let text = self.overrides.get(*index).map_or("", |s| s.as_str());
                format!("--set {}", printable(text))
            }
        }
    }

    /// A problem on one line: `file:line:column: message (hint)`.
    pub fn line(&self, problem: &Problem) -> String {
        let place = self.locate(&problem.place);
        match &problem.hint {
            Some(hint) => format!("{place}: {} ({hint})", problem.message),
            None => format!("{place}: {}", problem.message),
        }
    }
}

impl fmt::Display for SpeciesErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.problems.iter().map(|p| self.line(p)).collect();
        write!(f, "{}", lines.join("\n"))?;
        match self.count - self.problems.len() {
            0 => Ok(()),
            more => write!(f, "\nand {more} more"),
        }
    }
}

impl std::error::Error for SpeciesErrors {}

/// Collects problems while a file is read.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    kept: Vec<Problem>,
    count: usize,
}

impl Problems {
    /// Notes a problem.
    pub(crate) fn push(&mut self, place: &Place, message: String, hint: Option<String>) {
        self.count += 1;
        if self.kept.len() < KEPT {
            self.kept.push(Problem {
                place: place.clone(),
                message: printable(&message),
                hint: hint.map(|hint| printable(&hint)),
            });
        }
    }

    /// Whether more problems are only counted, so that hints need not be worked out.
    pub(crate) fn is_full(&self) -> bool {
        self.kept.len() >= KEPT
    }

    /// Whether nothing was noted.
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Nothing, or the error.
    pub(crate) fn finish(
        self,
        file: &str,
        text: &str,
        overrides: &[String],
    ) -> Result<(), SpeciesErrors> {
        if self.count == 0 {
            return Ok(());
        }
        let mut problems = self.kept;
        problems.sort_by_key(|p| match &p.place {
            Place::File(span) => (0, span.start),
            Place::Set(index) => (1, *index),
        });
        Err(SpeciesErrors {
            file: file.to_owned(),
            text: text.to_owned(),
            overrides: overrides.to_vec(),
            problems,
            count: self.count,
        })
    }
}

/// `text` with control characters escaped: what comes from a file must not act on the terminal.
pub(crate) fn printable(text: &str) -> String {
    let escape = |c: char| match c {
        c if c.is_control() => c.escape_debug().to_string(),
        c => c.to_string(),
    };
    text.chars().map(escape).collect()
}

/// The candidate that `word` was most likely meant to be: at most one edit for short words, one in
/// three characters for long ones.
pub(crate) fn closest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    if word.len() > 100 {
        return None;
    }
    let plain = |s: &str| s.to_lowercase().replace('_', "-");
    let word = plain(word);
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&word, &plain(c)), c))
        .filter(|(distance, c)| *distance <= (c.len().max(word.len()) / 3).max(1))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

/// ``did you mean `x`?`` or the list of what is allowed, which may be empty.
pub(crate) fn suggestion(suggested: Option<&str>, all: &[&str]) -> String {
    match suggested {
        Some(one) => format!("did you mean `{one}`?"),
        None if all.is_empty() => "none is known here".to_owned(),
        None => format!("known here: {}", all.join(", ")),
    }
}
