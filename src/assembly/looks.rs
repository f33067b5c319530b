//! Hair shaders in closed form for other renderers, fitted to the tables of a species.

use super::{AssemblyError, Source, StationTables, baked_source, coat_parts};
use crate::bake::{BakeError, Cache, Settings};
use crate::bsdf::CoatPart;
use crate::export::asset::{ClassLook, HairLook, LobeError};
use crate::progress::{Cancel, Progress};
use crate::species::Species;
use crate::table::{Fit, Model};

/// Chiang's hair model fitted to every hair class and zone of pigment: to the table of the station where
/// the hair is widest, dyed for each zone.
///
/// * `tables`: of all stations, if they are there already. * `settings`: of the bakes that the cache does not hold; azimuths are averaged over.
///
/// # Errors
/// A fiber that cannot be built, dyed or fitted, or [`BakeError::Stopped`].
pub fn looks(
    species: &Species,
    tables: Option<&StationTables<'_>>,
    settings: &Settings,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Vec<ClassLook>, AssemblyError> {
    let settings = Settings {
        azimuths: 1,
        ..settings.clone()
    };
    let mut looks = Vec::with_capacity(species.classes.len());
    for (index, class) in species.classes.iter().enumerate() {
        let Some(station) = class.widest() else {
            continue;
        };
        let own: Source<'_>;
        let table = match tables.and_then(|tables| tables.at(species, index, station)) {
            Some(table) => table,
            None => {
                own = baked_source(species, class, station, &settings, cache, progress, cancel)?;
                &own
            }
        };
        let (parts, dyes) = coat_parts(&species.pigments(index));
        progress.begin("fitting", dyes.len() as u64, "materials");
        let mut fitted = Vec::with_capacity(dyes.len());
        for band in &dyes {
            if cancel.is_cancelled() {
                return Err(BakeError::Stopped.into());
            }
            let maps = table.dye(band.absorption_per_um())?;
            fitted.push(look(&Model::Chiang.fit(&maps, &[0, 1, 2])?));
            progress.advance(1);
        }
        progress.finish();
        let zones = |part: &CoatPart| part.dyes.iter().map(|&dye| fitted[dye].clone()).collect();
        looks.push(ClassLook {
            station: station.at,
            parts: parts.iter().map(zones).collect(),
        });
    }
    Ok(looks)
}

fn look(fit: &Fit) -> HairLook {
    let number = |name: &str| fit.parameter(name).unwrap_or_default();
    HairLook {
        ior: number("eta"),
        longitudinal: number("beta_m"),
        azimuthal: number("beta_n"),
        tilt_deg: number("alpha_deg"),
        absorption: std::array::from_fn(|c| fit.absorption[c]),
        error: std::array::from_fn(|c| fit.error[c]),
        lobes: (fit.model.lobes().iter().zip(&fit.lobes))
            .map(|(name, lobe)| LobeError {
                name,
                table: lobe.table,
                model: lobe.model,
                error: lobe.error,
            })
            .collect(),
    }
}
