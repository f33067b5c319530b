//! The scattering function on unicubes: what a bake writes and what the renderer reads.
//!
//! A [`StructureTable`] holds one map per node (inclination of the query direction) and absorption
//! level; dyeing it with a pigment gives [`ScatterMaps`] of linear RGB.

mod azimuths;
mod check;
mod compare;
mod dye;
mod error;
mod exr;
mod fit;
mod lowrank;
mod maps;
mod nodes;
mod pack;
mod plot;
mod scatter;
mod slice;
mod structure;
mod taps;
mod undyed;

pub use self::exr::{TableFile, format_of, part_name};
pub use azimuths::{AzimuthBin, Azimuths};
pub use compare::{
    AzimuthDifference, BinDifference, ChannelComparison, Comparison, Difference, THETA_MAX_DEG,
    TableRef, compare,
};
pub use error::TableError;
pub use fit::{Fit, LobeFit, Model};
pub use maps::ScatterMaps;
pub use nodes::{Mode, Nodes};
pub use pack::{PackedTable, Packing};
pub use plot::{DifferencePlot, Plot, SmoothCylinder, draw_lobe};
pub use scatter::{Lobe, ScatterTable};
pub use structure::{Ledger, PHOTON, Provenance, StructureTable};
pub use undyed::Undyed;
