//! `vair species`: the library as a field guide, and the files of users.

mod check;
mod list;
mod new;
mod prose;
mod report;
mod show;

pub(super) use show::page as field_guide;

use super::stdout::{print, print_json};
use super::{Console, Failure};
use crate::species::{Origins, Species};
use clap::Subcommand;
use serde_json::json;

/// Options of `vair species`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair species                          the library, family by family
  vair species show red-fox             what its hair looks like, and where each number comes from
  vair species new my-cat --from cat    starts a file of yours
  vair species check my-cat.toml        everything that is wrong with it, at once")]
pub(super) struct Args {
    /// Print JSON.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the built-in species, family by family (the default).
    #[command(after_help = list::EXAMPLES)]
    List,
    /// Show a species like a field guide: its hairs from root to tip, and the origin of each number.
    Show(show::Args),
    /// Start a species file from one that is there.
    New(new::Args),
    /// Check species files and report everything that is wrong with them.
    Check(check::Args),
}

/// Runs the command.
///
/// # Errors
/// A species that cannot be loaded, a file that cannot be written.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    match &args.action {
        None | Some(Action::List) => list::run(args.json),
        Some(Action::Show(show)) => show::run(show, args.json),
        Some(Action::New(new)) => new::run(new, args.json, console),
        Some(Action::Check(check)) => check::run(check, args.json),
    }
}

/// What machines get of a species in a line of a list.
fn summary(species: &Species, origins: &Origins) -> serde_json::Value {
    let classes: Vec<&str> = species.classes.iter().map(|c| c.name.as_str()).collect();
    json!({
        "id": species.id,
        "name": species.name,
        "latin": species.latin,
        "family": species.family,
        "group": species.group,
        "synonyms": species.synonyms,
        "summary": species.summary,
        "classes": classes,
        "sourced": origins.sourced(),
        "estimated": origins.estimated(),
    })
}

/// `10 of 80`: the numbers that come from literature.
fn sourced(origins: &Origins) -> String {
    format!("{} of {}", origins.sourced(), origins.numbers.len())
}
