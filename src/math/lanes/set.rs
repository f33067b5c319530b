//! Which instruction set there is.

use super::{Avx2, Avx512};

/// An instruction set of the processor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Set {
    Avx512(Avx512),
    Avx2(Avx2),
}

impl Set {
    /// All that the processor has, the widest first.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let wide = Avx512::detect().map(Self::Avx512);
        let narrow = Avx2::detect().map(Self::Avx2);
        wide.into_iter().chain(narrow)
    }

    /// The widest that the processor has.
    pub(crate) fn detect() -> Option<Self> {
        Self::all().next()
    }
}
