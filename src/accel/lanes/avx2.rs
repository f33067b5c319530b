//! For processors with AVX2 and FMA. To be used within functions that enable them only, without closures between, which
//! would not be compiled for them.
//!
//! What is unsafe here is to execute an instruction that the processor does not have, and to read or write beyond an array.
//! The types here have no name outside of `lanes`, where `task` alone hands them out, after it has asked the processor; and
//! every pointer is that of an array as long as what is read or written, by its type.
#![allow(unsafe_code, reason = "measured faster")]

use super::{Aside, CHILDREN, Lanes, Numbers, Siblings, Way, both};
use glam::Vec4;
use std::arch::x86_64::*;

/// See the file.
pub(crate) struct Avx2;

/// Eight numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Eight(pub(super) __m256);

macro_rules! numbers {
    ($type:ident, $count:literal, $set:ident, $fma:ident; $($name:ident $intrinsic:ident),*; $le:expr) => {
        impl Numbers for $type {
            const COUNT: u32 = $count;

            $(
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    unsafe { Self($intrinsic(self.0, other.0)) }
                }
            )*

            #[inline(always)]
            fn splat(x: f32) -> Self {
                unsafe { Self($set(x)) }
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                unsafe { Self($fma(self.0, b.0, c.0)) }
            }

            #[inline(always)]
            fn le(self, other: Self) -> u32 {
                unsafe { $le(self.0, other.0) }
            }
        }
    };
}
pub(super) use numbers;

