//! Why no file was written.

use glam::IVec3;
use std::io;

/// A grid that OpenVDB's format cannot hold, or an output that failed.
#[derive(Debug, thiserror::Error)]
pub enum VdbError {
    /// A leaf or tile does not begin where one can.
    #[error("a block at {at} does not begin at a multiple of its size, {size} voxels")]
    Misaligned {
        /// Its first voxel.
        at: IVec3,
        /// Voxels along its edge.
        size: i32,
    },
    /// Two leaves or tiles cover the same voxels.
    #[error("two blocks cover the voxel {at}")]
    Overlap {
        /// A voxel that both cover.
        at: IVec3,
    },
    /// A block is farther from the origin than indices reach.
    #[error("a block at {at} is beyond the largest index, {limit}: the voxels are too small")]
    TooFar {
        /// Its first voxel.
        at: IVec3,
        /// The largest index.
        limit: i32,
    },
    /// A value is not a number or infinite.
    #[error("grid `{grid}`: the value at voxel {at} is not finite")]
    NotFinite {
        /// Name of the grid.
        grid: String,
        /// The voxel.
        at: IVec3,
    },
    /// A value is too large for half precision.
    #[error(
        "grid `{grid}`: the value at voxel {at} is beyond 65504, the largest half: write it as float"
    )]
    BeyondHalf {
        /// Name of the grid.
        grid: String,
        /// The voxel.
        at: IVec3,
    },
    /// OpenVDB refuses transforms whose voxel volume is this small, and negative or infinite ones.
    #[error(
        "grid `{grid}`: the voxel size is {voxel}, must be finite and at least {least}, or OpenVDB \
         takes the transform as singular: choose a smaller unit of length"
    )]
    Voxel {
        /// Name of the grid.
        grid: String,
        /// The size.
        voxel: f64,
        /// The least size.
        least: f64,
    },
    /// Grids of a file are found by their names.
    #[error("two grids of the file are named `{0}`")]
    Name(String),
    /// The output failed.
    #[error(transparent)]
    Io(#[from] io::Error),
}
