//! Structures whose parts do not fit into each other.

use super::MeshError;
use crate::blame::Blame;

/// A structure that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FiberError {
    /// A designer's mesh that is no fiber.
    #[error(transparent)]
    Mesh(#[from] MeshError),
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
    /// A section that a ray from its center leaves more than once.
    #[error("the section folds over itself: lower `bend` or `dent`, or the aspect")]
    SectionFolds,
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
    /// Not one cell fits across the medulla.
    #[error(
        "cells of {cell_um} um do not fit into a medulla {medulla_um:.2} um wide: lower the size of \
         cells and walls or raise medulla.ratio"
    )]
    CellTooWide {
        /// Width of a cell.
        cell_um: f64,
        /// Least width of the medulla.
        medulla_um: f64,
    },
    /// Nothing is left of a globule inside its film of air.
    #[error(
        "a film of {film_um} um leaves nothing of a globule {globule_um:.2} um thick: lower \
         medulla.kind.film_um or raise spacing"
    )]
    FilmTooThick {
        /// Thickness of the film.
        film_um: f64,
        /// Least diameter of the globule with its film.
        globule_um: f64,
    },
    /// Fusi need cortex to lie in.
    #[error(
        "cortical fusi need {needed_um} um of cortex, here are {cortex_um:.2} um: lower \
         medulla.ratio or set cortex.fusi_per_mm to 0"
    )]
    NoRoomForFusi {
        /// Least thickness of the cortex.
        needed_um: f64,
        /// Its thickness.
        cortex_um: f64,
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
