//! Eight numbers in two registers of AVX2.
//!
//! FMA is left out: nothing may be rounded once that a plain number rounds twice.
#![allow(
    unsafe_code,
    reason = "measured faster; the processor was asked, since there is an `Avx2`"
)]

use super::fours::{picked, transposed, two_columns};
use super::{LANES, Row, Singles, U64x8, Wide};
use std::arch::x86_64::*;

/// Proof that the processor has AVX2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// Asks the processor.
    pub(crate) fn detect() -> Option<Self> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Self(()))
    }
}

/// What is done to each half alone.
macro_rules! halves {
    ($($name:ident($($arg:ident: $type:ident),*) -> $out:ident { $($do:tt)* })*) => {
        $(
            #[inline(always)]
            fn $name(self, $($arg: Self::$type),*) -> Self::$out {
                // SAFETY: the processor has AVX2, as `self` proves.
                unsafe {
                    [
                        { $(let $arg = $arg[0];)* $($do)* },
                        { $(let $arg = $arg[1];)* $($do)* },
                    ]
                }
            }
        )*
    };
}

/// 2^52: added to a whole number below it as bits, it makes it a number.
const TO_REAL: f64 = 4_503_599_627_370_496.0;
/// 1.5 * 2^52: the same for whole numbers from -2^51 on.
const SIGNED_TO_REAL: f64 = 6_755_399_441_055_744.0;

impl Wide for Avx2 {
    type Reals = [__m256d; 2];
    type Wholes = [__m256i; 2];
    type Shorts = [__m256; 2];
    /// All bits of a lane or none.
    type Mask = [__m256d; 2];

