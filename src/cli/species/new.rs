//! `vair species new`: a species file of one's own, started from one that is there.

use super::{Console, Failure, print, print_json};
use crate::blame::Blame;
use crate::io::AtomicFile;
use crate::species;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Options of `vair species new`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair species new my-cat --from cat
  vair species new blue-fox --from \"vulpes lagopus\" -o animals/blue-fox.toml
  vair species new my-cat --from my-other-cat.toml --force")]
pub(super) struct Args {
    /// Id of the new species: lower-case words and hyphens.
    name: String,
    /// Where to start: a built-in species, or path of a .toml file.
    #[arg(long, value_name = "NAME")]
    from: String,
    /// File to write; NAME.toml if not given.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub(super) fn run(args: &Args, as_json: bool, console: &Console) -> Result<(), Failure> {
    check_id(&args.name)?;
    let path = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}.toml", args.name)),
    };
    check_path(&path, args.force)?;
    let base = species::load(&args.from, &[])?;
    let text = species::start_from(&base.text, &base.id, &args.name);
    AtomicFile::write_all_to(&path, text.as_bytes())?;
    let shown = path.display().to_string();
    console.say(format_args!(
        "started from {}; next: vair species check {shown}",
        base.id
    ));
    if as_json {
        print_json(&json!({ "file": shown, "id": args.name, "from": base.id }))
    } else {
        print(&format!("{shown}\n"))
    }
}

fn check_id(name: &str) -> Result<(), Failure> {
    if !species::is_id(name) {
        let message = format!("{name:?} is no name of a species");
        let help = "lower-case words of letters and digits, parted by hyphens: my-cat";
        return Err(Failure::with_help(Blame::Input, message, help));
    }
    if species::ids().any(|id| id == name) {
        let message = format!("there is a built-in species {name} already");
        let help = format!("choose a name of its own: my-{name}");
        return Err(Failure::with_help(Blame::Input, message, help));
    }
    Ok(())
}

/// The file must end in .toml, or no command would take it for a species, and not be there yet.
fn check_path(path: &Path, force: bool) -> Result<(), Failure> {
    let is_toml = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if !is_toml {
        let message = format!("{} does not end in .toml", path.display());
        let help = "the name of a species file ends in .toml";
        return Err(Failure::with_help(Blame::Input, message, help));
    }
    if !force && path.symlink_metadata().is_ok() {
        let message = format!("{} is there already", path.display());
        let help = "--force replaces it, -o names another file";
        return Err(Failure::with_help(Blame::Input, message, help));
    }
    Ok(())
}
