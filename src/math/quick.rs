//! Functions in single precision from sums and products alone, where the library's cost more and know more
//! than is asked for.

use glam::Vec4;
use std::f32::consts::{LOG2_E, TAU};

/// Exponent below which [`exp`] stays where it is: products of two such are no denormals, which are slow.
pub(crate) const LOWEST: f32 = -43.0;

/// `e^x` of four numbers, off by less than 2e-7 of itself up to 88; 2e-19 from [`LOWEST`] down.
#[inline(always)]
pub(crate) fn exp(x: Vec4) -> Vec4 {
    // 1.5 times 2^23: adding this leaves no place for a fraction.
    const WHOLE: f32 = 12_582_912.0;
    // ln 2 in two steps; the first has so few bits that its product is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let x = x.max(Vec4::splat(LOWEST));
    let octaves = x * LOG2_E + WHOLE;
    let n = octaves - WHOLE;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    // (e^r - 1 - r) / r^2 on half an octave either way, off by 1e-8 at most: a fit at Chebyshev's points.
    const REST: [f32; 5] = [0.5, 0.166_665_76, 0.041_666_46, 0.008_363_24, 0.001_393_37];
    let [c0, c1, c2, c3, c4] = REST;
    let r2 = r * r;
    let rest = (c0 + c1 * r) + (c2 + c3 * r + c4 * r2) * r2;
    let series = rest * r2 + r + 1.0;
    let power = |n: f32| f32::from_bits((n.to_bits() << 23).wrapping_add(1.0f32.to_bits()));
    series * Vec4::from_array(octaves.to_array().map(power))
}

/// `atan2(y, x)` as a share of a full turn, -0.5..0.5, off by 1e-7 at most: a third of the price of the
/// library's.
#[inline(always)]
pub(crate) fn turns(y: f32, x: f32) -> f32 {
    const ODD: [f32; 8] = [
        0.999_999_9,
        -0.333_319_6,
        0.199_692_35,
        -0.140_165_85,
        0.099_060_97,
        -0.059_367_1,
        0.024_166_19,
        -0.004_668_773,
    ];
    let (ax, ay) = (x.abs(), y.abs());
    let a = ax.min(ay) / ax.max(ay).max(f32::MIN_POSITIVE);
    let t = a * ODD.iter().rfold(0.0, |sum, c| sum * (a * a) + c) * (1.0 / TAU);
    let t = if ay > ax { 0.25 - t } else { t };
    let t = if x < 0.0 { 0.5 - t } else { t };
    t.copysign(y)
}

/// Sine and cosine of an angle given as a share of a full turn, off by 1e-7 at most, for at most a thousand turns.
#[inline(always)]
pub(crate) fn sin_cos_of_turns(turns: f32) -> (f32, f32) {
    // 1.5 times 2^23: adding this leaves no place for a fraction.
    const WHOLE: f32 = 12_582_912.0;
    let quarters = turns * 4.0 + WHOLE;
    // At most an eighth of a turn either way.
    let rest = turns - (quarters - WHOLE) * 0.25;
    let x = rest * TAU;
    let x2 = x * x;
    let sin = x + x * x2 * (-0.166_666_55 + x2 * (0.008_332_161 - x2 * 1.951_529_6e-4));
    let cos =
        1.0 - 0.5 * x2 + x2 * x2 * (0.041_666_646 + x2 * (-0.001_388_731_6 + x2 * 2.443_315_7e-5));
    let quarter = quarters.to_bits();
    let (s, c) = if quarter & 1 == 0 {
        (sin, cos)
    } else {
        (cos, sin)
    };
    let s = f32::from_bits(s.to_bits() ^ ((quarter & 2) << 30));
    let c = f32::from_bits(c.to_bits() ^ ((quarter.wrapping_add(1) & 2) << 30));
    (s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_those_of_the_library() {
        for i in 0..400_000 {
            let x = i as f32 * -1e-4;
            let found = exp(Vec4::new(x, 0.5 * x, -x, x + 1.0));
            for (x, found) in [x, 0.5 * x, -x, x + 1.0].into_iter().zip(found.to_array()) {
                let exact = f64::from(x).exp();
                assert!(
                    (f64::from(found) / exact - 1.0).abs() < 2e-7,
                    "{x}: {found:e}"
                );
            }
        }
        assert_eq!(exp(Vec4::ZERO), Vec4::ONE);
        assert_eq!(
            exp(Vec4::splat(f32::NEG_INFINITY)),
            exp(Vec4::splat(LOWEST))
        );
    }

    #[test]
    fn turns_are_those_of_the_library() {
        for i in 0..10_000 {
            let (sin, cos) = (f64::from(i) * 1e-3 - 5.0).sin_cos();
            let (y, x) = ((0.7 * sin) as f32, (0.7 * cos) as f32);
            let exact = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
            assert!((f64::from(turns(y, x)) - exact).abs() < 1e-7, "{y} {x}");
        }
        for i in -40_000..40_000 {
            let t = i as f32 * 1e-4;
            let (sin, cos) = sin_cos_of_turns(t);
            let exact = (f64::from(t) * std::f64::consts::TAU).sin_cos();
            let off = (f64::from(sin) - exact.0)
                .abs()
                .max((f64::from(cos) - exact.1).abs());
            assert!(off < 1.5e-7, "{t}: {off:e}");
        }
        assert_eq!(turns(0.0, 0.0), 0.0);
        assert_eq!((turns(1.0, 0.0), turns(0.0, -1.0)), (0.25, 0.5));
    }
}
