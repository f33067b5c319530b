//! For processors with AVX2 and FMA. To be used within functions that enable them only, without closures between, which
//! would not be compiled for them.
#![allow(
    unsafe_code,
    reason = "measured faster; whoever calls has asked the processor whether it has AVX2 and FMA, and the pointers are \
              of arrays as long as what is read"
)]

use super::{CHILDREN, Lanes, Numbers, both};
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

/// Three rows of bytes times three numbers, summed.
#[inline(always)]
pub(super) fn dot(rows: [&[i8; CHILDREN]; 3], by: [i16; 3]) -> __m256i {
    let [x, y, z] = rows;
    unsafe {
        let x = _mm256_cvtepi8_epi16(_mm_loadu_si128(x.as_ptr().cast()));
        let y = _mm256_cvtepi8_epi16(_mm_loadu_si128(y.as_ptr().cast()));
        let z = _mm256_cvtepi8_epi16(_mm_loadu_si128(z.as_ptr().cast()));
        let x = _mm256_mullo_epi16(x, _mm256_set1_epi16(by[0]));
        let y = _mm256_mullo_epi16(y, _mm256_set1_epi16(by[1]));
        let z = _mm256_mullo_epi16(z, _mm256_set1_epi16(by[2]));
        _mm256_add_epi16(_mm256_add_epi16(x, y), z)
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
    fn facing(
        low: [&[i8; CHILDREN]; 3],
        high: [&[i8; CHILDREN]; 3],
        by: [i16; 3],
        room: i16,
    ) -> [u16; 2] {
        unsafe {
            let (low, high) = (dot(low, by), dot(high, by));
            let beyond = _mm256_cmpgt_epi16(low, _mm256_set1_epi16(room));
            let before = _mm256_cmpgt_epi16(_mm256_set1_epi16(-room), high);
            let both = _mm256_permute4x64_epi64::<0xd8>(_mm256_packs_epi16(beyond, before));
            let none = !(_mm256_movemask_epi8(both) as u32);
            [none as u16, (none >> 16) as u16]
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
