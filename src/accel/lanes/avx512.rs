//! For processors with AVX-512 (F, BW, DQ and VL) besides AVX2 and FMA. To be used within functions that enable them only,
//! without closures between, which would not be compiled for them. What is unsafe is so for the reasons of [`super::avx2`], and
//! as sound.
#![allow(unsafe_code, reason = "measured faster")]

use super::avx2::{Avx2, Eight, lesser, numbers, turn};
use super::{Aside, CHILDREN, Children, Lanes, Numbers, Siblings, Way, line_up};
use glam::Vec4;
use std::arch::x86_64::*;

/// See the file.
pub(crate) struct Avx512;

/// Sixteen numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Sixteen(__m512);

numbers! {
    Sixteen, 16, _mm512_set1_ps, _mm512_fmadd_ps;
    add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps, min _mm512_min_ps, max _mm512_max_ps;
    |a, b| u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b))
}

impl Lanes for Avx512 {
    type Eight = Eight;
    type Sixteen = Sixteen;

    #[inline(always)]
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen {
        unsafe {
            let x = _mm_loadu_si128(x.as_ptr().cast());
            Sixteen(_mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(x)))
        }
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        unsafe {
            let x = _mm256_loadu_si256(x.as_ptr().cast());
            Sixteen(_mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(x)))
        }
    }

    #[inline(always)]
    fn whole(x: &[i32; 8]) -> Self::Eight {
        Avx2::whole(x)
    }

    #[inline(always)]
    fn pick(x: Self::Eight, order: u32) -> Self::Eight {
        Avx2::pick(x, order)
    }

    #[inline(always)]
    fn short(x: &[u16; 8]) -> Self::Eight {
        Avx2::short(x)
    }

    #[inline(always)]
    fn facing(least: &[[u8; 4]; 8], most: &[[u8; 4]; 8], way: &Way) -> [u32; 2] {
        Avx2::facing(least, most, way)
    }

    #[inline(always)]
    fn row(chosen: u32, begins: &[f32; 8], children: &Siblings, row: &mut [Aside; 8]) -> usize {
        Avx2::row(chosen, begins, children, row)
    }

    #[inline(always)]
    fn head(x: Self::Sixteen) -> Self::Eight {
        unsafe { Eight(_mm512_castps512_ps256(x.0)) }
    }

    #[inline(always)]
    fn middle(x: Self::Sixteen) -> Self::Eight {
        unsafe {
            let x = _mm512_castps_si512(x.0);
            let x = _mm512_castsi512_si256(_mm512_alignr_epi32::<4>(x, x));
            Eight(_mm256_castsi256_ps(x))
        }
    }

    #[inline(always)]
    fn tail(x: Self::Sixteen) -> Self::Eight {
        unsafe { Eight(_mm512_extractf32x8_ps::<1>(x.0)) }
    }

    #[inline(always)]
    fn eight(x: Self::Eight) -> [f32; 8] {
        Avx2::eight(x)
    }

    #[inline(always)]
    fn sixteen(x: Self::Sixteen) -> [f32; CHILDREN] {
        let mut all = [0.0; CHILDREN];
        unsafe { _mm512_storeu_ps(all.as_mut_ptr(), x.0) };
        all
    }

    #[inline(always)]
    fn turn(columns: &[Vec4; 3], v: Vec4) -> Vec4 {
        turn(columns, v)
    }

    /// Sorted without a branch where there are few.
    #[inline(always)]
    fn line_up(
        chosen: u16,
        begins: Sixteen,
        children: Children<'_>,
        row: &mut [Aside; CHILDREN],
    ) -> usize {
        unsafe {
            let count = chosen.count_ones() as usize;
            if count > 4 {
                line_up_many(chosen, begins, children, row);
            } else {
                let four = _mm512_castsi512_si256(gather(chosen, begins, children));
                _mm256_storeu_si256(row.as_mut_ptr().cast(), sort_four(four));
            }
            count
        }
    }
}

/// More than four, one of thirty times.
#[inline(never)]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,popcnt,lzcnt")]
fn line_up_many(chosen: u16, begins: Sixteen, children: Children<'_>, row: &mut [Aside; CHILDREN]) {
    if chosen.count_ones() > 8 {
        line_up(chosen, &Avx512::sixteen(begins), children, row);
    } else {
        let eight = sort_eight(gather(chosen, begins, children));
        unsafe { _mm512_storeu_si512(row.as_mut_ptr().cast(), eight) };
    }
}

