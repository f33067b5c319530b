//! The coats that `vair export` is asked for.

use super::Args;
use crate::blame::Blame;
use crate::cli::Failure;
use crate::export::asset::identifier;
use crate::species::{self, Species};
use std::path::Path;

/// An animal in one of the coats.
pub(super) struct Dressed {
    /// Name of the variant: the file's without its ending, if the coat is a file.
    pub(super) name: String,
    pub(super) species: Species,
}

/// The animal in each coat, the one that is shown first; never empty.
///
/// # Errors
/// An animal or a coat that is not there or wrong; two of one name.
pub(super) fn dressed(args: &Args) -> Result<Vec<Dressed>, Failure> {
    let mut species = species::load(&args.name, &args.set)?;
    if let Some(color) = args.color {
        species.dye(color);
    }
    let coats: Vec<Option<&String>> = match args.coats.as_slice() {
        [] => vec![args.coat.as_ref()],
        coats => coats.iter().map(Some).collect(),
    };
    let mut dressed: Vec<Dressed> = Vec::with_capacity(coats.len());
    for coat in coats {
        let mut species = species.clone();
        let mut name = String::new();
        if let Some(coat) = coat {
            let coat = coat.trim();
            species.wear(coat)?;
            let stem = Path::new(coat).file_stem().unwrap_or_default();
            name = identifier(&stem.to_string_lossy());
        }
        if dressed.iter().any(|other| other.name == name) {
            let message = format!("--coats has two coats of the name {name}");
            return Err(Failure::new(Blame::Input, message));
        }
        dressed.push(Dressed { name, species });
    }
    Ok(dressed)
}
