//! Tables to live with: tens to hundreds of kilobytes instead of tens of megabytes.
//!
//! What a packed table holds, in the order in which a table becomes one:
//!
//! 1. **Fold.** Where a fiber's scattering is the same on both sides of the plane of incidence (to
//!    within 1 % above noise), one half of each map is kept.
//! 2. **Few images.** Channels are much alike, and so are nodes. Either the channels of each map are
//!    turned into their principal components (Karhunen-Loeve), or all maps become sums of K images
//!    aligned by the specular cone ([`super::lowrank`]).
//! 3. **Quadtrees.** Texels that differ by less than is worth their bits, or by noise, share a value.
//! 4. **Short floats.** Values are half floats with as few bits of mantissa as the size asks for.
//!
//! Unpacking restores the albedo of each map exactly and no flux is negative, so a renderer samples an
//! unpacked table as exactly as any other.

mod choose;
mod fold;
mod prepare;
#[cfg(test)]
mod tests;
mod tree;
mod unpack;

pub(super) use fold::Layout;
pub(super) use tree::Trees;

use super::lowrank::Grid;
use super::{Ledger, Nodes, Provenance, TableError, TableRef};
use std::path::Path;

/// How small a table shall be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packing {
    /// Sums of so many images over the nodes; if not given, each map by itself.
    pub rank: Option<usize>,
    /// Largest file, bytes; if not given, nothing is merged and no mantissa shortened beyond half
    /// floats.
    pub bytes: Option<usize>,
}

/// A table in little space.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedTable {
    pub(super) kind: Kind,
    pub(super) nodes: Nodes,
    pub(super) radius_um: f64,
    pub(super) provenance: Provenance,
    /// `ledger[node * channels + channel]`; of a dyed table's bakes, `ledger[node * bakes + bake]`.
    pub(super) ledger: Vec<Ledger>,
    /// `albedo[node * channels + channel]`.
    pub(super) albedo: Vec<f32>,
    pub(super) code: Code,
}

/// What the channels are.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// Absorption levels.
    Structure { levels: Vec<f64> },
    /// R, G, B.
    Scatter { absorption_per_um: [f64; 3] },
}

/// The maps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Code {
    pub(super) layout: Layout,
    /// Whether images are on the grid aligned by the cone and serve all nodes; else each node has its
    /// own, one after the other.
    pub(super) aligned: bool,
    /// Images in all if aligned, else images of each node.
    pub(super) images: usize,
    /// Density = sum of images times this: `mix[channel * images + image]`, if aligned
    /// `mix[(node * channels + channel) * images + image]`.
    pub(super) mix: Vec<f32>,
    /// All images, tile after tile.
    pub(super) trees: Trees,
}

impl Kind {
    /// Number of channels.
    pub(super) fn channels(&self) -> usize {
        match self {
            Self::Structure { levels } => levels.len(),
            Self::Scatter { .. } => 3,
        }
    }
}

impl Code {
    /// Tiles of all images and the edge of a tile.
    pub(super) fn tiles(&self, nodes: usize) -> (usize, usize) {
        if self.aligned {
            let grid = Grid::new(self.layout);
            (self.images * grid.rows / grid.columns, grid.columns)
        } else {
            (nodes * self.images * self.layout.tiles(), self.layout.res)
        }
    }
}

impl PackedTable {
    /// Packs a table.
    ///
    /// * Errors: a rank of 0 or above the number of maps, a size
    ///   too small to hold anything, several azimuths.
    pub fn new<'a>(table: impl Into<TableRef<'a>>, packing: Packing) -> Result<Self, TableError> {
        let table = table.into();
        table.nodes().only_averaged()?;
        choose::pack(table, packing)
    }

    /// Bytes of the file.
    pub fn size(&self) -> Result<usize, TableError> {
        Ok(super::exr::encode_packed(self, Path::new("size"))?.len())
    }

    /// Color channels or absorption levels.
    pub fn channels(&self) -> usize {
        self.kind.channels()
    }

    /// In words: fold, images, values.
    pub fn describe(&self) -> String {
        let code = &self.code;
        let fold = if code.layout.folded {
            "folded"
        } else {
            "both halves"
        };
        let images = if code.aligned {
            format!("{} images for all nodes", code.images)
        } else {
            format!("{} images a node", code.images)
        };
        let values = code.trees.leaves.len();
        format!("{fold}, {images}, {values} values")
    }
}
