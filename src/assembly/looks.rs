//! Hair shaders in closed form for other renderers, fitted to the tables of a species.

use super::{AssemblyError, settings_of, station_table};
use crate::bake::{BakeError, Cache, Settings};
use crate::export::asset::{ClassLook, HairLook, LobeError};
use crate::progress::{Cancel, Progress};
use crate::species::Species;
use crate::table::{Fit, Model};

/// Chiang's hair model fitted to every hair class and zone of pigment: to the table of the station where
/// the hair is widest, dyed for each zone.
///
/// * `settings`: of the bakes that the cache does not hold; azimuths are averaged over.
///
/// # Errors
/// A fiber that cannot be built, dyed or fitted, or [`BakeError::Stopped`].
pub fn looks(
    species: &Species,
    settings: &Settings,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Vec<ClassLook>, AssemblyError> {
    let mut looks = Vec::with_capacity(species.classes.len());
    for (index, class) in species.classes.iter().enumerate() {
        let Some(station) = class.widest() else {
            continue;
        };
        let settings = Settings {
            azimuths: 1,
            ..settings_of(station, settings)
        };
        let baked = station_table(species, class, station, &settings, cache, progress, cancel)?;
        if !baked.complete {
            return Err(BakeError::Stopped.into());
        }
        let pigments = species.pigments(index);
        let bands: usize = pigments.iter().map(|bands| bands.len()).sum();
        progress.begin("fitting", bands as u64, "materials");
        // Parts of a coat share bands; each is fitted once.
        let mut known: Vec<([f64; 3], HairLook)> = Vec::new();
        let mut parts = Vec::with_capacity(pigments.len());
        for bands in pigments {
            let mut zones = Vec::with_capacity(bands.len());
            for band in bands {
                if cancel.is_cancelled() {
                    return Err(BakeError::Stopped.into());
                }
                let absorption = band.absorption_per_um();
                let look = match known.iter().find(|(a, _)| *a == absorption) {
                    Some((_, look)) => look.clone(),
                    None => look(&Model::Chiang.fit(&baked.table.dye(absorption)?, &[0, 1, 2])?),
                };
                known.push((absorption, look.clone()));
                zones.push(look);
                progress.advance(1);
            }
            parts.push(zones);
        }
        progress.finish();
        looks.push(ClassLook {
            station: station.at,
            parts,
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