/// The chosen among children, at most eight, in their order; then zeros, which are the nearest of all.
#[inline(always)]
fn gather(chosen: u16, begins: Sixteen, children: Children<'_>) -> __m512i {
    unsafe {
        let places = _mm512_cvtepu8_epi32(_mm_loadu_si128(children.places.as_ptr().cast()));
        let numbers = _mm512_add_epi32(places, _mm512_set1_epi32(children.first as i32));
        let begins = _mm512_maskz_compress_epi32(chosen, _mm512_castps_si512(begins.0));
        let numbers = _mm512_maskz_compress_epi32(chosen, numbers);
        let begins = _mm512_cvtepu32_epi64(_mm512_castsi512_si256(begins));
        let numbers = _mm512_cvtepu32_epi64(_mm512_castsi512_si256(numbers));
        _mm512_or_si512(_mm512_slli_epi64::<32>(begins), numbers)
    }
}

/// The greatest first, by a bitonic sort.
#[inline(always)]
fn sort_four(all: __m256i) -> __m256i {
    let all = order_four::<2, 1>(all);
    let all = order_four::<4, 2>(all);
    order_four::<4, 1>(all)
}

/// As [`sort_four`].
#[inline(always)]
fn sort_eight(all: __m512i) -> __m512i {
    let all = order_eight::<2, 1>(all);
    let all = order_eight::<4, 2>(all);
    let all = order_eight::<4, 1>(all);
    let all = order_eight::<8, 4>(all);
    let all = order_eight::<8, 2>(all);
    order_eight::<8, 1>(all)
}

/// A step of a bitonic sort: every number and the one `FAR` away, in blocks of `BLOCK` that go up and down by turns.
#[inline(always)]
fn order_four<const BLOCK: usize, const FAR: usize>(all: __m256i) -> __m256i {
    let partners = const { partners::<4>(FAR) };
    unsafe {
        let others = _mm256_permutexvar_epi64(_mm256_loadu_si256(partners.as_ptr().cast()), all);
        let more = _mm256_max_epu64(all, others);
        _mm256_mask_min_epu64(more, const { lesser(BLOCK, FAR) as u8 }, all, others)
    }
}

/// As [`order_four`].
#[inline(always)]
fn order_eight<const BLOCK: usize, const FAR: usize>(all: __m512i) -> __m512i {
    let partners = const { partners::<8>(FAR) };
    unsafe {
        let others = _mm512_permutexvar_epi64(_mm512_loadu_si512(partners.as_ptr().cast()), all);
        let more = _mm512_max_epu64(all, others);
        _mm512_mask_min_epu64(more, const { lesser(BLOCK, FAR) as u8 }, all, others)
    }
}

/// Who is compared with whom.
const fn partners<const N: usize>(far: usize) -> [u64; N] {
    let mut all = [0; N];
    let mut k = 0;
    while k < N {
        all[k] = (k ^ far) as u64;
        k += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::{Task, on_avx512};
    use super::*;
    use crate::sampling::Rng;

    /// A row of sixteen.
    struct Row<'a>(u16, &'a [f32; CHILDREN], Children<'a>);

    impl Task for Row<'_> {
        type Output = Vec<Aside>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<Aside> {
            let mut row = [Aside::NONE; CHILDREN];
            let whole = self.1.map(|begin| begin as u16);
            let count = L::line_up(self.0, L::words(&whole), self.2, &mut row);
            row[..count].to_vec()
        }
    }

    #[test]
    fn children_are_in_order_whatever_their_number() {
        let places = std::array::from_fn(|k| k as u8);
        let children = Children {
            first: 70,
            places: &places,
        };
        let mut rng = Rng::new(3, 0);
        for i in 0..2_000 {
            // Some alike, some of them zero.
            let begins = std::array::from_fn(|_| (rng.bits() % (3 + i % 40)) as f32);
            let (some, most) = (rng.bits() & rng.bits(), rng.bits() | rng.bits());
            let chosen = [some, most][usize::from(i % 9 == 0)] as u16;
            let Some(quick) = on_avx512(Row(chosen, &begins, children)) else {
                println!("not on this processor");
                return;
            };
            let mut plain = [Aside::NONE; CHILDREN];
            let count = line_up(chosen, &begins, children, &mut plain);
            assert_eq!(quick, plain[..count]);
        }
    }
}
