//! Photon bake: shoots light at a fiber from every inclination and tallies where it leaves.
//!
//! In: a [`Fiber`]. Out: a [`StructureTable`]. A photon is a function of (seed, node, index) and
//! sums are integers, so any number of threads gives the same table to the bit. Light and importance
//! follow the same paths, so the direction that a photon comes from is the one the renderer will ask
//! about and the texels are the directions it will sample.

mod boundary;
mod cache;
mod content;
mod microfacet;
mod photon;
mod tally;

pub use cache::{Cache, CacheSize};
pub use content::content_hash;
pub use photon::{End, Flight, Photon, fly, follow};

use crate::blame::Blame;
use crate::fiber::{Fiber, FiberError};
use crate::math::unicube::Unicube;
use crate::progress::{Cancel, Progress};
use crate::species::Structure;
use crate::table::{Mode, Nodes, Provenance, StructureTable, Undyed};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tally::Tally;

/// How to bake.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Settings {
    /// Paper or cone mode.
    pub mode: Mode,
    /// Inclination nodes, 2..=256.
    pub bins: usize,
    /// Texels along a face edge: a power of two, 4..=512.
    pub face: usize,
    /// Photons over all nodes.
    pub photons: u64,
    /// Reflections, refractions and scatterings after which a photon is given up. The paper's 16
    /// loses up to half the light of pale fibers; at 1000 a closed clear fiber loses nothing.
    pub max_events: u32,
    /// Seed of photons and geometry.
    pub seed: u64,
    /// Optical depths per mean radius, ascending, the first 0, then a geometric series of ratio 2.
    pub levels: Vec<f64>,
    /// Average each map with its mirror image where the fiber allows it: half the variance.
    pub fold: bool,
}

impl Settings {
    /// The paper to the letter: 16 bins, 6 x 64 x 64, a billion photons, 16 events.
    pub fn paper() -> Self {
        Self {
            mode: Mode::Paper,
            max_events: 16,
            fold: false,
            ..Self::cone()
        }
    }

    /// The default: the same storage and count in the cone frame, no light cut off.
    pub fn cone() -> Self {
        Self {
            mode: Mode::Cone,
            bins: 16,
            face: 64,
            photons: 1_000_000_000,
            max_events: 1000,
            seed: 0,
            levels: absorption_levels(12),
            fold: true,
        }
    }
}

/// Level 0 is clear; level k is an optical depth of `0.0125 * 2^(k-1)` per radius. Twelve levels end
/// at 12.8, blacker than black hair (8 x 1.37 = 11); the ratio of 2 makes a level the square of the
/// one before it, so that a photon needs one exponential.
pub fn absorption_levels(count: usize) -> Vec<f64> {
    std::iter::once(0.0)
        .chain((0..).map(|k| 0.0125 * f64::from(1u32 << k)))
        .take(count.clamp(1, tally::MAX_LEVELS))
        .collect()
}

/// A bake that cannot be done or was stopped.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// A setting is out of range.
    #[error("{name} is {found}, must be {expected}")]
    Setting {
        /// Which setting.
        name: &'static str,
        /// Its value.
        found: String,
        /// The allowed range.
        expected: &'static str,
    },
    /// The fiber cannot be built.
    #[error(transparent)]
    Fiber(#[from] FiberError),
    /// Stopped before every direction had been covered once.
    #[error("stopped before the first pass over all directions was complete; nothing was kept")]
    Stopped,
}

impl BakeError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Setting { .. } => Blame::Input,
            Self::Fiber(_) => Blame::Input,
            Self::Stopped => Blame::Interrupted,
        }
    }
}

/// A finished (or stopped) bake.
#[derive(Debug)]
pub struct Baked<T = StructureTable> {
    /// The table, or what holds three of them.
    pub table: T,
    /// False if the bake was stopped; the table then holds the passes that were complete.
    pub complete: bool,
}

/// Photons that one thread flies between two looks at the cancel flag.
const BATCH: u64 = 4096;

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

/// Part `index` of `total` split into `parts` as evenly as integers allow.
fn share(total: u64, parts: u64, index: u64) -> u64 {
    total / parts + u64::from(index < total % parts)
}

fn check(settings: &Settings) -> Result<(), BakeError> {
    let refuse = |name, found: String, expected| {
        Err(BakeError::Setting {
            name,
            found,
            expected,
        })
    };
    if !(2..=256).contains(&settings.bins) {
        return refuse("bins", settings.bins.to_string(), "2 to 256");
    }
    if !settings.face.is_power_of_two() || !(4..=512).contains(&settings.face) {
        return refuse(
            "face",
            settings.face.to_string(),
            "a power of two from 4 to 512",
        );
    }
    // Above 2^32 photons the fixed-point sums of one texel could overflow.
    let least = settings.bins as u64 * PASSES;
    if !(least..1 << 32).contains(&settings.photons) {
        return refuse(
            "photons",
            settings.photons.to_string(),
            "8 a bin to 4294967295",
        );
    }
    if !(1..=1_000_000).contains(&settings.max_events) {
        return refuse(
            "max-events",
            settings.max_events.to_string(),
            "1 to 1000000",
        );
    }
    Ok(())
}

/// The photons of one node.
struct Shot<'a> {
    fiber: &'a Fiber,
    settings: &'a Settings,
    nodes: &'a Nodes,
    cube: &'a Unicube,
    node: usize,
}

impl Shot<'_> {
    /// Flies a range of photon indices on all threads. `None` if cancelled.
    fn fly_range(
        &self,
        range: std::ops::Range<u64>,
        progress: &dyn Progress,
        cancel: &Cancel,
    ) -> Option<Tally> {
        let next = AtomicU64::new(range.start);
        let workers = rayon::current_num_threads();
        let tallies: Vec<Tally> = (0..workers)
            .into_par_iter()
            .map(|_| {
                let mut tally = Tally::new(self.cube.texels(), self.settings.levels.len());
                while !cancel.is_cancelled() {
                    let start = next.fetch_add(BATCH, Ordering::Relaxed);
                    if start >= range.end {
                        break;
                    }
                    let end = (start + BATCH).min(range.end);
                    for index in start..end {
                        self.fly_one(index, &mut tally);
                    }
                    progress.advance(end - start);
                }
                tally
            })
            .collect();
        if cancel.is_cancelled() {
            return None;
        }
        let mut tallies = tallies.into_iter();
        let mut sum = tallies.next()?;
        for tally in tallies {
            sum.add(&tally);
        }
        Some(sum)
    }

    fn fly_one(&self, index: u64, tally: &mut Tally) {
        let edges = &self.nodes.edges;
        let photon = Photon {
            seed: self.settings.seed,
            stream: ((self.node as u64) << 40) | index,
            sin_range: (edges[self.node].sin(), edges[self.node + 1].sin()),
        };
        let flight = fly(self.fiber, &photon, self.settings.max_events);
        let path = flight.path_um / (0.5 * self.fiber.structure().diameter_um);
        let (share, levels) = (flight.share, &self.settings.levels);
        match flight.end {
            End::Escaped(w) => {
                let w = match self.settings.mode {
                    Mode::Paper => w,
                    Mode::Cone => {
                        let (sin, cos) = (flight.theta - self.nodes.centers[self.node]).sin_cos();
                        crate::math::frame::shift_inclination(w, sin, cos)
                    }
                };
                tally.escape(self.cube.texel(w), share, path, levels);
            }
            End::Absorbed => tally.absorb(levels),
            End::Truncated => tally.truncate(share, path, levels),
            End::Lost => tally.lose(share, path, levels),
            End::Missed => {}
        }
    }
}
