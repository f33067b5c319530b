//! Why a layer was refused.

use crate::cursor::Misread;

/// A file that is no layer, or a broken one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UsdFileError {
    /// Neither text nor a crate file nor a package.
    #[error("it is no USD file: it does not begin with #usda, PXR-USDC or PK")]
    NotUsd,
    /// A package that is no zip archive.
    #[error("it is no package: a .usdz is a zip archive and begins with PK")]
    NotPackage,
    /// A crate file older or newer than what is read.
    #[error("crate files of version {0} are not read, only 0.4.0 to 0.255")]
    Version(String),
    /// The file does not say what it should.
    #[error("{place}: {reason}")]
    Invalid {
        /// Line or byte.
        place: String,
        /// What is wrong there.
        reason: String,
    },
    /// More than this program takes.
    #[error("it unfolds to more numbers, tokens or prims than a file of its size should")]
    TooLarge,
}

impl UsdFileError {
    /// Something wrong at a place.
    pub(super) fn at(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Invalid {
            place: place.into(),
            reason: reason.into(),
        }
    }
}

impl From<Misread> for UsdFileError {
    fn from(misread: Misread) -> Self {
        Self::at(format!("byte {}", misread.at), misread.reason)
    }
}
