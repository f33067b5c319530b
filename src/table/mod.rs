//! The scattering function on unicubes: what a bake writes and what the renderer reads.
//!
//! A [`StructureTable`] holds one map per node (inclination of the query direction) and absorption
//! level; dyeing it with a pigment gives a scatter table of linear RGB.

mod nodes;
mod scatter;
mod structure;

pub use nodes::{Mode, Nodes};
pub use scatter::ScatterTable;
pub use structure::{Ledger, PHOTON, Provenance, StructureTable};
