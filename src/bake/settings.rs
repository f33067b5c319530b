//! What a bake is asked for, its limits and its errors.

use super::tally;
use crate::blame::Blame;
use crate::fiber::{Fiber, FiberError};
use crate::sampling::hash64;
use crate::table::Mode;

/// How to bake.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Settings {
    /// Paper or cone mode.
    pub mode: Mode,
    /// Inclination nodes, 2..=256.
    pub bins: usize,
    /// Bins of query azimuth around the section, 1..=64, at most 256 nodes in all; 1 averages over all
    /// of them. Cone mode, and no twist.
    #[serde(default = "averaged", skip_serializing_if = "is_averaged")]
    pub azimuths: usize,
    /// Texels along a face edge: a power of two, 4..=512.
    pub face: usize,
    /// Photons over all nodes.
    pub photons: u64,
    /// Reflections, refractions and scatterings after which a photon is given up. The paper's 16
    /// loses up to half the light of pale fibers; at 1000 a closed clear fiber loses nothing.
    pub max_events: u32,
    /// Seed of the fiber: which one of its kind it is. [`super::Bake::new`] builds it with that. Fibers of
    /// different seeds meet different photons, too.
    pub seed: u64,
    /// Seed of the photons: others fly other photons through the same fiber, so that two bakes differ
    /// by noise alone.
    pub photon_seed: u64,
    /// Optical depths per mean radius, ascending, the first 0, then a geometric series of ratio 2.
    pub levels: Vec<f64>,
    /// Average each map with its mirror image where the fiber allows it: half the variance. Of several
    /// azimuths the symmetry of the section makes maps the same, and photons of all go into one.
    pub fold: bool,
    /// Follow both what the surface reflects and what goes in, where light first meets the fiber.
    pub fork: bool,
    /// Take noise off the maps of a table. Sums of photons, and so what is kept of a bake to go on
    /// with, are never touched.
    pub reconstruct: bool,
}

impl Settings {
    /// The paper to the letter: 16 bins, 6 x 64 x 64, a billion photons, 16 events.
    pub fn paper() -> Self {
        Self {
            mode: Mode::Paper,
            max_events: 16,
            fold: false,
            fork: false,
            reconstruct: false,
            ..Self::cone()
        }
    }

    /// What the random numbers of the photons start from: the fiber's seed where the photons have none
    /// of their own.
    pub(super) fn seed_of_photons(&self) -> u64 {
        self.seed ^ hash64(self.photon_seed) ^ hash64(0)
    }

    /// Nodes of inclination and azimuth.
    pub fn nodes(&self) -> usize {
        self.bins * self.azimuths
    }

    /// As many photons as the sums of so many nodes can hold.
    pub fn most_photons(nodes: usize) -> u64 {
        MOST_A_NODE * nodes as u64
    }

    /// The default: the same storage and count in the cone frame, no light cut off.
    pub fn cone() -> Self {
        Self {
            mode: Mode::Cone,
            bins: 16,
            azimuths: 1,
            face: 64,
            photons: 1_000_000_000,
            max_events: 1000,
            seed: 0,
            photon_seed: 0,
            levels: absorption_levels(12),
            fold: true,
            fork: true,
            reconstruct: true,
        }
    }
}

fn averaged() -> usize {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_averaged(azimuths: &usize) -> bool {
    *azimuths == 1
}

/// The first level that is not clear. Higher, and albedos of human hair, in which some light stays
/// long, are off by more than half a percent in the interval before it.
const FIRST_LEVEL: f64 = 0.08;

/// Level 0 is clear; level k is an optical depth of `0.08 * 2^(k-1)` per radius. Twelve levels end at
/// 82, beyond black in the thickest hairs (a moose's, 74); the ratio of 2 makes a level the square of
/// the one before it, so that a photon needs one exponential.
pub fn absorption_levels(count: usize) -> Vec<f64> {
    std::iter::once(0.0)
        .chain((0..).map(|k| FIRST_LEVEL * f64::from(1u32 << k)))
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
    /// Stopped before the table was complete, or before there was any.
    #[error("stopped before the table was complete")]
    Stopped,
    /// A table is asked of a shard that does not begin with the first photon.
    #[error("a part of a bake has no table: merge it with the others")]
    Part,
    /// Sums and tables do not fit into the memory that is allowed.
    #[error(
        "a bake of these sizes needs {} MB on one thread; {} MB are allowed",
        needed.div_ceil(1_000_000), limit / 1_000_000
    )]
    Memory {
        /// Bytes needed on one thread.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
}

impl BakeError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Setting { .. } => Blame::Input,
            Self::Fiber(_) | Self::Memory { .. } | Self::Part => Blame::Input,
            Self::Stopped => Blame::Interrupted,
        }
    }
}

/// Most bins of azimuth, and most nodes in all.
const MOST_AZIMUTHS: usize = 64;
const MOST_NODES: usize = 256;
/// Below this a table is all holes.
const LEAST_A_NODE: u64 = 8;
/// A sum of this many photons in units of 2^-32 still fits 64 bits, whatever texel they go to. With
/// 16 nodes these are 6.9e10 photons. (One may come on top by uneven division: it fits, too.)
const MOST_A_NODE: u64 = (1 << 32) - 2;

/// Refuses several azimuths of fibers that turn them over.
pub(super) fn check_sides(fibers: &[&Fiber], settings: &Settings) -> Result<(), BakeError> {
    let twisted = |fiber: &&Fiber| fiber.structure().twist_turns_per_cm != 0.0;
    if settings.azimuths > 1 && fibers.iter().any(twisted) {
        return Err(BakeError::Setting {
            name: "azimuths",
            found: settings.azimuths.to_string(),
            expected: "1 where the fiber is twisted: it shows all its sides",
        });
    }
    Ok(())
}

/// Refuses settings out of range.
pub(super) fn check(settings: &Settings) -> Result<(), BakeError> {
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
    if !(1..=MOST_AZIMUTHS).contains(&settings.azimuths) || settings.nodes() > MOST_NODES {
        return refuse(
            "azimuths",
            settings.azimuths.to_string(),
            "1 to 64, and times the bins at most 256",
        );
    }
    if settings.azimuths > 1 && settings.mode == Mode::Paper {
        return refuse(
            "azimuths",
            settings.azimuths.to_string(),
            "1 in paper mode: the paper averages them",
        );
    }
    let nodes = settings.nodes() as u64;
    if !(LEAST_A_NODE..=MOST_A_NODE).contains(&(settings.photons / nodes)) {
        return refuse(
            "the number of photons over that of nodes",
            (settings.photons / nodes).to_string(),
            "8 to 4294967294",
        );
    }
    if !(1..=tally::MAX_LEVELS).contains(&settings.levels.len()) {
        return refuse(
            "number of levels",
            settings.levels.len().to_string(),
            "1 to 24",
        );
    }
    let levels = &settings.levels;
    let doubles = |pair: &[f64]| (0.5 * pair[1] / pair[0] - 1.0).abs() < 1e-9;
    let first = levels.get(1).is_none_or(|l| *l > 0.0 && l.is_finite());
    if levels[0] != 0.0 || !first || !levels[1..].windows(2).all(doubles) {
        return refuse(
            "levels",
            format!("{levels:?}"),
            "0, then a series in which each is twice the one before",
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
