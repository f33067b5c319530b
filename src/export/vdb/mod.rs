//! Writes OpenVDB files: sparse grids of `float` and `vec3s` that OpenVDB's own library reads.
//!
//! File format version 224, tree configuration 5-4-3, as OpenVDB 10 writes it. The format has no
//! document; what is written here follows what the library does when it reads and writes
//! (`io/Archive.cc`, `io/Compression.h`, `tree/*Node.h` of OpenVDB 10.0), and it is judged by that
//! library alone: `tests/clients/vdb.sh` reads every kind of file back, bit by bit.
//!
//! The module uses nothing else of this crate. A grid is a [`Tree`] of 8 x 8 x 8 leaves with a name
//! and a transform; a [`Writer`] puts one grid after the other into any seekable output.
//!
//! ```
//! use glam::IVec3;
//! use vair::export::vdb::{Class, Compression, Grid, Leaf, Tree, Writer};
//!
//! let mut leaf = Leaf::new(IVec3::ZERO, 0.0f32);
//! leaf.set(IVec3::new(1, 2, 3), 0.5);
//! let grid = Grid {
//!     name: "density".into(),
//!     class: Class::FogVolume,
//!     voxel: 0.01,
//!     half: false,
//!     metadata: Vec::new(),
//!     tree: Tree::new(0.0, vec![leaf], Vec::new())?,
//! };
//! let mut writer = Writer::new(std::io::Cursor::new(Vec::new()), Compression::Zip, "example")?;
//! writer.grid(&grid)?;
//! let bytes = writer.finish()?.into_inner();
//! assert_eq!(&bytes[..8], [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0]);
//! # Ok::<(), vair::export::vdb::VdbError>(())
//! ```

mod error;
mod grid;
mod metadata;
mod pack;
mod topology;
mod tree;
mod value;
mod writer;

#[cfg(test)]
mod tests;

pub use error::VdbError;
pub use grid::{Class, Grid, VectorKind};
pub use metadata::Meta;
pub use pack::Compression;
pub use tree::{Leaf, Tile, TileSize, Tree};
pub use value::Value;
pub use writer::Writer;

/// Voxels along the edge of a leaf.
pub const LEAF: i32 = 8;
/// Voxels along the edge of a node of 16 x 16 x 16 leaves.
pub const LOWER: i32 = 128;
/// Voxels along the edge of a node of 32 x 32 x 32 lower nodes.
pub const UPPER: i32 = 4096;
