//! Numbers that change places between registers of AVX2.
#![allow(
    unsafe_code,
    reason = "measured faster; the processor was asked by whoever calls"
)]

use std::arch::x86_64::*;

/// Columns `AT` and the next of four rows.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn two_columns<const AT: usize, const N: usize>(
    [a, b, c, d]: [&[f64; N]; 4],
) -> [__m256d; 2] {
    const { assert!(AT + 1 < N) };
    // SAFETY: as the caller says; rows have two numbers from there on.
    unsafe {
        let (a, b) = (_mm_loadu_pd(&a[AT]), _mm_loadu_pd(&b[AT]));
        let (c, d) = (_mm_loadu_pd(&c[AT]), _mm_loadu_pd(&d[AT]));
        let (even, odd) = (_mm256_set_m128d(c, a), _mm256_set_m128d(d, b));
        [_mm256_unpacklo_pd(even, odd), _mm256_unpackhi_pd(even, odd)]
    }
}

/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn transposed([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    // SAFETY: as the caller says.
    unsafe {
        let (ab0, ab1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (cd0, cd1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab0, cd0),
            _mm256_permute2f128_pd::<0x20>(ab1, cd1),
            _mm256_permute2f128_pd::<0x31>(ab0, cd0),
            _mm256_permute2f128_pd::<0x31>(ab1, cd1),
        ]
    }
}

/// Four of eight entries.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn picked(low: __m256d, high: __m256d, index: __m256i) -> __m256d {
    // SAFETY: as the caller says.
    unsafe {
        // Halves of entries are picked: 2 k and 2 k + 1.
        let twice = _mm256_shuffle_epi32::<0b10_10_00_00>(_mm256_slli_epi64::<1>(index));
        let parts = _mm256_or_si256(twice, _mm256_set1_epi64x(1 << 32));
        let low = _mm256_permutevar8x32_ps(_mm256_castpd_ps(low), parts);
        let high = _mm256_permutevar8x32_ps(_mm256_castpd_ps(high), parts);
        let beyond = _mm256_castsi256_pd(_mm256_slli_epi64::<61>(index));
        _mm256_blendv_pd(_mm256_castps_pd(low), _mm256_castps_pd(high), beyond)
    }
}
