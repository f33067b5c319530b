//! For processors with AVX2 and FMA. To be used within functions that enable them only, without closures between, which
//! would not be compiled for them.
#![allow(
    unsafe_code,
    reason = "measured faster; whoever calls has asked the processor whether it has AVX2 and FMA, and the pointers are \
              of arrays as long as what is read"
)]

use super::{CHILDREN, Lanes, Numbers, Way, both};
use glam::Vec4;
use std::arch::x86_64::*;

/// See the file.
pub(crate) struct Avx2;

macro_rules! numbers {
    ($type:ty, $count:literal, $set:ident, $fma:ident; $($name:ident $intrinsic:ident),*; $le:expr) => {
        impl Numbers for $type {
            const COUNT: u32 = $count;

            $(
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    unsafe { $intrinsic(self, other) }
                }
            )*

            #[inline(always)]
            fn splat(x: f32) -> Self {
                unsafe { $set(x) }
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                unsafe { $fma(self, b, c) }
            }

            #[inline(always)]
            fn le(self, other: Self) -> u32 {
                unsafe { $le(self, other) }
            }
        }
    };
}
pub(super) use numbers;

numbers! {
    __m256, 8, _mm256_set1_ps, _mm256_fmadd_ps;
    add _mm256_add_ps, sub _mm256_sub_ps, mul _mm256_mul_ps, div _mm256_div_ps, min _mm256_min_ps, max _mm256_max_ps;
    |a, b| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32
}

/// Three columns times a vector.
#[inline(always)]
pub(super) fn turn(columns: &[Vec4; 3], v: Vec4) -> Vec4 {
    let (x, y, z) = (columns[0].into(), columns[1].into(), columns[2].into());
    unsafe {
        let xy = _mm_fmadd_ps(y, _mm_set1_ps(v.y), _mm_mul_ps(x, _mm_set1_ps(v.x)));
        _mm_fmadd_ps(z, _mm_set1_ps(v.z), xy).into()
    }
}

impl Lanes for Avx2 {
    type Eight = __m256;
    type Sixteen = [__m256; 2];

    #[inline(always)]
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen {
        unsafe {
            let x = _mm_loadu_si128(x.as_ptr().cast());
            [
                _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(x)),
                _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_srli_si128::<8>(x))),
            ]
        }
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        unsafe {
            let (head, tail) = (x.as_ptr().cast(), x.as_ptr().add(8).cast());
            [
                _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(head))),
                _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(tail))),
            ]
        }
    }

    #[inline(always)]
    fn whole(x: &[i32; 8]) -> Self::Eight {
        unsafe { _mm256_cvtepi32_ps(_mm256_loadu_si256(x.as_ptr().cast())) }
    }

    #[inline(always)]
    fn pick(x: Self::Eight, order: u32) -> Self::Eight {
        unsafe {
            let shifts = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
            let order = _mm256_srlv_epi32(_mm256_set1_epi32(order as i32), shifts);
            _mm256_permutevar8x32_ps(x, order)
        }
    }

    #[inline(always)]
    fn short(x: &[u16; 8]) -> Self::Eight {
        unsafe {
            let x = _mm_loadu_si128(x.as_ptr().cast());
            _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(x))
        }
    }

    #[inline(always)]
    fn facing(least: &[[u8; 4]; 8], most: &[[u8; 4]; 8], way: &Way) -> [u32; 2] {
        unsafe {
            let least = _mm256_loadu_si256(least.as_ptr().cast());
            let most = _mm256_loadu_si256(most.as_ptr().cast());
            let down = _mm256_set1_epi32(i32::from_ne_bytes(way.down));
            let by = _mm256_set1_epi32(i32::from_ne_bytes(way.by.map(|d| d as u8)));
            let ones = _mm256_set1_epi16(1);
            // Two products of at most 255 times 63 have room in 16 bits.
            let near = _mm256_maddubs_epi16(_mm256_blendv_epi8(least, most, down), by);
            let far = _mm256_maddubs_epi16(_mm256_blendv_epi8(most, least, down), by);
            let (near, far) = (_mm256_madd_epi16(near, ones), _mm256_madd_epi16(far, ones));
            let beyond = _mm256_cmpgt_epi32(near, _mm256_set1_epi32(way.against));
            let before = _mm256_cmpgt_epi32(_mm256_set1_epi32(way.along), far);
            [beyond, before].map(|x| !_mm256_movemask_ps(_mm256_castsi256_ps(x)) as u32 & 0xff)
        }
    }

    #[inline(always)]
    fn head(x: Self::Sixteen) -> Self::Eight {
        x[0]
    }

    #[inline(always)]
    fn middle(x: Self::Sixteen) -> Self::Eight {
        unsafe { _mm256_permute2f128_ps::<0x21>(x[0], x[1]) }
    }

    #[inline(always)]
    fn tail(x: Self::Sixteen) -> Self::Eight {
        x[1]
    }

    #[inline(always)]
    fn eight(x: Self::Eight) -> [f32; 8] {
        let mut all = [0.0; 8];
        unsafe { _mm256_storeu_ps(all.as_mut_ptr(), x) };
        all
    }

    #[inline(always)]
    fn sixteen(x: Self::Sixteen) -> [f32; CHILDREN] {
        both([Self::eight(x[0]), Self::eight(x[1])])
    }

    #[inline(always)]
    fn turn(columns: &[Vec4; 3], v: Vec4) -> Vec4 {
        turn(columns, v)
    }
}
