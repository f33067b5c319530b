//! `vair cache`: where baked tables and sums are kept, how much there is, and away with it.

use super::stdout::print;
use super::{Console, Failure};
use crate::bake::Cache;
use crate::blame::Blame;

/// Arguments of `vair cache`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Folder, number of tables and of bakes that can go on, their size.
    Info,
    /// Remove all of it.
    Clear,
}

/// Runs the command.
pub(super) fn run(args: &Args, _console: &Console) -> Result<(), Failure> {
    let cache = Cache::of_user().ok_or_else(no_cache)?;
    let (what, size) = match args.action {
        Action::Info => ("holds", cache.size()),
        Action::Clear => ("is now rid of", cache.clear()),
    };
    let megabytes = size.bytes as f64 / 1e6;
    print(&format!(
        "{} {what} {} tables and sums of {} bakes, {megabytes:.1} MB\n",
        cache.folder().display(),
        size.tables,
        size.sums
    ))
}

/// The user's cache, if it is wanted; whether something can be kept there is said before any work.
pub(super) fn of_user(unwanted: bool, console: &Console) -> Option<Cache> {
    let cache = Cache::of_user().filter(|_| !unwanted)?;
    if let Err(error) = cache.check() {
        console.say(format!(
            "warning: {error}: what is baked will be baked again the next time; VAIR_CACHE may name another folder"
        ));
    }
    Some(cache)
}

fn no_cache() -> Failure {
    let help = "set VAIR_CACHE to a folder, or pass --no-cache";
    Failure::with_help(
        Blame::Environment,
        "this system names no cache folder",
        help,
    )
}
