//! The command line: one file a command.
//!
//! Data goes to stdout, progress and remarks to stderr. Exit codes: 0 done, 1 input refused,
//! 2 environment failed (file, disk, memory), 3 internal error, 130 or 143 stopped by a signal with
//! the finished work kept.

mod console;
mod failure;
mod species;
mod species_report;
mod table;

pub use console::Console;
pub use failure::Failure;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Animal fur from the micro-structure up: fibers, scattering tables, stills.
#[derive(Debug, Parser)]
#[command(name = "vair", version, max_term_width = 100)]
struct Cli {
    /// Print no progress and no remarks.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Look into scattering tables, dye them, draw them.
    Table(table::Args),
    /// Shows the built-in animals and checks species files.
    Species(species::Args),
}

/// Parses the command line, runs the command and returns the exit code.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // clap exits with 2 by itself; here a bad option is refused input, which is 1.
            let _ = error.print();
            return if error.use_stderr() {
                ExitCode::from(1)
            } else {
                ExitCode::SUCCESS
            };
        }
    };
    let console = Console::new(cli.quiet);
    match dispatch(cli.command, &console) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn dispatch(command: Command, console: &Console) -> Result<(), Failure> {
    match command {
        Command::Table(args) => table::run(&args, console),
        Command::Species(args) => species::run(&args, console),
    }
}
