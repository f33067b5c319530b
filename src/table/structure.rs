//! What a bake writes.

use super::Nodes;
use serde::{Deserialize, Serialize};

/// Where the light of one node and absorption level went, in units of 2^-32 photon. Exact:
/// `emitted = escaped + absorbed + truncated + lost` and the texels sum to `escaped`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ledger {
    /// Photons that hit the fiber.
    pub emitted: u64,
    /// Left the fiber.
    pub escaped: u64,
    /// Absorbed by pigment, by other absorbing media and at opaque boundaries.
    pub absorbed: u64,
    /// Still inside after the last allowed event.
    pub truncated: u64,
    /// Found no boundary: a defect of the geometry or of rounding.
    pub lost: u64,
}

impl Ledger {
    /// Photons that hit the fiber.
    pub fn photons(&self) -> f64 {
        self.emitted as f64 / PHOTON as f64
    }
}

/// One photon in the fixed-point unit of [`Ledger`].
pub const PHOTON: u64 = 1 << 32;

/// Where a table comes from; everything needed to bake it again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Species id.
    pub species: String,
    /// Hair class.
    pub class: String,
    /// Position along the hair of the station, 0..1.
    pub station: f64,
    /// Seed of the fiber.
    pub seed: u64,
    /// Seed of the photons.
    pub photon_seed: u64,
    /// Events after which a photon was given up.
    pub max_events: u32,
    /// SHA-256 of structure, settings and format version, in hexadecimal: the name in the cache. Three of
    /// them, separated by blanks, for maps of which each channel was baked by itself.
    pub content: String,
    /// The species file with overrides.
    pub species_text: String,
    /// Version of this program.
    pub program: String,
}

/// The scattering of one fiber for every pigment: flux fractions per node, absorption level and
/// texel.
#[derive(Clone, Debug, PartialEq)]
pub struct StructureTable {
    /// The inclinations.
    pub nodes: Nodes,
    /// Texels along a unicube face edge.
    pub res: usize,
    /// Absorption levels as optical depth per mean radius of the fiber, ascending, the first 0.
    pub levels: Vec<f64>,
    /// Mean radius of the fiber, micrometers: turns an absorption coefficient into a level.
    pub radius_um: f64,
    /// `flux[(node * levels + level) * texels + texel]`: share of the intercepted light that leaves
    /// through the texel, in the node's frame.
    pub flux: Vec<f32>,
    /// `error[node * texels + texel]`: relative standard error of the clear level, infinity where no
    /// photon arrived.
    pub error: Vec<f32>,
    /// `ledger[node * levels + level]`.
    pub ledger: Vec<Ledger>,
    /// Where the table comes from.
    pub provenance: Provenance,
}

impl StructureTable {
    /// Texels of one map.
    pub fn texels(&self) -> usize {
        6 * self.res * self.res
    }

    /// The map of one node and level.
    pub fn map(&self, node: usize, level: usize) -> &[f32] {
        let n = self.texels();
        let start = (node * self.levels.len() + level) * n;
        &self.flux[start..start + n]
    }

    /// Ledger of one node and level.
    pub fn ledger(&self, node: usize, level: usize) -> &Ledger {
        &self.ledger[node * self.levels.len() + level]
    }

    /// Share of the intercepted light that leaves, for one node and level.
    pub fn albedo(&self, node: usize, level: usize) -> f64 {
        let ledger = self.ledger(node, level);
        ledger.escaped as f64 / ledger.emitted.max(1) as f64
    }
}
