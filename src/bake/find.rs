//! The tables of a structure: from the cache, or baked and put there.

use super::settings::check;
use super::{BakeError, Baked, Cache, Settings, bake, content_hash};
use crate::fiber::Fiber;
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Provenance, StructureTable, Undyed};

/// The tables of a structure from the cache or baked: one, or one a channel where its materials differ
/// by color. Channels are baked with the same seed and photons each, so that they differ by what the
/// materials do and not by noise.
///
/// A stopped bake is returned but not kept. A cache that cannot be written to costs the next bake
/// its time and is no error.
pub fn find_or_bake(
    structure: &Structure,
    settings: &Settings,
    provenance: Provenance,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked<Undyed>, BakeError> {
    check(settings)?;
    let gray = |structure: &Structure, provenance| {
        find_or_bake_gray(structure, settings, provenance, cache, progress, cancel)
    };
    if !structure.is_colored() {
        let baked = gray(structure, provenance)?;
        return Ok(Baked {
            table: Undyed::Gray(Box::new(baked.table)),
            complete: baked.complete,
        });
    }
    let red = gray(&structure.channel(0), provenance.clone())?;
    let green = gray(&structure.channel(1), provenance.clone())?;
    let blue = gray(&structure.channel(2), provenance)?;
    Ok(Baked {
        complete: red.complete && green.complete && blue.complete,
        table: Undyed::Colored(Box::new([red.table, green.table, blue.table])),
    })
}

fn find_or_bake_gray(
    structure: &Structure,
    settings: &Settings,
    provenance: Provenance,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked, BakeError> {
    let content = content_hash(structure, settings);
    if let Some(table) = cache.and_then(|cache| cache.get(&content)) {
        // The same fiber may have been baked for another species: the table keeps its numbers and
        // takes the new name.
        let provenance = Provenance {
            species: provenance.species,
            class: provenance.class,
            station: provenance.station,
            species_text: provenance.species_text,
            ..table.provenance
        };
        return Ok(Baked {
            table: StructureTable {
                provenance,
                ..table
            },
            complete: true,
        });
    }
    let fiber = Fiber::build(structure, settings.seed)?;
    let baked = bake(&fiber, settings, provenance, progress, cancel)?;
    if let (true, Some(cache)) = (baked.complete, cache) {
        let _ = cache.put(&baked.table);
    }
    Ok(baked)
}
