//! Why no volume was made.

use crate::blame::Blame;
use crate::export::vdb::VdbError;
use glam::Vec3;

/// A volume that cannot be made, with the numbers at fault.
#[derive(Debug, thiserror::Error)]
pub enum VolumeError {
    /// More memory than allowed.
    #[error(
        "voxels of {voxel_mm:.4} mm need {needed_mb:.0} MB of memory for {leaves} leaves of 8 x 8 x 8, \
         more than the limit of {limit_mb:.0} MB: choose larger voxels or a higher limit"
    )]
    Memory {
        /// Edge of a voxel, millimeters.
        voxel_mm: f64,
        /// Leaves of each grid.
        leaves: usize,
        /// Megabytes needed.
        needed_mb: f64,
        /// Megabytes allowed.
        limit_mb: f64,
    },
    /// A voxel size out of range.
    #[error("a voxel of {voxel_mm} mm: must be {least_mm} to {most_mm}")]
    Voxel {
        /// Edge of a voxel, millimeters.
        voxel_mm: f64,
        /// Least edge for the file's unit of length, millimeters.
        least_mm: f64,
        /// Largest edge, millimeters.
        most_mm: f64,
    },
    /// Strands or a mesh too far from the origin for voxels of this size.
    #[error(
        "the place {at} (units) is not finite or too far from the origin for voxels of {voxel} units"
    )]
    TooFar {
        /// The place, units of the file.
        at: Vec3,
        /// Edge of a voxel, units.
        voxel: f64,
    },
    /// Control points so far apart that their voxels cannot be counted.
    #[error(
        "the control points of a strand at {at} (units) are {length} units apart, more than {limit}: \
         choose larger voxels, or look at that strand"
    )]
    LongSpan {
        /// The first of two control points, units of the file.
        at: Vec3,
        /// Distance to the next, units.
        length: f64,
        /// Largest distance possible for this voxel, units.
        limit: f64,
    },
    /// A signed distance needs an inside.
    #[error(
        "the skin `{skin}` is open: {open} of its edges have no face on the other side, so it has no \
         inside; ask for grids without `surface`, close the mesh, or thicken it with --shell-mm"
    )]
    Open {
        /// Name of the skin.
        skin: String,
        /// Edges that are not balanced.
        open: usize,
    },
    /// More voxels across than one signed distance takes.
    #[error(
        "the skin is {across} voxels across: at most {limit} are possible, choose larger voxels"
    )]
    TooFine {
        /// Voxels along the longest axis.
        across: i64,
        /// Largest number possible.
        limit: i64,
    },
    /// More voxels than a fiber may have.
    #[error(
        "voxels of {voxel_um} um: the fiber would have {voxels:.1e} of them, at most {limit:.1e} are possible"
    )]
    FineFiber {
        /// Edge of a voxel, micrometers.
        voxel_um: f64,
        /// Voxels in the fiber.
        voxels: f64,
        /// Largest number possible.
        limit: f64,
    },
    /// Nothing to fill voxels with.
    #[error("there are no strands to fill voxels with, or none of them has a length")]
    Empty,
    /// The grids could not be written.
    #[error(transparent)]
    Vdb(#[from] VdbError),
    /// Stopped by the caller.
    #[error("stopped before the volume was complete; nothing was written")]
    Cancelled,
}

impl VolumeError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Cancelled => Blame::Interrupted,
            Self::Vdb(VdbError::Io(_)) => Blame::Environment,
            _ => Blame::Input,
        }
    }
}
