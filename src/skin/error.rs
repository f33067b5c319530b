//! Why a skin was refused.

use crate::blame::Blame;

/// A skin that cannot be used: which, what is wrong and where.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// Neither a built-in name nor something that looks like a mesh file.
    #[error("no skin named `{name}`: expected one of {} or a path to an .obj or .ply file", super::BUILT_IN.join(", "))]
    UnknownName {
        /// What was asked for.
        name: String,
    },
}

impl SkinError {
    /// Who has to act.
    pub fn blame(&self) -> Blame {
        match self {
            Self::UnknownName { .. } => Blame::Input,
        }
    }
}
