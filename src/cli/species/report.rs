//! Refused species files on the terminal: each problem under the line of the file it stands in.

use crate::cli::Failure;
use crate::species::{Place, Problem, SpeciesError, SpeciesErrors};
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::sync::Arc;

impl From<SpeciesError> for Failure {
    fn from(error: SpeciesError) -> Self {
        let blame = error.blame();
        match error {
            SpeciesError::UnknownName { ref hint, .. } => Self::with_help(blame, &error, hint),
            SpeciesError::Ambiguous { .. } => {
                Self::with_help(blame, &error, "give the id of one of them")
            }
            SpeciesError::UnknownCoat { .. } => Self::new(blame, error),
            SpeciesError::File(error) => Self::new(blame, error),
            SpeciesError::Invalid(errors) => Self {
                blame,
                report: miette::Report::new(Refused::new(&errors)),
            },
        }
    }
}

/// A refused file: the head of the report, then the problems.
#[derive(Debug)]
struct Refused {
    head: String,
    problems: Vec<Located>,
}

/// A problem with the text it stands in.
#[derive(Debug)]
struct Located {
    message: String,
    hint: Option<String>,
    label: Option<LabeledSpan>,
    source: Arc<NamedSource<String>>,
}

impl Refused {
    fn new(errors: &SpeciesErrors) -> Self {
        let text = printable(&errors.text);
        let source = Arc::new(NamedSource::new(
            errors.file.escape_debug().to_string(),
            text,
        ));
        let locate = |problem: &Problem| Located::new(errors, problem, &source);
        let shown = errors.problems.len();
        let count = match errors.count {
            1 => "1 problem".to_owned(),
            n if n > shown => format!("{n} problems, the first {shown} are shown"),
            n => format!("{n} problems"),
        };
        Self {
            head: format!("{} is refused: {count}", errors.file.escape_debug()),
            problems: errors.problems.iter().map(locate).collect(),
        }
    }
}

impl Located {
    fn new(errors: &SpeciesErrors, problem: &Problem, source: &Arc<NamedSource<String>>) -> Self {
        // The line shown carries the place; an override has no line.
        let (label, message) = match &problem.place {
            Place::File(span) => (
                Some(LabeledSpan::underline(span.clone())),
                problem.message.clone(),
            ),
            Place::Set(_) => (
                None,
                format!("{}: {}", errors.locate(&problem.place), problem.message),
            ),
        };
        Self {
            message,
            hint: problem.hint.clone(),
            label,
            source: Arc::clone(source),
        }
    }
}

/// Control characters would act on the terminal; they are replaced byte for byte, so spans hold.
fn printable(text: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_control() && !"\n\r\t".contains(c) {
            '?'
        } else {
            c
        }
    };
    text.chars().map(plain).collect()
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.head)
    }
}

impl fmt::Display for Located {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Refused {}
impl std::error::Error for Located {}

impl Diagnostic for Refused {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.problems.iter().map(|p| p as &dyn Diagnostic)))
    }
}

impl Diagnostic for Located {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint
            .as_ref()
            .map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.label
            .as_ref()
            .map(|_| &*self.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.label
            .clone()
            .map(|l| Box::new(std::iter::once(l)) as Box<dyn Iterator<Item = _>>)
    }
}
