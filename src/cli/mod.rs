//! The command line: one file a command.
//!
//! Data goes to stdout, progress and remarks to stderr. Exit codes: 0 done, 1 input refused,
//! 2 environment failed (file, disk, memory), 3 internal error, 130 or 143 stopped by a signal with
//! the finished work kept.

mod bake;
mod cache;
mod check;
mod color;
mod console;
mod convert;
mod export;
mod failure;
mod fiber;
mod figure;
mod gallery;
mod grids;
mod memory;
mod merge;
mod render;
mod schema;
mod signals;
mod skin;
mod species;
mod stdout;
mod table;

pub use console::Console;
pub use failure::Failure;

use crate::blame::Blame;
use crate::io::check_writable;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::path::Path;
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
    /// Show the built-in animals and check species files.
    Species(species::Args),
    /// Draw a fiber like a micrograph, or write it as a mesh or as grids.
    Fiber(fiber::Args),
    /// Trace photons through a fiber into a scattering table.
    Bake(bake::Args),
    /// Put the shards of a bake together.
    Merge(merge::Args),
    /// Render a still of a species: bakes what it needs, grows the fur, traces the picture.
    Render(Box<render::Args>),
    /// Write the fur of a species for other programs: Universal Scene Description.
    Export(export::Args),
    /// Read files of fur back and tell what each program will refuse, ignore or misread.
    Check(check::Args),
    /// Look into scattering tables, dye them, draw them.
    Table(table::Args),
    /// Bring strands from one file format into another.
    Convert(convert::Args),
    /// Show or clear the cache of baked tables.
    Cache(cache::Args),
    /// The library in pictures: a contact sheet, or pages of Markdown.
    Gallery(gallery::Args),
    /// Figures from recipes: several pictures on one sheet, such as those of the paper.
    Figure(figure::Args),
    /// Print the JSON Schema of a file format.
    Schema(schema::Args),
}

/// Parses the command line, runs the command and returns the exit code.
pub fn run() -> ExitCode {
    std::panic::set_hook(Box::new(end_in_order));
    let cli = match Cli::from_words(std::env::args_os()) {
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

impl Cli {
    /// * `words`: the program's name first.
    fn from_words<T: Into<OsString> + Clone>(
        words: impl IntoIterator<Item = T>,
    ) -> Result<Self, clap::Error> {
        let mut matches = with_negative_numbers(Self::command()).try_get_matches_from(words)?;
        Self::from_arg_matches_mut(&mut matches)
    }
}

/// Takes `-3` for a value, of which its option then says what is wrong with it, and not for an option.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| match arg.get_action().takes_values() {
            true => arg.allow_negative_numbers(true),
            false => arg,
        })
        .mut_subcommands(with_negative_numbers)
}

/// A reader that has seen enough (`vair table info x.exr | head`) is no error; any other panic is a
/// defect of this program, on whichever thread it happens. Files under way are temporary and unnamed.
fn end_in_order(panic: &std::panic::PanicHookInfo<'_>) {
    let message = panic.payload_as_str().unwrap_or("unknown");
    if message.starts_with("failed printing to stdout") {
        std::process::exit(0);
    }
    let place = panic
        .location()
        .map(ToString::to_string)
        .unwrap_or_default();
    stdout::tell(format_args!("internal error: {message} at {place}"));
    stdout::tell("this is a defect of vair; please report it with the command line that led here");
    std::process::exit(3);
}

fn dispatch(command: Command, console: &Console) -> Result<(), Failure> {
    match command {
        Command::Render(args) => render::run(&args, console),
        Command::Export(args) => export::run(&args, console),
        Command::Check(args) => check::run(&args, console),
        Command::Schema(args) => schema::run(&args, console),
        Command::Species(args) => species::run(&args, console),
        Command::Table(args) => table::run(&args, console),
        Command::Gallery(args) => gallery::run(&args, console),
        Command::Fiber(args) => fiber::run(&args, console),
        Command::Bake(args) => bake::run(&args, console),
        Command::Merge(args) => merge::run(&args, console),
        Command::Cache(args) => cache::run(&args, console),
        Command::Figure(args) => figure::run(&args, console),
        Command::Convert(args) => convert::run(&args, console),
    }
}

/// That a file can be written to a place, and is what its name says.
///
/// * `what`: with its article; `extension`: without the dot.
fn check_output(path: &Path, what: &str, extension: &str) -> Result<(), Failure> {
    let found = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if !found.eq_ignore_ascii_case(extension) {
        let path = path.display();
        let message = format!("{path}: the name of {what} must end in .{extension}");
        return Err(Failure::new(Blame::Input, message));
    }
    Ok(check_writable(path)?)
}

/// The choice of an option by its name.
fn named<T: clap::ValueEnum>(name: &str) -> Option<T> {
    T::from_str(name, true).ok()
}

/// Runs `work` on a pool of so many threads, or on all cores.
fn with_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    let Some(threads) = threads else {
        return Ok(work());
    };
    if !(1..=1024).contains(&threads) {
        let message = format!("--threads is {threads}, must be 1 to 1024");
        return Err(Failure::new(Blame::Input, message));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Failure::new(Blame::Environment, e))?;
    Ok(pool.install(work))
}
