//! Powers by polynomials: six digits, and a loop of them becomes SIMD instructions, which one of
//! calls into the math library does not.

/// `x^p` to a relative `1e-6 (1 + |log2 x|)`, within the range of normal floats.
///
/// * `x`: finite and not negative; 0 counts as `2^-127`.
#[inline]
pub(super) fn power(x: f32, p: f32) -> f32 {
    exp2(p * log2(x))
}

/// The logarithm of the mantissa by the series of `atanh`, the exponent from its bits.
#[inline]
fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let mantissa = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000);
    // To 1 / sqrt 2 .. sqrt 2, around 1.
    let above = mantissa > std::f32::consts::SQRT_2;
    let (m, e) = if above {
        (0.5 * mantissa, exponent + 1)
    } else {
        (mantissa, exponent)
    };
    let t = (m - 1.0) / (m + 1.0);
    let s = t * t;
    let series = 1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s * (1.0 / 9.0))));
    e as f32 + 2.0 * std::f32::consts::LOG2_E * t * series
}

/// A Taylor polynomial within half an integer, the integer into the exponent's bits.
#[inline]
fn exp2(y: f32) -> f32 {
    /// Added, it leaves no bits for fractions: rounds, and shows the integer in its low bits.
    const ROUNDER: f32 = 12_582_912.0;
    let y = y.clamp(-126.0, 126.0);
    let shifted = y + ROUNDER;
    let whole = shifted.to_bits().wrapping_sub(ROUNDER.to_bits());
    let x = (y - (shifted - ROUNDER)) * std::f32::consts::LN_2;
    let series = 1.0
        + x * (1.0
            + x * (1.0 / 2.0
                + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0 + x * (1.0 / 720.0))))));
    series * f32::from_bits(whole.wrapping_add(127) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for i in 0..4000 {
            let x = 10f64.powf(-30.0 + f64::from(i) * 0.01);
            for p in [-1.0, -0.3, 0.0, 0.001, 0.5, 0.77, 1.0, 2.5] {
                let truth = (x as f32).powf(p);
                if (1e-36..1e36).contains(&truth) {
                    let off = (power(x as f32, p) / truth - 1.0).abs();
                    let least = 1e-6 * (1.0 + f64::from((x as f32).log2().abs()) as f32);
                    assert!(off < least, "{x}^{p}: off by {off}");
                }
            }
        }
        assert_eq!(power(0.0, 0.0), 1.0);
        assert_eq!(power(1.0, 0.3), 1.0);
        assert!(power(0.0, 1.0) < 1e-37 && power(0.0, -1.0) > 1e37);
    }
}
