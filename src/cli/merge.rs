//! `vair merge`: the shards of a bake or of a picture put together, to the bit what one run would have given.

use super::bake::{report, write_table};
use super::render::output::{self, Format, Look, Origin};
use super::{Console, Failure};
use crate::bake::{Sums, SumsError};
use crate::blame::Blame;
use crate::io::check_writable;
use crate::render::{FilmSums, FilmSumsError};
use std::path::PathBuf;

/// Arguments of `vair merge`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair bake human --photons 1e10 --shard 1/3 -o human-1.safetensors     # on three machines
  vair merge human-1.safetensors human-2.safetensors human-3.safetensors -o human.exr
  vair merge human-1.safetensors human-2.safetensors -o human-12.safetensors
  vair render red-fox --samples 0..64 -o fox-1.safetensors              # the same for a picture
  vair render red-fox --samples 64..128 -o fox-2.safetensors
  vair merge fox-1.safetensors fox-2.safetensors -o fox.exr

A table needs all photons of the bake; a .safetensors file takes what there is and can be merged
further. The order of the files does not matter. Files of different bakes, with photons in common or
with a gap between them are refused by name.")]
pub(super) struct Args {
    /// Files that `vair bake --shard`, `vair render --samples` or `vair merge` wrote.
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    /// Where the result goes: a table or a picture (.exr), the sums of a part (.safetensors), or a picture
    /// (.png).
    #[arg(long, short)]
    output: PathBuf,
    #[command(flatten)]
    look: Look,
}

/// Runs the command.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    // Files of a picture say so; any other is taken for a bake's, whose reader knows what may be wrong.
    for path in args.shards.iter().take(1) {
        if FilmSums::are_in(path)? {
            return merge_pictures(args);
        }
    }
    let extension = args.output.extension().and_then(|e| e.to_str());
    let to_sums = match extension {
        Some("safetensors") => true,
        Some("exr") => false,
        _ => {
            let message = format!("{} is no kind of result", args.output.display());
            let help = "end the name in .exr for a table, in .safetensors for sums";
            return Err(Failure::with_help(Blame::Input, message, help));
        }
    };
    check_writable(&args.output)?;
    let sums = Sums::merge(&args.shards)?;
    if to_sums {
        sums.write(&args.output)?;
        console.say(format!(
            "{} of {} photons",
            sums.photons(),
            sums.photons_of_bake()
        ));
        return Ok(());
    }
    let table = sums.tables().map_err(|error| match error {
        SumsError::Gap { .. } => {
            let help = "merge with the missing shards, or into a .safetensors file";
            Failure::with_help(error.blame(), error, help)
        }
        other => other.into(),
    })?;
    write_table(&table, sums.dye(), &args.output)?;
    report(table.tables(), console);
    Ok(())
}

fn merge_pictures(args: &Args) -> Result<(), Failure> {
    let format = output::format_of(&args.output)?;
    check_writable(&args.output)?;
    let read = |path: &PathBuf| Ok((path.clone(), FilmSums::read(path)?));
    let parts = args.shards.iter().map(read);
    let sums = FilmSums::merge(parts.collect::<Result<_, FilmSumsError>>()?)?;
    let origin = match Origin::of(&sums) {
        Some(origin) => origin,
        None if format == Format::Sums => return Ok(sums.write(&args.output)?),
        None => return Err(FilmSumsError::Foreign { what: "the scene" }.into()),
    };
    let outputs = std::slice::from_ref(&args.output);
    output::write(outputs, &args.look, &sums.film(), &origin, || sums.clone())
}
