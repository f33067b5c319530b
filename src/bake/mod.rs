//! Photon bake: shoots light at a fiber from every inclination and tallies where it leaves.
//!
//! In: a [`Fiber`]. Out: a [`StructureTable`]. A photon is a function of (seed, node, index) and
//! sums are integers, so any number of threads gives the same table to the bit. Light and importance
//! follow the same paths, so the direction that a photon comes from is the one the renderer will ask
//! about and the texels are the directions it will sample.

#[cfg(test)]
mod alone;
mod boundary;
mod cache;
mod checkpoint;
mod content;
mod cylinder;
mod deposit;
mod difference;
mod entry;
mod find;
mod fork;
mod goal;
mod keep;
mod many;
mod microfacet;
mod noise;
#[cfg(target_arch = "x86_64")]
mod packet;
mod pass;
mod photon;
mod plan;
mod progressive;
mod reconstruct;
mod refine;
mod settings;
mod shard;
mod shot;
mod sums;
mod sums_file;
mod tally;
mod touched;
mod turns;

pub use cache::{Cache, CacheSize};
pub use checkpoint::{Checkpoint, Found, drive};
pub use content::content_hash;
pub use entry::{Photon, Sides, fly, fly_forked};
pub use find::{find, find_or_bake};
pub use goal::{Ended, Goal};
pub use many::fly_all;
pub use photon::{End, Flight, follow};
pub use progressive::Bake;
pub use settings::{BakeError, Settings, absorption_levels};
pub use shard::Shard;
pub use sums::{Sums, SumsError};

use crate::fiber::Fiber;
use crate::progress::{Cancel, Progress};
use crate::table::{Provenance, StructureTable, Undyed};

/// A finished (or stopped) bake.
#[derive(Debug)]
pub struct Baked<T = StructureTable> {
    /// The table, or what holds three of them.
    pub table: T,
    /// False if the bake was stopped; the table then holds the passes that were complete.
    pub complete: bool,
}

/// Bakes a fiber in one go. [`Bake`] is the same in passes.
///
/// * `provenance`: what is already known of the table's origin; seed, events, program and content
///   hash are filled in here.
///
/// # Errors
/// Settings out of range; [`BakeError::Stopped`] if cancelled before the first pass was done.
pub fn bake(
    fiber: &Fiber,
    settings: &Settings,
    provenance: Provenance,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked, BakeError> {
    let bake = Bake::of_fiber(fiber, settings)?.with_origin(provenance, None);
    let ended = bake.run(&Goal::default(), progress, cancel);
    match bake.snapshot()? {
        Undyed::Gray(table) => Ok(Baked {
            table: *table,
            complete: ended == Ended::Photons,
        }),
        // One fiber is one channel.
        Undyed::Colored(_) => Err(BakeError::Stopped),
    }
}
