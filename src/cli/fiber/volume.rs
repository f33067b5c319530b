//! A fiber as grids.

use super::super::grids::write_grids;
use super::super::{Console, Failure};
use crate::export::vdb::Meta;
use crate::export::volume::{FiberGrids, write_fiber};
use crate::fiber::Fiber;
use crate::micrograph::absorption_at;
use crate::species::{HairClass, Species, Station};
use std::path::Path;

/// Writes one period of a fiber as an OpenVDB file.
pub(super) fn write(
    path: &Path,
    (species, class, station): (&Species, &HairClass, &Station),
    fiber: &Fiber,
    voxel_um: Option<f64>,
    half: bool,
    console: &Console,
) -> Result<(), Failure> {
    let entries = [
        ("vair_species", species.id.clone()),
        ("vair_class", class.name.clone()),
        ("vair_station", station.at.to_string()),
        ("vair_period_um", fiber.period_um().to_string()),
    ];
    let entry = |(name, text): (&str, String)| (name.to_owned(), Meta::Text(text));
    let settings = FiberGrids {
        voxel_um,
        half,
        absorption_per_um: absorption_at(class, station),
        provenance: entries.into_iter().map(entry).collect(),
    };
    let voxel = write_grids(path, |file| {
        write_fiber(file, fiber, &settings, console, console.cancel())
    })?;
    console.say(format!("{}: voxels of {voxel:.4} um", path.display()));
    Ok(())
}
