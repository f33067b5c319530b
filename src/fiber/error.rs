//! Structures whose parts do not fit into each other.

use crate::blame::Blame;

/// A structure that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FiberError {
    /// Scales as high as the fiber is thick.
    #[error(
        "scales of {height_um} um are too high for a fiber with a least radius of {radius_um:.2} um \
         (at most a third of it)"
    )]
    ScalesTooHigh {
        /// Height of the free edge.
        height_um: f64,
        /// Minor semi-axis.
        radius_um: f64,
    },
    /// The medulla reaches the cuticle.
    #[error(
        "the medulla ({medulla_um:.2} um from the axis) reaches the cuticle, whose lowest point is \
         at {cuticle_um:.2} um: lower medulla.ratio or cuticle.height_um"
    )]
    MedullaTooWide {
        /// Minor semi-axis of the medulla.
        medulla_um: f64,
        /// Least radius of the surface.
        cuticle_um: f64,
    },
    /// Nothing is left of the voids of a ladder.
    #[error("septa of {septum_um} um leave no voids in a ladder with a pitch of {pitch_um:.2} um")]
    SeptumTooThick {
        /// Wall between two voids.
        septum_um: f64,
        /// Distance between rungs.
        pitch_um: f64,
    },
    /// Spheres that do not touch cannot fill as much.
    #[error(
        "a froth of {asked} air cannot be packed, only {reached:.3}: lower \
         medulla.kind.air_fraction or radius_um"
    )]
    FrothTooDense {
        /// Share of the medulla that was asked for.
        asked: f64,
        /// Share that could be packed.
        reached: f64,
    },
}

impl FiberError {
    /// Whose move it is: the species file's.
    pub fn blame(&self) -> Blame {
        Blame::Input
    }
}
