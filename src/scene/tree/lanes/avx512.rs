//! For processors with AVX-512 (F, BW, DQ and VL) besides AVX2 and FMA. To be used within functions that enable them only,
//! without closures between, which would not be compiled for them.
#![allow(
    unsafe_code,
    reason = "measured faster; whoever calls has asked the processor whether it has all of it, and the pointers are of \
              arrays as long as what is read or written"
)]

use super::avx2::{Avx2, numbers, turn};
use super::{Aside, CHILDREN, Children, Lanes, Numbers, line_up};
use glam::Vec4;
use std::arch::x86_64::*;

/// See the file.
pub(in crate::scene::tree) struct Avx512;

numbers! {
    __m512, 16, _mm512_set1_ps, _mm512_fmadd_ps;
    add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps, min _mm512_min_ps, max _mm512_max_ps;
    |a, b| u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b))
}

impl Lanes for Avx512 {
    type Eight = __m256;
    type Sixteen = __m512;

    #[inline(always)]
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen {
        unsafe { _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128(x.as_ptr().cast()))) }
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        unsafe {
            let x = _mm256_loadu_si256(x.as_ptr().cast());
            _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(x))
        }
    }

    #[inline(always)]
    fn head(x: Self::Sixteen) -> Self::Eight {
        unsafe { _mm512_castps512_ps256(x) }
    }

    #[inline(always)]
    fn middle(x: Self::Sixteen) -> Self::Eight {
        unsafe {
            let x = _mm512_castps_si512(x);
            _mm256_castsi256_ps(_mm512_castsi512_si256(_mm512_alignr_epi32::<4>(x, x)))
        }
    }

    #[inline(always)]
    fn tail(x: Self::Sixteen) -> Self::Eight {
        unsafe { _mm512_extractf32x8_ps::<1>(x) }
    }

    #[inline(always)]
    fn eight(x: Self::Eight) -> [f32; 8] {
        Avx2::eight(x)
    }

    #[inline(always)]
    fn sixteen(x: Self::Sixteen) -> [f32; CHILDREN] {
        let mut all = [0.0; CHILDREN];
        unsafe { _mm512_storeu_ps(all.as_mut_ptr(), x) };
        all
    }

    #[inline(always)]
    fn turn(columns: &[Vec4; 3], v: Vec4) -> Vec4 {
        turn(columns, v)
    }

    /// Up to four, which is nearly always so, are sorted without a branch.
    #[inline(always)]
    fn line_up(
        chosen: u16,
        begins: __m512,
        children: Children<'_>,
        row: &mut [Aside; CHILDREN],
    ) -> usize {
        let count = chosen.count_ones() as usize;
        if count > 4 {
            return line_up(chosen, &Self::sixteen(begins), children, row);
        }
        unsafe {
            let places = _mm512_cvtepu8_epi32(_mm_loadu_si128(children.places.as_ptr().cast()));
            let numbers = _mm512_add_epi32(places, _mm512_set1_epi32(children.first as i32));
            // What is not chosen becomes zero, and so the farthest of all or last.
            let begins = _mm512_maskz_compress_epi32(chosen, _mm512_castps_si512(begins));
            let numbers = _mm512_maskz_compress_epi32(chosen, numbers);
            let begins = _mm256_cvtepu32_epi64(_mm512_castsi512_si128(begins));
            let numbers = _mm256_cvtepu32_epi64(_mm512_castsi512_si128(numbers));
            let all = _mm256_or_si256(_mm256_slli_epi64::<32>(begins), numbers);
            let all = order::<0b10_11_00_01, 0b00_11_11_00>(all);
            let all = order::<0b01_00_11_10, 0b11_11_00_00>(all);
            let all = order::<0b10_11_00_01, 0b11_00_11_00>(all);
            _mm256_storeu_si256(row.as_mut_ptr().cast(), all);
        }
        count
    }
}

/// A step of a bitonic sort of four.
///
/// * `PARTNERS`: which two are compared. * `LESS`: who gets the lesser, two bits each.
#[inline(always)]
fn order<const PARTNERS: i32, const LESS: i32>(all: __m256i) -> __m256i {
    unsafe {
        let others = _mm256_permute4x64_epi64::<PARTNERS>(all);
        let (less, more) = (_mm256_min_epu64(all, others), _mm256_max_epu64(all, others));
        _mm256_blend_epi32::<LESS>(more, less)
    }
}
