//! What scatters light: tables or a model in closed form.

use super::args::{Args, ModelArg};
use crate::assembly::{self, StationTables};
use crate::bake::Settings;
use crate::bsdf::{AlongStrand, Chiang, DoubleCylinder, HairMaterial};
use crate::cli::{Console, Failure, cache, color};
use crate::groom::GroomSettings;
use crate::skin::Skin;
use crate::species::Species;
use crate::table::{Model, TableFile};

/// The materials of all hair classes. Dyes get the strength that their colors need.
pub(super) fn materials(
    args: &Args,
    species: &mut Species,
    given: &[TableFile],
    skin: &Skin,
    grown: &GroomSettings,
    console: &Console,
) -> Result<Vec<HairMaterial>, Failure> {
    let given_numbers = match args.model {
        ModelArg::Chiang => {
            let model = Chiang::new(&args.chiang);
            Some(HairMaterial::Chiang(AlongStrand::uniform(model)))
        }
        ModelArg::DoubleCylinder => {
            let model = DoubleCylinder::new(&args.double_cylinder);
            Some(HairMaterial::DoubleCylinder(AlongStrand::uniform(model)))
        }
        ModelArg::Table | ModelArg::ChiangFit | ModelArg::DoubleCylinderFit => None,
    };
    if let Some(material) = given_numbers {
        return Ok(vec![material; species.classes.len()]);
    }
    let cache = cache::of_user(args.no_cache, console);
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
    let model = match args.model {
        ModelArg::ChiangFit => Model::Chiang,
        ModelArg::DoubleCylinderFit => Model::DoubleCylinder,
        _ => return Ok(materials),
    };
    console.say(format!("fitting {}", model.name()));
    let fitted = assembly::fitted(&materials, model, console, cancel)?;
    let [least, most] = [f64::min, f64::max].map(|of| fitted.errors.iter().copied().reduce(of));
    console.say(format!(
        "off the tables by {:.0} to {:.0} % (S)",
        100.0 * least.unwrap_or_default(),
        100.0 * most.unwrap_or_default(),
    ));
    Ok(fitted.materials)
}
