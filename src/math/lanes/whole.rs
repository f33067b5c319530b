//! Eight whole numbers.

use super::{F64x8, LANES, Mask, U64x8, Wide};

impl<W: Wide> U64x8<W> {
    /// All lanes in memory.
    #[inline(always)]
    pub(crate) fn array(self) -> [u64; LANES] {
        self.numbers().row().0.map(f64::to_bits)
    }

    /// The bits taken for a number.
    #[inline(always)]
    pub(crate) fn numbers(self) -> F64x8<W> {
        F64x8(self.0, self.0.of_bits(self.1))
    }

    /// As a number with a fraction, of those below 2^52.
    #[inline(always)]
    pub(crate) fn to_f64(self) -> F64x8<W> {
        F64x8(self.0, self.0.real(self.1))
    }

    /// As a number with a fraction; negative ones have the highest bit. Of those from -2^51 up to 2^51.
    #[inline(always)]
    pub(crate) fn signed_to_f64(self) -> F64x8<W> {
        F64x8(self.0, self.0.signed_real(self.1))
    }

    #[inline(always)]
    pub(crate) fn right<const BY: u32>(self) -> Self {
        Self(self.0, self.0.right::<BY>(self.1))
    }

    #[inline(always)]
    pub(crate) fn left<const BY: u32>(self) -> Self {
        Self(self.0, self.0.left::<BY>(self.1))
    }

    /// The lower 32 bits turned to the right by less than 32, the upper ones unspecified.
    #[inline(always)]
    pub(crate) fn low_turned_right(self, by: Self) -> Self {
        Self(self.0, self.0.low_turned_right(self.1, by.1))
    }

    /// The product but for what overflows.
    #[inline(always)]
    pub(crate) fn times(self, other: Self) -> Self {
        Self(self.0, self.0.times(self.1, other.1))
    }

    /// The sum but for what overflows.
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self(self.0, self.0.plus(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self(self.0, self.0.minus(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        Self(self.0, self.0.and(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn xor(self, other: Self) -> Self {
        Self(self.0, self.0.xor(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn is(self, other: Self) -> Mask<W> {
        Mask(self.0, self.0.equal_wholes(self.1, other.1))
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask<W> {
        Mask(self.0, self.0.less_wholes(self.1, other.1))
    }

    /// This in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: Mask<W>, other: Self) -> Self {
        Self(self.0, self.0.choose_wholes(mask.1, self.1, other.1))
    }
}
