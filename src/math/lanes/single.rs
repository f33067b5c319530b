//! Sixteen numbers of single precision in one register.

use super::Avx512;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Sixteen numbers of single precision in memory: a line of the cache.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Singles(pub(crate) [f32; 16]);

/// Sixteen numbers of single precision.
#[derive(Clone, Copy)]
pub(crate) struct F32x16(__m512);

impl Avx512 {
    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn all_single(self, x: f32) -> F32x16 {
        // SAFETY: the processor has AVX-512.
        F32x16(unsafe { _mm512_set1_ps(x) })
    }

    /// Different numbers.
    #[inline(always)]
    pub(crate) fn load_singles(self, row: &Singles) -> F32x16 {
        // SAFETY: the processor has AVX-512; a row is 64 bytes at an address divisible by 64.
        F32x16(unsafe { _mm512_load_ps(row.0.as_ptr()) })
    }
}

impl F32x16 {
    /// The lanes in which it is less, one bit each.
    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> u16 {
        // SAFETY: the processor has AVX-512, since there is an F32x16.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }

    /// This in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: u16, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mask_blend_ps(mask, other.0, self.0) })
    }

    /// The least of all, and the first lane that has it. None of them may be undefined.
    #[inline(always)]
    pub(crate) fn least(self) -> (f32, usize) {
        // SAFETY: as above.
        unsafe {
            let least = _mm512_reduce_min_ps(self.0);
            let there = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, _mm512_set1_ps(least));
            (least, there.trailing_zeros() as usize & 15)
        }
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $intrinsic:ident) => {
        impl $trait for F32x16 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: the processor has AVX-512, since there are F32x16.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

operator!(Add, add, _mm512_add_ps);
operator!(Sub, sub, _mm512_sub_ps);
operator!(Mul, mul, _mm512_mul_ps);
operator!(Div, div, _mm512_div_ps);
