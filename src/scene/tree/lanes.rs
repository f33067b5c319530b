//! Eight numbers at a time.

use glam::Vec4;

/// Eight numbers in single precision. Every operation rounds as it does on one number, so that results are the same to the
/// bit whatever does it.
pub(in crate::scene) trait Lanes {
    /// Eight numbers.
    type F: Copy;
    fn splat(x: f32) -> Self::F;
    fn bytes(x: &[u8; 8]) -> Self::F;
    fn words(x: &[u16; 8]) -> Self::F;
    fn add(a: Self::F, b: Self::F) -> Self::F;
    fn sub(a: Self::F, b: Self::F) -> Self::F;
    fn mul(a: Self::F, b: Self::F) -> Self::F;
    fn div(a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`, rounded once or twice: the exception, for what need not be the same to the bit.
    fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    fn min(a: Self::F, b: Self::F) -> Self::F;
    fn max(a: Self::F, b: Self::F) -> Self::F;
    /// Where `a <= b`, a bit each.
    fn le(a: Self::F, b: Self::F) -> u32;
    fn array(a: Self::F) -> [f32; 8];
}

/// For every processor.
pub(in crate::scene) struct Plain;

impl Lanes for Plain {
    type F = [Vec4; 2];

    #[inline(always)]
    fn splat(x: f32) -> Self::F {
        [Vec4::splat(x); 2]
    }

    #[inline(always)]
    fn bytes(x: &[u8; 8]) -> Self::F {
        let f = x.map(f32::from);
        [
            Vec4::new(f[0], f[1], f[2], f[3]),
            Vec4::new(f[4], f[5], f[6], f[7]),
        ]
    }

    #[inline(always)]
    fn words(x: &[u16; 8]) -> Self::F {
        let f = x.map(f32::from);
        [
            Vec4::new(f[0], f[1], f[2], f[3]),
            Vec4::new(f[4], f[5], f[6], f[7]),
        ]
    }

    #[inline(always)]
    fn add(a: Self::F, b: Self::F) -> Self::F {
        [a[0] + b[0], a[1] + b[1]]
    }

    #[inline(always)]
    fn sub(a: Self::F, b: Self::F) -> Self::F {
        [a[0] - b[0], a[1] - b[1]]
    }

    #[inline(always)]
    fn mul(a: Self::F, b: Self::F) -> Self::F {
        [a[0] * b[0], a[1] * b[1]]
    }

    #[inline(always)]
    fn div(a: Self::F, b: Self::F) -> Self::F {
        [a[0] / b[0], a[1] / b[1]]
    }

    #[inline(always)]
    fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        Self::add(Self::mul(a, b), c)
    }

    #[inline(always)]
    fn min(a: Self::F, b: Self::F) -> Self::F {
        [a[0].min(b[0]), a[1].min(b[1])]
    }

    #[inline(always)]
    fn max(a: Self::F, b: Self::F) -> Self::F {
        [a[0].max(b[0]), a[1].max(b[1])]
    }

    #[inline(always)]
    fn le(a: Self::F, b: Self::F) -> u32 {
        a[0].cmple(b[0]).bitmask() | a[1].cmple(b[1]).bitmask() << 4
    }

    #[inline(always)]
    fn array(a: Self::F) -> [f32; 8] {
        let ([a, b, c, d], [e, f, g, h]) = (a[0].to_array(), a[1].to_array());
        [a, b, c, d, e, f, g, h]
    }
}

/// For processors with AVX2 and FMA. To be used within functions that enable it only, without closures between, which would
/// not be compiled for it.
#[cfg(target_arch = "x86_64")]
pub(in crate::scene) struct Avx2;

#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "measured faster; whoever calls has asked the processor whether it has AVX2, and the pointers are of \
              arrays as long as what is read"
)]
mod avx2 {
    use super::{Avx2, Lanes};
    use std::arch::x86_64::*;

    macro_rules! both {
        ($name:ident, $intrinsic:ident) => {
            #[inline(always)]
            fn $name(a: __m256, b: __m256) -> __m256 {
                unsafe { $intrinsic(a, b) }
            }
        };
    }

    impl Lanes for Avx2 {
        type F = __m256;
        both!(add, _mm256_add_ps);
        both!(sub, _mm256_sub_ps);
        both!(mul, _mm256_mul_ps);
        both!(div, _mm256_div_ps);
        both!(min, _mm256_min_ps);
        both!(max, _mm256_max_ps);

        #[inline(always)]
        fn mul_add(a: __m256, b: __m256, c: __m256) -> __m256 {
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn splat(x: f32) -> __m256 {
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        fn bytes(x: &[u8; 8]) -> __m256 {
            unsafe {
                let x = _mm_loadl_epi64(x.as_ptr().cast());
                _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(x))
            }
        }

        #[inline(always)]
        fn words(x: &[u16; 8]) -> __m256 {
            unsafe {
                let x = _mm_loadu_si128(x.as_ptr().cast());
                _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(x))
            }
        }

        #[inline(always)]
        fn le(a: __m256, b: __m256) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
        }

        #[inline(always)]
        fn array(a: __m256) -> [f32; 8] {
            let mut all = [0.0; 8];
            unsafe { _mm256_storeu_ps(all.as_mut_ptr(), a) };
            all
        }
    }
}
