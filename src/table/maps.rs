//! A dyed table as plain data: what `dye` makes, what files hold and what the renderer prepares
//! for look-up.

use super::{Ledger, Nodes, Provenance};

/// The scattering of one fiber with one pigment: flux fractions per node and texel in linear
/// Rec.709.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterMaps {
    /// The inclinations.
    pub nodes: Nodes,
    /// Texels along a unicube face edge.
    pub res: usize,
    /// `rgb[node * texels + texel]`: share of the intercepted light that leaves through the texel,
    /// in the node's frame.
    pub rgb: Vec<[f32; 3]>,
    /// `error[node * texels + texel]`: relative standard error of each color, infinity where no photon
    /// arrived, 0 if it is not known.
    pub error: Vec<[f32; 3]>,
    /// Absorption of the cortex per micrometer, linear R, G, B: what it was dyed with.
    pub absorption_per_um: [f64; 3],
    /// Mean radius of the fiber, micrometers.
    pub radius_um: f64,
    /// Ledgers of the undyed level, per node: photons, truncation and loss of the bake. One a node, or
    /// three (R, G, B) where materials differ by color and each channel was baked by itself.
    pub ledger: Vec<Ledger>,
    /// Where the table comes from.
    pub provenance: Provenance,
}

impl ScatterMaps {
    /// Texels of one map.
    pub fn texels(&self) -> usize {
        6 * self.res * self.res
    }

    /// How many bakes they come from: 1, or 3 for R, G and B.
    pub fn bakes(&self) -> usize {
        (self.ledger.len() / self.nodes.len().max(1)).max(1)
    }

    /// Photons over all nodes; those of one bake where there are three.
    pub fn photons(&self) -> f64 {
        let ledgers = self.ledger.iter().step_by(self.bakes());
        ledgers.map(Ledger::photons).sum()
    }

    /// The map of one node.
    pub fn map(&self, node: usize) -> &[[f32; 3]] {
        let n = self.texels();
        &self.rgb[node * n..(node + 1) * n]
    }

    /// Share of the intercepted light that leaves, for one node: the sum of its texels.
    pub fn albedo(&self, node: usize) -> [f64; 3] {
        self.map(node).iter().fold([0.0; 3], |sum, texel| {
            std::array::from_fn(|c| sum[c] + f64::from(texel[c]))
        })
    }
}
