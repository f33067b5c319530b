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

/// What is written for any [`Wide`](super::Wide), compiled for an instruction set and run with it.
macro_rules! run_with {
    ($set:expr, |$simd:ident| $run:expr) => {
        match $set {
            $crate::math::lanes::Set::Avx512($simd) => $simd.run(
                #[inline(always)]
                || $run,
            ),
            $crate::math::lanes::Set::Avx2($simd) => $simd.run(
                #[inline(always)]
                || $run,
            ),
        }
    };
}

pub(crate) use run_with;
