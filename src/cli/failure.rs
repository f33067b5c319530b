//! What a command returns when it cannot do what was asked.

use crate::blame::Blame;
use crate::io::FileError;
use std::process::ExitCode;

/// A failed command: the report for the terminal and who has to act.
#[derive(Debug)]
pub struct Failure {
    /// Decides the exit code.
    pub blame: Blame,
    /// What went wrong, with spans into the source text where there are any.
    pub report: miette::Report,
}

impl Failure {
    /// A failure with a plain message.
    pub fn new(blame: Blame, message: impl std::fmt::Display) -> Self {
        Self {
            blame,
            report: miette::miette!("{message}"),
        }
    }

    /// A failure with a plain message and the remedy.
    pub fn with_help(
        blame: Blame,
        message: impl std::fmt::Display,
        help: impl std::fmt::Display,
    ) -> Self {
        Self {
            blame,
            report: miette::miette!(help = help.to_string(), "{message}"),
        }
    }

    /// Prints the report to stderr and gives the exit code.
    pub fn report(&self) -> ExitCode {
        eprintln!("{:?}", self.report);
        ExitCode::from(match self.blame {
            Blame::Input => 1,
            Blame::Environment => 2,
            Blame::Internal => 3,
            Blame::Interrupted => super::signals::exit_code(),
        })
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::new(error.blame(), error)
    }
}
