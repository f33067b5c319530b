//! The exponential function of negative numbers.
//!
//! The library's looks which instructions a processor has and differs by a last bit from one to the
//! next; this one does not, and it can be inlined.

use std::f64::consts::{LN_2, LOG2_E};

/// `e^-x` for `x >= 0`, off by less than 1e-15 of itself; 0 beyond 700.
///
/// A power of 2 times the Taylor series within half an octave, which ends below the last bit there. Only
/// sums, products and bits, so that compilers do several side by side.
#[inline(always)]
pub fn decay(x: f64) -> f64 {
    let near = if x < LARGEST { x } else { LARGEST };
    // Adding this leaves no place for a fraction: the last bits are the nearest whole number.
    let octaves = near * LOG2_E + WHOLE;
    let n = octaves - WHOLE;
    // In two steps, so that what the product is rounded by does not count.
    let r = (n * LN_2_HIGH - near) + n * LN_2_LOW;
    // By halves (Estrin): the chain of products is shorter.
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12, c13] = SERIES;
    let (r2, r4, r8) = (
        r * r,
        (r * r) * (r * r),
        (r * r) * (r * r) * ((r * r) * (r * r)),
    );
    let a = (c0 + c1 * r) + (c2 + c3 * r) * r2;
    let b = (c4 + c5 * r) + (c6 + c7 * r) * r2;
    let c = (c8 + c9 * r) + (c10 + c11 * r) * r2;
    let d = c12 + c13 * r;
    let series = (a + b * r4) + (c + d * r4) * r8;
    let power = f64::from_bits((1023 << 52) - (octaves.to_bits() << 52));
    if x <= LARGEST { power * series } else { 0.0 }
}

const LARGEST: f64 = 700.0;

/// 1.5 times 2^52.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// The first 32 bits of ln 2: times a small whole number they are exact.
const LN_2_HIGH: f64 = f64::from_bits(LN_2.to_bits() & !0x1f_ffff);
/// What that is short of ln 2; 2.3e-17 is what [`LN_2`] is.
const LN_2_LOW: f64 = (LN_2 - LN_2_HIGH) + 2.319_046_813_846_3e-17;

/// Inverse factorials of 0, 1, ... 13.
const SERIES: [f64; 14] = {
    let (mut all, mut i) = ([1.0; 14], 1);
    while i < all.len() {
        all[i] = all[i - 1] / i as f64;
        i += 1;
    }
    all
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in 0..200_000 {
            let x = f64::from(i) * 0.003_5;
            let (found, exact) = (decay(x), (-x).exp());
            assert!((found / exact - 1.0).abs() < 1e-15, "{x}: {found:e}");
        }
        assert_eq!(decay(0.0), 1.0);
        assert_eq!((decay(701.0), decay(f64::INFINITY)), (0.0, 0.0));
    }
}
