//! What scatters light: tables or a model in closed form.

use super::args::{Args, ModelArg};
use crate::assembly;
use crate::bake::{Cache, Settings};
use crate::blame::Blame;
use crate::bsdf::{AlongStrand, Chiang, HairMaterial};
use crate::cli::{Console, Failure};
use crate::species::Species;
use crate::table::TableFile;
use std::path::Path;

/// A table whose maps the renderer can look up.
pub(super) fn given_table(path: &Path) -> Result<TableFile, Failure> {
    let table = TableFile::read(path)?;
    let res = match &table {
        TableFile::Structure(table) => table.res,
        TableFile::Scatter(maps) => maps.res,
    };
    if !res.is_power_of_two() {
        let message = format!("{} has {res} texels a face edge", path.display());
        return Err(Failure::with_help(
            Blame::Input,
            message,
            "bake it again with --face 64 or another power of two",
        ));
    }
    Ok(table)
}

/// The materials of all hair classes.
pub(super) fn materials(
    args: &Args,
    species: &Species,
    given: &[TableFile],
    console: &Console,
) -> Result<Vec<HairMaterial>, Failure> {
    if args.model == ModelArg::Chiang {
        let one = || HairMaterial::Chiang(AlongStrand::uniform(Chiang::new(&args.chiang)));
        return Ok(species.classes.iter().map(|_| one()).collect());
    }
    let cache = if args.no_cache {
        None
    } else {
        Cache::of_user()
    };
    let bake = Settings {
        photons: args.bake_photons,
        azimuths: args.azimuths,
        seed: args.seed(),
        ..Settings::cone()
    };
    let cancel = console.cancel();
    let tables = assembly::materials_with(species, given, &bake, cache.as_ref(), console, cancel)?;
    match args.model {
        ModelArg::ChiangFit => {
            console.say("fitting chiang");
            Ok(assembly::fitted(&tables)?)
        }
        _ => Ok(tables),
    }
}
