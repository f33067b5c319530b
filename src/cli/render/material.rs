//! What scatters light: tables or a model in closed form.

use super::args::{Args, ModelArg};
use crate::assembly::{self, StationTables};
use crate::bake::{Cache, Settings};
use crate::blame::Blame;
use crate::bsdf::{AlongStrand, Chiang, HairMaterial};
use crate::cli::{Console, Failure, color};
use crate::groom::GroomSettings;
use crate::skin::Skin;
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

/// The materials of all hair classes. Dyes get the strength that their colors need.
pub(super) fn materials(
    args: &Args,
    species: &mut Species,
    given: &[TableFile],
    skin: &Skin,
    grown: &GroomSettings,
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
    let tables = StationTables::new(species, given, &bake, cache.as_ref(), console, cancel)?;
    color::match_colors(species, &tables, skin, grown, console)?;
    let materials = tables.materials(species)?;
    match args.model {
        ModelArg::ChiangFit => {
            console.say("fitting chiang");
            Ok(assembly::fitted(&materials)?)
        }
        _ => Ok(materials),
    }
}
