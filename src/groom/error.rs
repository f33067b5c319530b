//! Why no groom was grown.

use crate::blame::Blame;

/// A groom that cannot be grown, with the numbers at fault.
#[derive(Debug, thiserror::Error)]
pub enum GroomError {
    /// Zero strands were asked for.
    #[error("0 strands asked for: a groom needs at least 1")]
    NoStrands,
    /// More strands than the format of their ids allows.
    #[error("{asked} strands asked for: at most {limit} are possible")]
    TooManyStrands {
        /// Strands asked for.
        asked: usize,
        /// Largest number possible.
        limit: usize,
    },
    /// The species has more classes than a strand id can tell apart.
    #[error("the species has {classes} hair classes: at most {limit} are possible")]
    TooManyClasses {
        /// Classes of the species.
        classes: usize,
        /// Largest number possible.
        limit: usize,
    },
    /// Nothing on the skin grows hair.
    #[error("skin `{skin}` grows no hair: its area times density factor is {area_m2} m2")]
    BareSkin {
        /// Name of the skin.
        skin: String,
        /// Area weighted by the density factor, square meters.
        area_m2: f64,
    },
    /// The strands would stand closer than single precision tells apart.
    #[error(
        "{strands} strands on skin `{skin}` would stand {spacing_um:.4} um apart, closer than \
         coordinates of this size can tell apart ({resolution_um:.4} um): is the mesh in meters?"
    )]
    TooDense {
        /// Name of the skin.
        skin: String,
        /// Strands asked for.
        strands: usize,
        /// Mean distance of neighbors, micrometers.
        spacing_um: f64,
        /// Least useful distance, micrometers.
        resolution_um: f64,
    },
    /// A number of the species' groom is unusable.
    #[error("hair class `{class}`: groom.{field} is {value}, expected {expected}")]
    BadClass {
        /// Name of the hair class.
        class: String,
        /// Field of the class's groom table.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The skin breaks its own promises (arrays of equal length, finite numbers, indices in range).
    #[error("skin `{skin}`: {reason}")]
    BadSkin {
        /// Name of the skin.
        skin: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Strands cannot be held against the triangles of the skin.
    #[error(
        "skin `{skin}`: strands cannot be held against it: {reason}; mend the mesh, or set \
         groom.collision to near"
    )]
    NoCollisions {
        /// Name of the skin.
        skin: String,
        /// What of it cannot be taken.
        reason: String,
    },
    /// Stopped by the caller.
    #[error("growing was stopped")]
    Cancelled,
}

impl GroomError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::Cancelled => Blame::Interrupted,
            Self::BadSkin { .. } => Blame::Internal,
            _ => Blame::Input,
        }
    }
}
