//! `vair schema`: the JSON Schema of a file format, for editors.

use super::stdout::print_json;
use super::{Console, Failure};
use crate::check;
use crate::species;

/// Prints the JSON Schema of a file format.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair schema species > species.schema.json
  vair schema pattern > pattern.schema.json
  vair schema coat > coat.schema.json
  vair schema scene > scene.schema.json
  vair schema check > check.schema.json")]
pub(super) struct Args {
    /// Which files.
    #[arg(value_enum, default_value_t = Format::Species)]
    format: Format,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Format {
    /// Species files.
    Species,
    /// Recipes of scale patterns.
    Pattern,
    /// Recipes of coats.
    Coat,
    /// Scenes for `vair render`.
    Scene,
    /// What `vair check --json` prints.
    Check,
}

/// Runs the command.
///
/// # Errors
/// Stdout that cannot be written.
pub(super) fn run(args: &Args, _console: &Console) -> Result<(), Failure> {
    let schema = match args.format {
        Format::Species => species::json_schema(),
        Format::Pattern => species::pattern_schema(),
        Format::Coat => species::coat_schema(),
        Format::Scene => species::scene_schema(),
        Format::Check => check::json_schema(),
    };
    print_json(&schema)
}
