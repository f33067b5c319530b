//! The tables of a structure: from the cache, or baked and put there.

use super::settings::check;
use super::{
    Bake, BakeError, Baked, Cache, Checkpoint, Ended, Found, Goal, Settings, content_hash, drive,
};
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Provenance, StructureTable, Undyed};

/// The tables of a structure from the cache or baked: one, or one a channel where its materials differ
/// by color. Channels are baked with the same seed and photons each, so that they differ by what the
/// materials do and not by noise.
///
/// Sums of a bake that was stopped are kept in the cache: the next one goes on from there. A cache that
/// cannot be written to costs the next bake its time and is no error.
pub fn find_or_bake(
    structure: &Structure,
    settings: &Settings,
    provenance: Provenance,
    cache: Option<&Cache>,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked<Undyed>, BakeError> {
    check(settings)?;
    if let Some(table) = cache.and_then(|cache| find(structure, settings, &provenance, cache)) {
        return Ok(Baked {
            table,
            complete: true,
        });
    }
    let bake = Bake::new(structure, settings)?.with_origin(provenance, None);
    let mut checkpoint =
        cache.map(|cache| Checkpoint::in_cache(cache, &bake, Checkpoint::EVERY, false));
    if let Some(Ok(Found::Beyond) | Err(_)) = checkpoint.as_mut().map(|c| c.resume(&bake)) {
        checkpoint = None;
    }
    let ended = drive(
        &bake,
        &Goal::default(),
        checkpoint.as_mut(),
        progress,
        cancel,
        &mut |_, _| {},
    );
    let table = bake.snapshot()?;
    let complete = ended == Ended::Photons;
    if let (true, Some(cache)) = (complete, cache) {
        let put = table.tables().iter().try_for_each(|table| cache.put(table));
        if let (Ok(()), Some(checkpoint)) = (put, &mut checkpoint) {
            let _ = checkpoint.finish(&bake);
        }
    }
    Ok(Baked { table, complete })
}

/// The tables of a structure if the cache has them all.
pub fn find(
    structure: &Structure,
    settings: &Settings,
    provenance: &Provenance,
    cache: &Cache,
) -> Option<Undyed> {
    let gray = |structure: &Structure| {
        let table = cache.get(&content_hash(structure, settings))?;
        // The same fiber may have been baked for another species: the table keeps its numbers and
        // takes the new name.
        let provenance = Provenance {
            species: provenance.species.clone(),
            class: provenance.class.clone(),
            station: provenance.station,
            species_text: provenance.species_text.clone(),
            ..table.provenance
        };
        Some(StructureTable {
            provenance,
            ..table
        })
    };
    if !structure.is_colored() {
        return gray(structure).map(|table| Undyed::Gray(Box::new(table)));
    }
    let channel = |channel| gray(&structure.channel(channel));
    Some(Undyed::Colored(Box::new([
        channel(0)?,
        channel(1)?,
        channel(2)?,
    ])))
}
