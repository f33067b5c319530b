//! `vair table`: what is in a table; dye, draw, compare, pack and fit it.

mod compare;
mod dye;
mod fit;
mod info;
mod pack;
mod plot;

use super::{Console, Failure};
use crate::blame::Blame;
use crate::table::TableFile;
use clap::Subcommand;

/// Options of `vair table`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Print everything that a table file says about itself.
    Info(info::Args),
    /// Give a structure table a pigment: absorption levels become linear RGB.
    Dye(dye::Args),
    /// Tell how far a table is from another: relative L2, by bin, without noise.
    Compare(compare::Args),
    /// Make a table small: half floats, fold, few images, quadtrees; tells size and error.
    Pack(pack::Args),
    /// Fit hair shaders in closed form to a table and tell how well they do, per lobe.
    Fit(fit::Args),
    /// Draw the scattering for one incidence: sphere map, lobe, albedo.
    Plot(plot::Args),
}

/// The table at the bin that holds an azimuth, degrees; the table itself if it has but one.
fn at_azimuth(table: TableFile, degrees: f64) -> TableFile {
    let bin = table.azimuths().bin(degrees.to_radians()).bin;
    table.at_azimuth(bin)
}

/// An azimuth was asked for of a table that has none.
fn averaged() -> Failure {
    Failure::with_help(
        Blame::Input,
        "the table averages over azimuths",
        "leave out --azimuth, or bake with --azimuths",
    )
}

/// Runs `vair table`.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    match &args.command {
        Command::Info(args) => info::run(args),
        Command::Dye(args) => dye::run(args, console),
        Command::Compare(args) => compare::run(args, console),
        Command::Pack(args) => pack::run(args, console),
        Command::Fit(args) => fit::run(args, console),
        Command::Plot(args) => plot::run(args, console),
    }
}
