//! Who has to act on an error, and so which exit code the program ends with.

/// The one question the command line asks of every error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// The input was refused: the user changes it. Exit code 1.
    Input,
    /// A file, the disk or memory failed: the surroundings change. Exit code 2.
    Environment,
    /// A defect of this program. Exit code 3.
    Internal,
    /// Stopped by a signal, finished work kept. Exit code 130 (SIGINT) or 143 (SIGTERM).
    Interrupted,
}
