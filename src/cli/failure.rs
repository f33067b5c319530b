//! What a command returns when it cannot do what was asked.

use super::stdout::{harmless, tell};
use crate::blame::Blame;
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
            report: miette::miette!("{}", harmless(&message.to_string())),
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
            report: miette::miette!(
                help = harmless(&help.to_string()).into_owned(),
                "{}",
                harmless(&message.to_string())
            ),
        }
    }

    /// Prints the report to stderr and gives the exit code.
    pub fn report(&self) -> ExitCode {
        tell(format_args!("{:?}", self.report));
        ExitCode::from(match self.blame {
            Blame::Input => 1,
            Blame::Environment => 2,
            Blame::Internal => 3,
            Blame::Interrupted => super::signals::exit_code(),
        })
    }
}

/// Errors that know who has to act become failures with their own message.
macro_rules! failures {
    ($($error:ty),+ $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new(error.blame(), error)
            }
        })+
    };
}

failures!(
    crate::assembly::AssemblyError,
    crate::bake::BakeError,
    crate::bake::SumsError,
    crate::check::CheckError,
    crate::export::lines::LinesError,
    crate::export::volume::VolumeError,
    crate::fiber::FiberError,
    crate::groom::GroomError,
    crate::io::FileError,
    crate::micrograph::MicrographError,
    crate::render::FilmSumsError,
    crate::render::RenderError,
    crate::scene::EnvironmentError,
    crate::scene::SceneError,
    crate::skin::SkinError,
    crate::table::TableError,
);
