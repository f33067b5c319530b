//! Eight numbers in one register of AVX-512, each rounded as a plain number would be: the same
//! formula gives the same bits eight at a time and one at a time.
//!
//! All `unsafe` of the flight of photons is here. What makes it sound: an [`Avx512`] exists only where the processor was
//! asked, and the first [`F64x8`] or [`U64x8`] of any calculation is made by one.

#![allow(
    unsafe_code,
    reason = "measured several times faster; the processor was asked"
)]

mod single;
mod vectors;
mod whole;

pub(crate) use single::{F32x16, Singles};
pub(crate) use vectors::Vectors;

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// How many lanes there are.
pub(crate) const LANES: usize = 8;

/// Eight numbers in memory: a line of the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Row(pub(crate) [f64; LANES]);

/// Proof that the processor has AVX-512.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct F64x8(__m512d);

/// Eight whole numbers.
#[derive(Clone, Copy)]
pub(crate) struct U64x8(__m512i);

/// Some of eight lanes, the first in the lowest bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mask(pub(crate) u8);

impl Avx512 {
    /// Asks the processor.
    pub(crate) fn detect() -> Option<Self> {
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Self(()))
    }

    /// Runs a calculation in which the compiler may use AVX-512. What is to profit must be inlined.
    #[inline(always)]
    pub(crate) fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,bmi1,bmi2,lzcnt,popcnt")]
        fn run<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the processor has what the function enables.
        unsafe { run(f) }
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn all(self, x: f64) -> F64x8 {
        // SAFETY: the processor has AVX-512.
        F64x8(unsafe { _mm512_set1_pd(x) })
    }

    /// Different numbers.
    #[inline(always)]
    pub(crate) fn load(self, row: &Row) -> F64x8 {
        // SAFETY: the processor has AVX-512; a row is 64 bytes at an address divisible by 64.
        F64x8(unsafe { _mm512_load_pd(row.0.as_ptr()) })
    }

    /// The same whole number in all lanes.
    #[inline(always)]
    pub(crate) fn all_bits(self, x: u64) -> U64x8 {
        // SAFETY: the processor has AVX-512.
        U64x8(unsafe { _mm512_set1_epi64(x as i64) })
    }

    /// Entries of a table.
    ///
    /// # Panics
    /// If one is not in it.
    #[inline(always)]
    pub(crate) fn gather(self, table: &[f64], index: U64x8) -> F64x8 {
        assert!(index.lt(self.all_bits(table.len() as u64)) == Mask::ALL);
        // SAFETY: the processor has AVX-512, and all indices are below the table's length.
        F64x8(unsafe { _mm512_i64gather_pd::<8>(index.0, table.as_ptr()) })
    }

    /// Row `k` of the result holds number `k` of each of these: one row a lane.
    #[inline(always)]
    pub(crate) fn columns(self, rows: [&Row; LANES]) -> [F64x8; LANES] {
        let [a, b, c, d, e, f, g, h] = rows;
        transposed([
            self.load(a),
            self.load(b),
            self.load(c),
            self.load(d),
            self.load(e),
            self.load(f),
            self.load(g),
            self.load(h),
        ])
    }
}

/// Lane `i` of result `k` is lane `k` of `rows[i]`.
#[inline(always)]
pub(crate) fn transposed(rows: [F64x8; LANES]) -> [F64x8; LANES] {
    let r: [__m512d; LANES] = [
        rows[0].0, rows[1].0, rows[2].0, rows[3].0, rows[4].0, rows[5].0, rows[6].0, rows[7].0,
    ];
    // SAFETY: the processor has AVX-512, since there are F64x8.
    unsafe {
        // Pairs of rows, then of pairs, then of fours.
        let (p0, p1) = (
            _mm512_unpacklo_pd(r[0], r[1]),
            _mm512_unpackhi_pd(r[0], r[1]),
        );
        let (p2, p3) = (
            _mm512_unpacklo_pd(r[2], r[3]),
            _mm512_unpackhi_pd(r[2], r[3]),
        );
        let (p4, p5) = (
            _mm512_unpacklo_pd(r[4], r[5]),
            _mm512_unpackhi_pd(r[4], r[5]),
        );
        let (p6, p7) = (
            _mm512_unpacklo_pd(r[6], r[7]),
            _mm512_unpackhi_pd(r[6], r[7]),
        );
        let ((a04, a26), (a15, a37)) = (parted(p0, p2), parted(p1, p3));
        let ((b04, b26), (b15, b37)) = (parted(p4, p6), parted(p5, p7));
        let ((c0, c4), (c1, c5)) = (parted(a04, b04), parted(a15, b15));
        let ((c2, c6), (c3, c7)) = (parted(a26, b26), parted(a37, b37));
        [
            F64x8(c0),
            F64x8(c1),
            F64x8(c2),
            F64x8(c3),
            F64x8(c4),
            F64x8(c5),
            F64x8(c6),
            F64x8(c7),
        ]
    }
}

