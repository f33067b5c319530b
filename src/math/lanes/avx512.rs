//! Eight numbers in one register of AVX-512.
#![allow(
    unsafe_code,
    reason = "measured several times faster; the processor was asked, since there is an `Avx512`"
)]

use super::{LANES, Row, Singles, Wide};
use std::arch::x86_64::*;

/// Proof that the processor has AVX-512.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

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
}

macro_rules! calls {
    ($($name:ident($($arg:ident: $type:ident),*) -> $out:ident { $($do:tt)* })*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: Self::$type),*) -> Self::$out {
                // SAFETY: the processor has AVX-512, as `self` proves.
                unsafe { $($do)* }
            }
        )*
    };
}

impl Wide for Avx512 {
    type Reals = __m512d;
    type Wholes = __m512i;
    type Shorts = __m512;
    type Mask = u8;

    #[inline(always)]
    fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,bmi1,bmi2,lzcnt,popcnt")]
        fn run<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the processor has what the function enables.
        unsafe { run(f) }
    }

    calls! {
        pick(x: Reals, index: Wholes) -> Reals { _mm512_permutexvar_pd(index, x) }
        choose(lanes: Mask, x: Reals, other: Reals) -> Reals { _mm512_mask_blend_pd(lanes, other, x) }
        add(a: Reals, b: Reals) -> Reals { _mm512_add_pd(a, b) }
        sub(a: Reals, b: Reals) -> Reals { _mm512_sub_pd(a, b) }
        mul(a: Reals, b: Reals) -> Reals { _mm512_mul_pd(a, b) }
        div(a: Reals, b: Reals) -> Reals { _mm512_div_pd(a, b) }
        min(a: Reals, b: Reals) -> Reals { _mm512_min_pd(a, b) }
        max(a: Reals, b: Reals) -> Reals { _mm512_max_pd(a, b) }
        neg(a: Reals) -> Reals { _mm512_xor_pd(a, _mm512_set1_pd(-0.0)) }
        abs(a: Reals) -> Reals { _mm512_abs_pd(a) }
        with_sign_of(a: Reals, b: Reals) -> Reals {
            let sign = _mm512_set1_pd(-0.0);
            _mm512_or_pd(_mm512_andnot_pd(sign, a), _mm512_and_pd(sign, b))
        }
        sqrt(a: Reals) -> Reals { _mm512_sqrt_pd(a) }
        floor(a: Reals) -> Reals { _mm512_roundscale_pd::<0x01>(a) }
        less(a: Reals, b: Reals) -> Mask { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b) }
        at_most(a: Reals, b: Reals) -> Mask { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b) }
        equal(a: Reals, b: Reals) -> Mask { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, b) }

        bits_of(a: Reals) -> Wholes { _mm512_castpd_si512(a) }
        of_bits(a: Wholes) -> Reals { _mm512_castsi512_pd(a) }
        whole(a: Reals) -> Wholes { _mm512_cvttpd_epi64(a) }
        real(a: Wholes) -> Reals { _mm512_cvtepu64_pd(a) }
        signed_real(a: Wholes) -> Reals { _mm512_cvtepi64_pd(a) }

        choose_wholes(lanes: Mask, x: Wholes, other: Wholes) -> Wholes { _mm512_mask_blend_epi64(lanes, other, x) }
        low_turned_right(a: Wholes, by: Wholes) -> Wholes { _mm512_rorv_epi32(a, by) }
        times(a: Wholes, b: Wholes) -> Wholes { _mm512_mullo_epi64(a, b) }
        plus(a: Wholes, b: Wholes) -> Wholes { _mm512_add_epi64(a, b) }
        minus(a: Wholes, b: Wholes) -> Wholes { _mm512_sub_epi64(a, b) }
        and(a: Wholes, b: Wholes) -> Wholes { _mm512_and_si512(a, b) }
        xor(a: Wholes, b: Wholes) -> Wholes { _mm512_xor_si512(a, b) }
        less_wholes(a: Wholes, b: Wholes) -> Mask { _mm512_cmplt_epu64_mask(a, b) }
        equal_wholes(a: Wholes, b: Wholes) -> Mask { _mm512_cmpeq_epu64_mask(a, b) }

        add_shorts(a: Shorts, b: Shorts) -> Shorts { _mm512_add_ps(a, b) }
        sub_shorts(a: Shorts, b: Shorts) -> Shorts { _mm512_sub_ps(a, b) }
        mul_shorts(a: Shorts, b: Shorts) -> Shorts { _mm512_mul_ps(a, b) }
        div_shorts(a: Shorts, b: Shorts) -> Shorts { _mm512_div_ps(a, b) }
    }

    #[inline(always)]
    fn splat(self, x: f64) -> __m512d {
        // SAFETY: the processor has AVX-512, as `self` proves.
        unsafe { _mm512_set1_pd(x) }
    }

    #[inline(always)]
    fn read(self, row: &Row) -> __m512d {
        // SAFETY: as above; a row is 64 bytes at an address divisible by 64.
        unsafe { _mm512_load_pd(row.0.as_ptr()) }
    }

    #[inline(always)]
    fn write(self, x: __m512d) -> Row {
        let mut row = Row::default();
        // SAFETY: as above; a row is 64 bytes at an address divisible by 64.
        unsafe { _mm512_store_pd(row.0.as_mut_ptr(), x) };
        row
    }

    #[inline(always)]
    fn widen(self, singles: &[f32; LANES]) -> __m512d {
        // SAFETY: as above; there are eight of them.
        unsafe { _mm512_cvtps_pd(_mm256_loadu_ps(singles.as_ptr())) }
    }

    #[inline(always)]
    fn read_columns(self, [a, b, c, d, e, f, g, h]: [&Row; LANES]) -> [__m512d; LANES] {
        self.transpose([
            self.read(a),
            self.read(b),
            self.read(c),
            self.read(d),
            self.read(e),
            self.read(f),
            self.read(g),
            self.read(h),
        ])
    }

    #[inline(always)]
    fn transpose(self, r: [__m512d; LANES]) -> [__m512d; LANES] {
        // SAFETY: as above.
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
            [c0, c1, c2, c3, c4, c5, c6, c7]
        }
    }

    #[inline(always)]
    fn read_pairs(self, table: &[[f64; 2]], index: __m512i) -> [__m512d; 2] {
        let count = self.splat_whole(table.len() as u64);
        assert!(self.less_wholes(index, count) == u8::MAX);
        let table = table.as_flattened();
        let x = self.left::<1>(index);
        let y = self.plus(x, self.splat_whole(1));
        // SAFETY: as above, and all indices are below the table's length.
        unsafe {
            [
                _mm512_i64gather_pd::<8>(x, table.as_ptr()),
                _mm512_i64gather_pd::<8>(y, table.as_ptr()),
            ]
        }
    }

    #[inline(always)]
    fn splat_whole(self, x: u64) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_set1_epi64(x as i64) }
    }

    #[inline(always)]
    fn right<const BY: u32>(self, a: __m512i) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_srli_epi64::<BY>(a) }
    }

    #[inline(always)]
    fn left<const BY: u32>(self, a: __m512i) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_slli_epi64::<BY>(a) }
    }

    #[inline(always)]
    fn splat_short(self, x: f32) -> __m512 {
        // SAFETY: as above.
        unsafe { _mm512_set1_ps(x) }
    }

    #[inline(always)]
    fn read_shorts(self, row: &Singles) -> __m512 {
        // SAFETY: as above; a row is 64 bytes at an address divisible by 64.
        unsafe { _mm512_load_ps(row.0.as_ptr()) }
    }

    #[inline(always)]
    fn choose_less(self, [low, high]: [__m512; 2], x: __m512, other: __m512) -> __m512 {
        // SAFETY: as above.
        unsafe {
            let lanes = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(low, high);
            _mm512_mask_blend_ps(lanes, other, x)
        }
    }

    #[inline(always)]
    fn least_of_reals(self, a: __m512d) -> (f64, usize) {
        // SAFETY: as above.
        unsafe {
            let least = _mm512_reduce_min_pd(a);
            let there = _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, _mm512_set1_pd(least));
            (least, there.trailing_zeros() as usize & 7)
        }
    }

    #[inline(always)]
    fn least(self, a: __m512) -> (f32, usize) {
        // SAFETY: as above.
        unsafe {
            let least = _mm512_reduce_min_ps(a);
            let there = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, _mm512_set1_ps(least));
            (least, there.trailing_zeros() as usize & 15)
        }
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> u8 {
        bits
    }

    #[inline(always)]
    fn bits_of_mask(self, a: u8) -> u8 {
        a
    }

    #[inline(always)]
    fn any(self, a: u8) -> bool {
        a != 0
    }

    #[inline(always)]
    fn both(self, a: u8, b: u8) -> u8 {
        a & b
    }

    #[inline(always)]
    fn either(self, a: u8, b: u8) -> u8 {
        a | b
    }

    #[inline(always)]
    fn one_of(self, a: u8, b: u8) -> u8 {
        a ^ b
    }

    #[inline(always)]
    fn others(self, a: u8) -> u8 {
        !a
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