    #[inline(always)]
    fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        fn run<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the processor has what the function enables.
        unsafe { run(f) }
    }

    halves! {
        choose(lanes: Mask, x: Reals, other: Reals) -> Reals { _mm256_blendv_pd(other, x, lanes) }
        add(a: Reals, b: Reals) -> Reals { _mm256_add_pd(a, b) }
        sub(a: Reals, b: Reals) -> Reals { _mm256_sub_pd(a, b) }
        mul(a: Reals, b: Reals) -> Reals { _mm256_mul_pd(a, b) }
        div(a: Reals, b: Reals) -> Reals { _mm256_div_pd(a, b) }
        min(a: Reals, b: Reals) -> Reals { _mm256_min_pd(a, b) }
        max(a: Reals, b: Reals) -> Reals { _mm256_max_pd(a, b) }
        neg(a: Reals) -> Reals { _mm256_xor_pd(a, _mm256_set1_pd(-0.0)) }
        abs(a: Reals) -> Reals { _mm256_andnot_pd(_mm256_set1_pd(-0.0), a) }
        with_sign_of(a: Reals, b: Reals) -> Reals {
            let sign = _mm256_set1_pd(-0.0);
            _mm256_or_pd(_mm256_andnot_pd(sign, a), _mm256_and_pd(sign, b))
        }
        sqrt(a: Reals) -> Reals { _mm256_sqrt_pd(a) }
        floor(a: Reals) -> Reals { _mm256_floor_pd(a) }
        less(a: Reals, b: Reals) -> Mask { _mm256_cmp_pd::<_CMP_LT_OQ>(a, b) }
        at_most(a: Reals, b: Reals) -> Mask { _mm256_cmp_pd::<_CMP_LE_OQ>(a, b) }
        equal(a: Reals, b: Reals) -> Mask { _mm256_cmp_pd::<_CMP_EQ_OQ>(a, b) }

        bits_of(a: Reals) -> Wholes { _mm256_castpd_si256(a) }
        of_bits(a: Wholes) -> Reals { _mm256_castsi256_pd(a) }
        // What has no whole part of 32 bits comes to 2^31.
        whole(a: Reals) -> Wholes { _mm256_cvtepu32_epi64(_mm256_cvttpd_epi32(a)) }
        real(a: Wholes) -> Reals {
            let by = _mm256_set1_pd(TO_REAL);
            let sum = _mm256_or_si256(a, _mm256_castpd_si256(by));
            _mm256_sub_pd(_mm256_castsi256_pd(sum), by)
        }
        signed_real(a: Wholes) -> Reals {
            let by = _mm256_set1_pd(SIGNED_TO_REAL);
            let sum = _mm256_add_epi64(a, _mm256_castpd_si256(by));
            _mm256_sub_pd(_mm256_castsi256_pd(sum), by)
        }

        choose_wholes(lanes: Mask, x: Wholes, other: Wholes) -> Wholes {
            _mm256_blendv_epi8(other, x, _mm256_castpd_si256(lanes))
        }
        // Twice the number beside itself: what is moved out of the lower half comes from the upper one.
        low_turned_right(a: Wholes, by: Wholes) -> Wholes {
            _mm256_srlv_epi64(_mm256_shuffle_epi32::<0b10_10_00_00>(a), by)
        }
        times(a: Wholes, b: Wholes) -> Wholes {
            let (a1, b1) = (_mm256_srli_epi64::<32>(a), _mm256_srli_epi64::<32>(b));
            let across = _mm256_add_epi64(_mm256_mul_epu32(a1, b), _mm256_mul_epu32(a, b1));
            _mm256_add_epi64(_mm256_mul_epu32(a, b), _mm256_slli_epi64::<32>(across))
        }
        plus(a: Wholes, b: Wholes) -> Wholes { _mm256_add_epi64(a, b) }
        minus(a: Wholes, b: Wholes) -> Wholes { _mm256_sub_epi64(a, b) }
        and(a: Wholes, b: Wholes) -> Wholes { _mm256_and_si256(a, b) }
        xor(a: Wholes, b: Wholes) -> Wholes { _mm256_xor_si256(a, b) }
        // Only signed numbers can be compared.
        less_wholes(a: Wholes, b: Wholes) -> Mask {
            let half = _mm256_set1_epi64x(i64::MIN);
            let (a, b) = (_mm256_xor_si256(a, half), _mm256_xor_si256(b, half));
            _mm256_castsi256_pd(_mm256_cmpgt_epi64(b, a))
        }
        equal_wholes(a: Wholes, b: Wholes) -> Mask { _mm256_castsi256_pd(_mm256_cmpeq_epi64(a, b)) }

        add_shorts(a: Shorts, b: Shorts) -> Shorts { _mm256_add_ps(a, b) }
        sub_shorts(a: Shorts, b: Shorts) -> Shorts { _mm256_sub_ps(a, b) }
        mul_shorts(a: Shorts, b: Shorts) -> Shorts { _mm256_mul_ps(a, b) }
        div_shorts(a: Shorts, b: Shorts) -> Shorts { _mm256_div_ps(a, b) }

        both(a: Mask, b: Mask) -> Mask { _mm256_and_pd(a, b) }
        either(a: Mask, b: Mask) -> Mask { _mm256_or_pd(a, b) }
        one_of(a: Mask, b: Mask) -> Mask { _mm256_xor_pd(a, b) }
        others(a: Mask) -> Mask { _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x(-1))) }
    }

    #[inline(always)]
    fn splat(self, x: f64) -> Self::Reals {
        // SAFETY: the processor has AVX2, as `self` proves.
        [unsafe { _mm256_set1_pd(x) }; 2]
    }

    #[inline(always)]
    fn read(self, row: &Row) -> Self::Reals {
        let [low, high] = halves_of(row);
        // SAFETY: as above; halves are 32 bytes at addresses divisible by 32.
        unsafe { [_mm256_load_pd(low), _mm256_load_pd(high)] }
    }

    #[inline(always)]
    fn write(self, [low, high]: Self::Reals) -> Row {
        let mut row = Row::default();
        // SAFETY: as above.
        unsafe {
            _mm256_store_pd(row.0[..4].as_mut_ptr(), low);
            _mm256_store_pd(row.0[4..].as_mut_ptr(), high);
        }
        row
    }

    #[inline(always)]
    fn widen(self, singles: &[f32; LANES]) -> Self::Reals {
        let (low, high) = singles.split_at(4);
        // SAFETY: as above; halves are four numbers.
        unsafe {
            [
                _mm256_cvtps_pd(_mm_loadu_ps(low.as_ptr())),
                _mm256_cvtps_pd(_mm_loadu_ps(high.as_ptr())),
            ]
        }
    }

    #[inline(always)]
    fn read_columns(self, rows: [&Row; LANES]) -> [Self::Reals; LANES] {
        let [a, b, c, d, e, f, g, h] = rows;
        let low = [&a.0, &b.0, &c.0, &d.0];
        let high = [&e.0, &f.0, &g.0, &h.0];
        // SAFETY: as above.
        unsafe {
            let ([a0, a1], [b0, b1]) = (two_columns::<0, _>(low), two_columns::<0, _>(high));
            let ([a2, a3], [b2, b3]) = (two_columns::<2, _>(low), two_columns::<2, _>(high));
            let ([a4, a5], [b4, b5]) = (two_columns::<4, _>(low), two_columns::<4, _>(high));
            let ([a6, a7], [b6, b7]) = (two_columns::<6, _>(low), two_columns::<6, _>(high));
            [
                [a0, b0],
                [a1, b1],
                [a2, b2],
                [a3, b3],
                [a4, b4],
                [a5, b5],
                [a6, b6],
                [a7, b7],
            ]
        }
    }

    #[inline(always)]
    fn transpose(self, [a, b, c, d, e, f, g, h]: [Self::Reals; LANES]) -> [Self::Reals; LANES] {
        // SAFETY: as above.
        unsafe {
            let [a0, a1, a2, a3] = transposed([a[0], b[0], c[0], d[0]]);
            let [a4, a5, a6, a7] = transposed([a[1], b[1], c[1], d[1]]);
            let [b0, b1, b2, b3] = transposed([e[0], f[0], g[0], h[0]]);
            let [b4, b5, b6, b7] = transposed([e[1], f[1], g[1], h[1]]);
            [
                [a0, b0],
                [a1, b1],
                [a2, b2],
                [a3, b3],
                [a4, b4],
                [a5, b5],
                [a6, b6],
                [a7, b7],
            ]
        }
    }

    #[inline(always)]
    fn read_pairs(self, table: &[[f64; 2]], index: Self::Wholes) -> [Self::Reals; 2] {
        let at = U64x8(self, index).array();
        // SAFETY: as above.
        unsafe {
            let [x0, y0] = two_columns::<0, _>([
                &table[at[0] as usize],
                &table[at[1] as usize],
                &table[at[2] as usize],
                &table[at[3] as usize],
            ]);
            let [x1, y1] = two_columns::<0, _>([
                &table[at[4] as usize],
                &table[at[5] as usize],
                &table[at[6] as usize],
                &table[at[7] as usize],
            ]);
            [[x0, x1], [y0, y1]]
        }
    }

    #[inline(always)]
    fn pick(self, [low, high]: Self::Reals, index: Self::Wholes) -> Self::Reals {
        // SAFETY: as above.
        unsafe { [picked(low, high, index[0]), picked(low, high, index[1])] }
    }

    #[inline(always)]
    fn splat_whole(self, x: u64) -> Self::Wholes {
        // SAFETY: as above.
        [unsafe { _mm256_set1_epi64x(x as i64) }; 2]
    }

    #[inline(always)]
    fn right<const BY: u32>(self, [low, high]: Self::Wholes) -> Self::Wholes {
        // SAFETY: as above.
        unsafe {
            let by = _mm_cvtsi32_si128(BY as i32);
            [_mm256_srl_epi64(low, by), _mm256_srl_epi64(high, by)]
        }
    }

    #[inline(always)]
    fn left<const BY: u32>(self, [low, high]: Self::Wholes) -> Self::Wholes {
        // SAFETY: as above.
        unsafe {
            let by = _mm_cvtsi32_si128(BY as i32);
            [_mm256_sll_epi64(low, by), _mm256_sll_epi64(high, by)]
        }
    }

    #[inline(always)]
    fn splat_short(self, x: f32) -> Self::Shorts {
        // SAFETY: as above.
        [unsafe { _mm256_set1_ps(x) }; 2]
    }

    #[inline(always)]
    fn read_shorts(self, row: &Singles) -> Self::Shorts {
        let (low, high) = row.0.split_at(8);
        // SAFETY: as above; halves are 32 bytes at addresses divisible by 32.
        unsafe { [_mm256_load_ps(low.as_ptr()), _mm256_load_ps(high.as_ptr())] }
    }

    #[inline(always)]
    fn choose_less(
        self,
        [low, high]: [Self::Shorts; 2],
        x: Self::Shorts,
        other: Self::Shorts,
    ) -> Self::Shorts {
        // SAFETY: as above.
        unsafe {
            let lanes = [
                _mm256_cmp_ps::<_CMP_LT_OQ>(low[0], high[0]),
                _mm256_cmp_ps::<_CMP_LT_OQ>(low[1], high[1]),
            ];
            [
                _mm256_blendv_ps(other[0], x[0], lanes[0]),
                _mm256_blendv_ps(other[1], x[1], lanes[1]),
            ]
        }
    }

    #[inline(always)]
    fn least_of_reals(self, a: Self::Reals) -> (f64, usize) {
        // SAFETY: as above.
        let least = unsafe {
            let four = _mm256_min_pd(a[0], a[1]);
            let two = _mm_min_pd(
                _mm256_castpd256_pd128(four),
                _mm256_extractf128_pd::<1>(four),
            );
            _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)))
        };
        let there = self.bits_of_mask(self.equal(a, self.splat(least)));
        (least, there.trailing_zeros() as usize & 7)
    }

    #[inline(always)]
    fn least(self, [low, high]: Self::Shorts) -> (f32, usize) {
        // SAFETY: as above.
        unsafe {
            let eight = _mm256_min_ps(low, high);
            let four = _mm_min_ps(
                _mm256_castps256_ps128(eight),
                _mm256_extractf128_ps::<1>(eight),
            );
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            let one = _mm_min_ss(two, _mm_shuffle_ps::<1>(two, two));
            let least = _mm_cvtss_f32(one);
            let all = _mm256_set1_ps(least);
            let there = [
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(low, all)),
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(high, all)),
            ];
            let there = there[0] | there[1] << 8;
            (least, there.trailing_zeros() as usize & 15)
        }
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> Self::Mask {
        // SAFETY: as above.
        unsafe {
            let bits = _mm256_set1_epi64x(i64::from(bits));
            let [low, high] = [
                _mm256_setr_epi64x(1, 2, 4, 8),
                _mm256_setr_epi64x(16, 32, 64, 128),
            ];
            [
                _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(bits, low), low)),
                _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(bits, high), high)),
            ]
        }
    }

    #[inline(always)]
    fn bits_of_mask(self, [low, high]: Self::Mask) -> u8 {
        // SAFETY: as above.
        let [low, high] = unsafe { [_mm256_movemask_pd(low), _mm256_movemask_pd(high)] };
        (low | high << 4) as u8
    }

    #[inline(always)]
    fn any(self, [low, high]: Self::Mask) -> bool {
        // SAFETY: as above.
        unsafe { _mm256_movemask_pd(_mm256_or_pd(low, high)) != 0 }
    }
}

/// Where both halves of a row are.
#[inline(always)]
fn halves_of(row: &Row) -> [*const f64; 2] {
    let (low, high) = row.0.split_at(4);
    [low.as_ptr(), high.as_ptr()]
}