/// The even pairs of both, and the odd ones.
///
/// # Safety
/// The processor must have AVX-512.
#[inline(always)]
unsafe fn parted(a: __m512d, b: __m512d) -> (__m512d, __m512d) {
    // SAFETY: as the caller says.
    unsafe {
        (
            _mm512_shuffle_f64x2::<0b10_00_10_00>(a, b),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(a, b),
        )
    }
}

impl F64x8 {
    /// All lanes in memory.
    #[inline(always)]
    pub(crate) fn row(self) -> Row {
        let mut row = Row::default();
        // SAFETY: the processor has AVX-512; a row is 64 bytes at an address divisible by 64.
        unsafe { _mm512_store_pd(row.0.as_mut_ptr(), self.0) };
        row
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        // SAFETY: the processor has AVX-512, since there is an F64x8.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    /// The smaller one, `other` where the two cannot be compared.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }

    /// The larger one, `other` where the two cannot be compared.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    /// With the sign of another number.
    #[inline(always)]
    pub(crate) fn with_sign_of(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            let sign = _mm512_set1_pd(-0.0);
            _mm512_or_pd(_mm512_andnot_pd(sign, self.0), _mm512_and_pd(sign, other.0))
        })
    }

    /// The whole number below.
    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_roundscale_pd::<0x01>(self.0) })
    }

    /// The whole part, of numbers that are not negative and below 2^63.
    #[inline(always)]
    pub(crate) fn whole(self) -> U64x8 {
        // SAFETY: as above.
        U64x8(unsafe { _mm512_cvttpd_epi64(self.0) })
    }

    #[inline(always)]
    pub(crate) fn bits(self) -> U64x8 {
        // SAFETY: as above.
        U64x8(unsafe { _mm512_castpd_si512(self.0) })
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask {
        // SAFETY: as above.
        Mask(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn le(self, other: Self) -> Mask {
        // SAFETY: as above.
        Mask(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    pub(crate) fn gt(self, other: Self) -> Mask {
        other.lt(self)
    }

    #[inline(always)]
    pub(crate) fn ge(self, other: Self) -> Mask {
        other.le(self)
    }

    #[inline(always)]
    pub(crate) fn is(self, other: Self) -> Mask {
        // SAFETY: as above.
        Mask(unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0) })
    }

    /// This in the lanes of a mask, `other` in the rest.
    #[inline(always)]
    pub(crate) fn or(self, mask: Mask, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mask_blend_pd(mask.0, other.0, self.0) })
    }

    /// The lanes of eight entries: lane `i` is entry `index[i]` modulo 8 of this.
    #[inline(always)]
    pub(crate) fn pick(self, index: U64x8) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_permutexvar_pd(index.0, self.0) })
    }
}

impl Mask {
    pub(crate) const NONE: Self = Self(0);
    pub(crate) const ALL: Self = Self(0xff);

    /// The first `count` lanes, up to 8.
    #[inline(always)]
    pub(crate) fn first(count: usize) -> Self {
        Self(((1u32 << count) - 1) as u8)
    }

    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0 != 0
    }

    #[inline(always)]
    pub(crate) fn has(self, lane: usize) -> bool {
        self.0 >> lane & 1 != 0
    }

    /// The numbers of the lanes.
    #[inline(always)]
    pub(crate) fn lanes(self) -> impl Iterator<Item = usize> {
        let mut rest = self.0;
        std::iter::from_fn(move || {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest.wrapping_sub(1);
            (lane < LANES).then_some(lane)
        })
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $intrinsic:ident) => {
        impl $trait for F64x8 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: the processor has AVX-512, since there are F64x8.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }

        impl $trait<f64> for F64x8 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                // SAFETY: the processor has AVX-512, since there is an F64x8.
                Self(unsafe { $intrinsic(self.0, _mm512_set1_pd(other)) })
            }
        }

        impl $trait<F64x8> for f64 {
            type Output = F64x8;
            #[inline(always)]
            fn $name(self, other: F64x8) -> F64x8 {
                // SAFETY: the processor has AVX-512, since there is an F64x8.
                F64x8(unsafe { $intrinsic(_mm512_set1_pd(self), other.0) })
            }
        }
    };
}

operator!(Add, add, _mm512_add_pd);
operator!(Sub, sub, _mm512_sub_pd);
operator!(Mul, mul, _mm512_mul_pd);
operator!(Div, div, _mm512_div_pd);

impl Neg for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: the processor has AVX-512, since there is an F64x8.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl BitAnd for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitXor for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitxor(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
