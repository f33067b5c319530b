//! Eight numbers side by side in AVX-512 or AVX2, each rounded as a plain number would be: the same
//! formula gives the same bits eight at a time and one at a time.
//!
//! What is written with them is written once, for any [`Wide`]. All `unsafe` of the flight of photons is in the
//! instruction sets, here.

mod avx2;
mod avx512;
mod fours;
mod merge;
mod set;
mod single;
#[cfg(test)]
mod tests;
mod vectors;
mod whole;
mod wide;

pub(crate) use avx2::Avx2;
pub(crate) use avx512::Avx512;
pub(crate) use merge::Merge;
pub(crate) use set::{Set, run_with};
pub(crate) use single::{F32x16, Singles};
pub(crate) use vectors::Vectors;
pub(crate) use wide::Wide;

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// How many lanes there are.
pub(crate) const LANES: usize = 8;

/// Eight numbers in memory: a line of the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Row(pub(crate) [f64; LANES]);

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct F64x8<W: Wide>(W, W::Reals);

/// Eight whole numbers.
#[derive(Clone, Copy)]
pub(crate) struct U64x8<W: Wide>(W, W::Wholes);

/// Some of eight lanes.
#[derive(Clone, Copy)]
pub(crate) struct Mask<W: Wide>(W, W::Mask);

impl<W: Wide> F64x8<W> {
    /// All lanes in memory.
    #[inline(always)]
    pub(crate) fn row(self) -> Row {
        self.0.write(self.1)
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt(self.1))
    }

    /// The smaller one, `other` where the two cannot be compared.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self(self.0, self.0.min(self.1, other.1))
    }

    /// The larger one, `other` where the two cannot be compared.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self(self.0, self.0.max(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(self.0, self.0.abs(self.1))
    }

    /// With the sign of another number.
    #[inline(always)]
    pub(crate) fn with_sign_of(self, other: Self) -> Self {
        Self(self.0, self.0.with_sign_of(self.1, other.1))
    }

    /// The whole number below.
    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        Self(self.0, self.0.floor(self.1))
    }

    /// The whole part, of numbers that are not negative and below 2^31; 2^31 or more of all that are -1 or less, larger
    /// or undefined.
    #[inline(always)]
    pub(crate) fn whole(self) -> U64x8<W> {
        U64x8(self.0, self.0.whole(self.1))
    }

    /// The least of all, and the first lane that has it. None of them may be undefined.
    #[inline(always)]
    pub(crate) fn least(self) -> (f64, usize) {
        self.0.least_of_reals(self.1)
    }

    #[inline(always)]
    pub(crate) fn bits(self) -> U64x8<W> {
        U64x8(self.0, self.0.bits_of(self.1))
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask<W> {
        Mask(self.0, self.0.less(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn le(self, other: Self) -> Mask<W> {
        Mask(self.0, self.0.at_most(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn gt(self, other: Self) -> Mask<W> {
        other.lt(self)
    }

    #[inline(always)]
    pub(crate) fn ge(self, other: Self) -> Mask<W> {
        other.le(self)
    }

    #[inline(always)]
    pub(crate) fn is(self, other: Self) -> Mask<W> {
        Mask(self.0, self.0.equal(self.1, other.1))
    }

    /// This in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: Mask<W>, other: Self) -> Self {
        Self(self.0, self.0.choose(mask.1, self.1, other.1))
    }

    /// The lanes of eight entries: lane `i` is entry `index[i]` modulo 8 of this.
    #[inline(always)]
    pub(crate) fn pick(self, index: U64x8<W>) -> Self {
        Self(self.0, self.0.pick(self.1, index.1))
    }
}

impl<W: Wide> Mask<W> {
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0.any(self.1)
    }

    /// One bit a lane, that of the first is the lowest.
    #[inline(always)]
    pub(crate) fn bits(self) -> u8 {
        self.0.bits_of_mask(self.1)
    }

    #[inline(always)]
    pub(crate) fn has(self, lane: usize) -> bool {
        self.bits() >> lane & 1 != 0
    }

    /// The numbers of the lanes.
    #[inline(always)]
    pub(crate) fn lanes(self) -> impl Iterator<Item = usize> {
        let mut rest = self.bits();
        std::iter::from_fn(move || {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest.wrapping_sub(1);
            (lane < LANES).then_some(lane)
        })
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident) => {
        impl<W: Wide> $trait for F64x8<W> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0, self.0.$name(self.1, other.1))
            }
        }

        impl<W: Wide> $trait<f64> for F64x8<W> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                self.$name(self.0.all(other))
            }
        }

        impl<W: Wide> $trait<F64x8<W>> for f64 {
            type Output = F64x8<W>;
            #[inline(always)]
            fn $name(self, other: F64x8<W>) -> F64x8<W> {
                other.0.all(self).$name(other)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<W: Wide> Neg for F64x8<W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg(self.1))
    }
}

impl<W: Wide> BitAnd for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0, self.0.both(self.1, other.1))
    }
}

impl<W: Wide> BitOr for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0, self.0.either(self.1, other.1))
    }
}

impl<W: Wide> BitXor for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitxor(self, other: Self) -> Self {
        Self(self.0, self.0.one_of(self.1, other.1))
    }
}

impl<W: Wide> Not for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0, self.0.others(self.1))
    }
}
