//! Photon bake: shoots light at a fiber from every inclination and tallies where it leaves.
//!
//! In: a [`Fiber`]. Out: a [`StructureTable`]. A photon is a function of (seed, node, index) and
//! sums are integers, so any number of threads gives the same table to the bit. Light and importance
//! follow the same paths, so the direction that a photon comes from is the one the renderer will ask
//! about and the texels are the directions it will sample.

mod boundary;
mod cache;
mod content;
mod entry;
mod find;
mod fork;
mod microfacet;
mod photon;
mod settings;
mod shot;
mod tally;

pub use cache::{Cache, CacheSize};
pub use content::content_hash;
pub use entry::{Photon, fly, fly_forked};
pub use find::find_or_bake;
pub use photon::{End, Flight, follow};
pub use settings::{BakeError, Settings, absorption_levels};

use crate::fiber::Fiber;
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::table::{Nodes, Provenance, StructureTable};
use settings::check;
use shot::Shot;
use tally::Tally;

/// A finished (or stopped) bake.
#[derive(Debug)]
pub struct Baked<T = StructureTable> {
    /// The table, or what holds three of them.
    pub table: T,
    /// False if the bake was stopped; the table then holds the passes that were complete.
    pub complete: bool,
}

/// A bake runs in passes over all nodes, so that a stopped one is an even, noisier table.
const PASSES: u64 = 8;

/// Bakes a fiber.
///
/// * `provenance`: what is already known of the table's origin; seed, events, program and content
///   hash are filled in here.
pub fn bake(
    fiber: &Fiber,
    settings: &Settings,
    provenance: Provenance,
    progress: &dyn Progress,
    cancel: &Cancel,
) -> Result<Baked, BakeError> {
    check(settings)?;
    let nodes = Nodes::new(settings.mode, settings.bins);
    let cube = Unicube::new(settings.face);
    let mut tallies: Vec<Tally> = (0..nodes.len())
        .map(|_| Tally::new(cube.texels(), settings.levels.len()))
        .collect();
    let per_node = |node: u64| share(settings.photons, settings.bins as u64, node);

    progress.begin("baking", settings.photons, "photons");
    let mut complete = true;
    'passes: for pass in 0..PASSES {
        let mut fresh = Vec::with_capacity(nodes.len());
        for node in 0..nodes.len() {
            let total = per_node(node as u64);
            let range = total * pass / PASSES..total * (pass + 1) / PASSES;
            let shot = Shot {
                fiber,
                settings,
                nodes: &nodes,
                cube: &cube,
                node,
            };
            match shot.fly_range(range, progress, cancel) {
                Some(tally) => fresh.push(tally),
                None => {
                    complete = false;
                    break 'passes;
                }
            }
        }
        for (sum, tally) in tallies.iter_mut().zip(&fresh) {
            sum.add(tally);
        }
    }
    progress.finish();
    if tallies.iter().any(|t| t.is_empty()) {
        return Err(BakeError::Stopped);
    }
    if settings.fold && fiber.is_mirror_symmetric() {
        for tally in &mut tallies {
            tally.fold(&cube);
        }
    }
    let provenance = Provenance {
        seed: settings.seed,
        max_events: settings.max_events,
        content: content_hash(fiber.structure(), settings),
        program: concat!("vair ", env!("CARGO_PKG_VERSION")).to_owned(),
        ..provenance
    };
    let table = StructureTable {
        nodes,
        res: settings.face,
        levels: settings.levels.clone(),
        radius_um: 0.5 * fiber.structure().diameter_um,
        flux: tallies.iter().flat_map(Tally::flux).collect(),
        error: tallies.iter().flat_map(Tally::error).collect(),
        ledger: tallies.iter().flat_map(Tally::ledger).collect(),
        provenance,
    };
    Ok(Baked { table, complete })
}

/// Part `index` of `total` split into `parts` as evenly as integers allow.
fn share(total: u64, parts: u64, index: u64) -> u64 {
    total / parts + u64::from(index < total % parts)
}
