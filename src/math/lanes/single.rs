//! Sixteen numbers of single precision.

use super::Wide;
use std::ops::{Add, Div, Mul, Sub};

/// Sixteen numbers of single precision in memory: a line of the cache.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Singles(pub(crate) [f32; 16]);

/// Sixteen numbers of single precision.
#[derive(Clone, Copy)]
pub(crate) struct F32x16<W: Wide>(pub(super) W, pub(super) W::Shorts);

impl<W: Wide> F32x16<W> {
    /// This where `low` is less than `high`, `other` in the rest.
    #[inline(always)]
    pub(crate) fn where_less(self, low: Self, high: Self, other: Self) -> Self {
        let pair = [low.1, high.1];
        Self(self.0, self.0.choose_less(pair, self.1, other.1))
    }

    /// The least of all, and the first lane that has it. None of them may be undefined.
    #[inline(always)]
    pub(crate) fn least(self) -> (f32, usize) {
        self.0.least(self.1)
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $of_shorts:ident) => {
        impl<W: Wide> $trait for F32x16<W> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0, self.0.$of_shorts(self.1, other.1))
            }
        }
    };
}

operator!(Add, add, add_shorts);
operator!(Sub, sub, sub_shorts);
operator!(Mul, mul, mul_shorts);
operator!(Div, div, div_shorts);
