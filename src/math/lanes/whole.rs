//! Eight whole numbers.

use super::{F64x8, LANES, Mask, U64x8};
use std::arch::x86_64::*;

impl U64x8 {
    /// All lanes in memory.
    #[inline(always)]
    pub(crate) fn array(self) -> [u64; LANES] {
        self.numbers().row().0.map(f64::to_bits)
    }

    /// The bits taken for a number.
    #[inline(always)]
    pub(crate) fn numbers(self) -> F64x8 {
        // SAFETY: the processor has AVX-512, since there is a U64x8.
        F64x8(unsafe { _mm512_castsi512_pd(self.0) })
    }

    /// As a number with a fraction.
    #[inline(always)]
    pub(crate) fn to_f64(self) -> F64x8 {
        // SAFETY: as above.
        F64x8(unsafe { _mm512_cvtepu64_pd(self.0) })
    }

    /// As a number with a fraction; negative ones have the highest bit.
    #[inline(always)]
    pub(crate) fn signed_to_f64(self) -> F64x8 {
        // SAFETY: as above.
        F64x8(unsafe { _mm512_cvtepi64_pd(self.0) })
    }

    #[inline(always)]
    pub(crate) fn right<const BY: u32>(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_srli_epi64::<BY>(self.0) })
    }

    #[inline(always)]
    pub(crate) fn left<const BY: u32>(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_slli_epi64::<BY>(self.0) })
    }

    /// The lower 32 bits turned to the right, the upper ones unspecified.
    #[inline(always)]
    pub(crate) fn low_turned_right(self, by: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_rorv_epi32(self.0, by.0) })
    }

    /// The product but for what overflows.
    #[inline(always)]
    pub(crate) fn times(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mullo_epi64(self.0, other.0) })
    }

    /// The sum but for what overflows.
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_add_epi64(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_sub_epi64(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_and_si512(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn xor(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_xor_si512(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn is(self, other: Self) -> Mask {
        // SAFETY: as above.
        Mask(unsafe { _mm512_cmpeq_epu64_mask(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask {
        // SAFETY: as above.
        Mask(unsafe { _mm512_cmplt_epu64_mask(self.0, other.0) })
    }

    /// This in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: Mask, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mask_blend_epi64(mask.0, other.0, self.0) })
    }
}