numbers! {
    Eight, 8, _mm256_set1_ps, _mm256_fmadd_ps;
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
    type Eight = Eight;
    type Sixteen = [Eight; 2];

    #[inline(always)]
    fn bytes(x: &[u8; CHILDREN]) -> Self::Sixteen {
        unsafe {
            let x = _mm_loadu_si128(x.as_ptr().cast());
            [
                Eight(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(x))),
                Eight(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(
                    _mm_srli_si128::<8>(x),
                ))),
            ]
        }
    }

    #[inline(always)]
    fn words(x: &[u16; 16]) -> Self::Sixteen {
        unsafe {
            let (head, tail) = (x.as_ptr().cast(), x.as_ptr().add(8).cast());
            let (head, tail) = (_mm_loadu_si128(head), _mm_loadu_si128(tail));
            [
                Eight(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(head))),
                Eight(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(tail))),
            ]
        }
    }

    #[inline(always)]
    fn whole(x: &[i32; 8]) -> Self::Eight {
        unsafe { Eight(_mm256_cvtepi32_ps(_mm256_loadu_si256(x.as_ptr().cast()))) }
    }

    #[inline(always)]
    fn pick(x: Self::Eight, order: u32) -> Self::Eight {
        unsafe {
            let shifts = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
            let order = _mm256_srlv_epi32(_mm256_set1_epi32(order as i32), shifts);
            Eight(_mm256_permutevar8x32_ps(x.0, order))
        }
    }

    #[inline(always)]
    fn short(x: &[u16; 8]) -> Self::Eight {
        unsafe {
            let x = _mm_loadu_si128(x.as_ptr().cast());
            Eight(_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(x)))
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

    /// Sorted without a branch.
    #[inline(always)]
    fn row(chosen: u32, begins: &[f32; 8], children: &Siblings, row: &mut [Aside; 8]) -> usize {
        unsafe {
            let places = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let is_chosen = _mm256_and_si256(_mm256_set1_epi32(chosen as i32), bits);
            let is_chosen = _mm256_cmpeq_epi32(is_chosen, bits);
            // Distances with places in their last bits, more than 0; 0 for the others.
            let begins = _mm256_loadu_si256(begins.as_ptr().cast());
            let begins = _mm256_andnot_si256(_mm256_set1_epi32(15), begins);
            let marks = _mm256_or_si256(places, _mm256_set1_epi32(8));
            let keys = sort_eight(_mm256_and_si256(_mm256_or_si256(begins, marks), is_chosen));
            let is_first = _mm256_cmpgt_epi32(_mm256_set1_epi32(children.split as i32), places);
            let [first, second] = children.first;
            let first = _mm256_add_epi32(_mm256_set1_epi32(first as i32), places);
            let second = _mm256_add_epi32(_mm256_set1_epi32(second as i32), places);
            let second = _mm256_or_si256(second, _mm256_set1_epi32(Siblings::SECOND as i32));
            let numbers = _mm256_blendv_epi8(second, first, is_first);
            let numbers = _mm256_permutevar8x32_epi32(numbers, keys);
            let begins = _mm256_andnot_si256(_mm256_set1_epi32(15), keys);
            let low = _mm256_unpacklo_epi32(numbers, begins);
            let high = _mm256_unpackhi_epi32(numbers, begins);
            let row: *mut __m256i = row.as_mut_ptr().cast();
            _mm256_storeu_si256(row, _mm256_permute2x128_si256::<0x20>(low, high));
            _mm256_storeu_si256(row.add(1), _mm256_permute2x128_si256::<0x31>(low, high));
            chosen.count_ones() as usize
        }
    }

    #[inline(always)]
    fn head(x: Self::Sixteen) -> Self::Eight {
        x[0]
    }

    #[inline(always)]
    fn middle(x: Self::Sixteen) -> Self::Eight {
        unsafe { Eight(_mm256_permute2f128_ps::<0x21>(x[0].0, x[1].0)) }
    }

    #[inline(always)]
    fn tail(x: Self::Sixteen) -> Self::Eight {
        x[1]
    }

    #[inline(always)]
    fn eight(x: Self::Eight) -> [f32; 8] {
        let mut all = [0.0; 8];
        unsafe { _mm256_storeu_ps(all.as_mut_ptr(), x.0) };
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

/// Orders that exchange each with the one next to it, and with the one two away.
const NEXT: i32 = 0xb1;
const NEXT_BUT_ONE: i32 = 0x4e;

/// The greatest first, by a bitonic sort.
#[inline(always)]
fn sort_eight(all: __m256i) -> __m256i {
    unsafe {
        let all = order::<{ lesser(2, 1) }>(all, _mm256_shuffle_epi32::<NEXT>(all));
        let all = order::<{ lesser(4, 2) }>(all, _mm256_shuffle_epi32::<NEXT_BUT_ONE>(all));
        let all = order::<{ lesser(4, 1) }>(all, _mm256_shuffle_epi32::<NEXT>(all));
        let all = order::<{ lesser(8, 4) }>(all, _mm256_permute2x128_si256::<1>(all, all));
        let all = order::<{ lesser(8, 2) }>(all, _mm256_shuffle_epi32::<NEXT_BUT_ONE>(all));
        order::<{ lesser(8, 1) }>(all, _mm256_shuffle_epi32::<NEXT>(all))
    }
}

/// Of each pair the lesser where there is a bit, the greater elsewhere.
#[inline(always)]
fn order<const LESSER: i32>(all: __m256i, others: __m256i) -> __m256i {
    unsafe {
        let (less, more) = (_mm256_min_epu32(all, others), _mm256_max_epu32(all, others));
        _mm256_blend_epi32::<LESSER>(more, less)
    }
}

/// Who gets the lesser of both in a step of a bitonic sort, a bit each.
///
/// * `block`, `far`: size of the blocks that go up and down by turns, and how far apart the two of a pair are.
pub(super) const fn lesser(block: usize, far: usize) -> i32 {
    let mut all = 0;
    let mut k = 0;
    while k < 8 {
        all |= (((k & block == 0) != (k & far == 0)) as i32) << k;
        k += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::{Plain, Task, on_avx2};
    use super::*;
    use crate::sampling::Rng;

    /// A row of eight.
    struct Row<'a>(u32, &'a [f32; 8], &'a Siblings);

    impl Task for Row<'_> {
        type Output = Vec<(f32, usize)>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let mut row = [Aside::NONE; 8];
            let count = L::row(self.0, self.1, self.2, &mut row);
            let row = row[..count].iter();
            row.map(|a| (a.distance(), a.number())).collect()
        }
    }

    #[test]
    fn eight_children_are_in_order_whatever_their_number() {
        let mut rng = Rng::new(4, 0);
        for i in 0..3_000 {
            let chosen = [rng.bits() & rng.bits(), rng.bits()][i % 2] & 0xff;
            // Different by more than is rounded, and some of them zero.
            let scale = (rng.bits() % 8) as f32;
            let begins = std::array::from_fn(|k| scale * (k as f32 * 37.0 % 8.0));
            let children = Siblings {
                first: [rng.bits() % 1000, 1000 + rng.bits() % 1000],
                split: rng.bits() % 9,
            };
            let mut plain = Row(chosen, &begins, &children).run::<Plain>();
            let Some(mut quick) = on_avx2(Row(chosen, &begins, &children)) else {
                println!("not on this processor");
                return;
            };
            assert_eq!(plain.len(), chosen.count_ones() as usize);
            assert!(plain.iter().zip(&quick).all(|(p, q)| {
                (0.0..=1e-5 * p.0).contains(&(p.0 - q.0)) && (scale == 0.0 || p.1 == q.1)
            }));
            // As far away as each other: in any order.
            plain.sort_by_key(|p| p.1);
            quick.sort_by_key(|q| q.1);
            assert!(plain.iter().zip(&quick).all(|(p, q)| p.1 == q.1));
        }
    }
}
