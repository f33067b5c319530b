//! Cosine and sine of an angle given as a fraction of a turn.
//!
//! A random azimuth needs no reduction of large angles, so a polynomial does, in a third of the time
//! of the library's functions; and those differ by a last bit from one processor to the next, which
//! these do not.

#[cfg(target_arch = "x86_64")]
use super::lanes::{F64x8, U64x8, Wide};
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Unit vector at `turn` of a whole turn from x toward y; `turn` in `[0, 1]`.
///
/// Taylor series within an eighth of a turn, which end below the last bit there.
#[inline]
pub fn unit_vector(turn: f64) -> DVec2 {
    let quarters = 4.0 * turn;
    let nearest = (quarters + 0.5) as i32;
    let x = (quarters - f64::from(nearest)) * FRAC_PI_2;
    let x2 = x * x;
    let sin = x + x * x2 * series(x2, SIN);
    let cos = 1.0 + x2 * series(x2, COS);
    let (c, s) = if nearest & 1 == 0 {
        (cos, sin)
    } else {
        (-sin, cos)
    };
    if nearest & 2 == 0 {
        DVec2::new(c, s)
    } else {
        DVec2::new(-c, -s)
    }
}

/// Unit vector at `bits` / 2^32 of a whole turn from x toward y, good to 1e-11: for random azimuths.
///
/// The high bits look up a direction, which the low bits turn a little further.
#[inline]
pub fn unit_vector_of(bits: u32) -> DVec2 {
    let [x, y] = DIRECTIONS[(bits >> 24) as usize];
    // Less than an eightieth of a radian.
    let angle = f64::from((bits & 0x00ff_ffff) as i32 - 0x0080_0000) * (TAU / 4_294_967_296.0);
    let a2 = angle * angle;
    let (sin, cos) = (
        angle - angle * a2 * (1.0 / 6.0),
        1.0 - a2 * (0.5 - a2 * (1.0 / 24.0)),
    );
    DVec2::new(x * cos - y * sin, x * sin + y * cos)
}

/// [`unit_vector_of`] eight at a time: x and y.
///
/// * `bits`: below 2^32.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn unit_vectors_of<W: Wide>(simd: W, bits: U64x8<W>) -> [F64x8<W>; 2] {
    let [x, y] = simd.pairs(&DIRECTIONS, bits.right::<24>());
    let low = bits.and(simd.all_bits(0x00ff_ffff));
    let angle = low.minus(simd.all_bits(0x0080_0000)).signed_to_f64() * (TAU / 4_294_967_296.0);
    let a2 = angle * angle;
    let (sin, cos) = (
        angle - angle * a2 * (1.0 / 6.0),
        1.0 - a2 * (0.5 - a2 * (1.0 / 24.0)),
    );
    [x * cos - y * sin, x * sin + y * cos]
}

/// Directions in the middle of 256 equal sectors.
static DIRECTIONS: [[f64; 2]; 256] = directions();

const fn directions() -> [[f64; 2]; 256] {
    let (mut all, mut i) = ([[0.0; 2]; 256], 0);
    while i < 64 {
        let angle = (i as f64 + 0.5) * (TAU / 256.0);
        // Taylor series of both, to the last bit within a quarter of a turn.
        let (mut sin, mut cos, mut term, mut n) = (0.0, 0.0, 1.0, 0);
        while n < 28 {
            let signed = if n & 2 == 0 { term } else { -term };
            if n & 1 == 0 {
                cos += signed;
            } else {
                sin += signed;
            }
            n += 1;
            term *= angle / n as f64;
        }
        all[i] = [cos, sin];
        all[i + 64] = [-sin, cos];
        all[i + 128] = [-cos, -sin];
        all[i + 192] = [sin, -cos];
        i += 1;
    }
    all
}

/// Inverse factorials of 3, 5, ... 15 and of 2, 4, ... 16.
const SIN: [f64; 7] = inverse_factorials(3);
const COS: [f64; 8] = inverse_factorials(2);

const fn inverse_factorials<const N: usize>(first: u64) -> [f64; N] {
    let (mut all, mut product, mut n, mut i) = ([0.0; N], 1, 1, 0);
    while i < N {
        while n < first + 2 * i as u64 {
            n += 1;
            product *= n;
        }
        all[i] = 1.0 / product as f64;
        i += 1;
    }
    all
}

/// `-c0 + c1 x2 - c2 x2^2 ...`
#[inline(always)]
fn series<const N: usize>(x2: f64, coefficients: [f64; N]) -> f64 {
    -coefficients.iter().rev().fold(0.0, |sum, c| c - x2 * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in 0..=100_000 {
            let turn = f64::from(i) / 100_000.0;
            let (sin, cos) = (TAU * turn).sin_cos();
            let found = unit_vector(turn);
            // The angle itself is rounded in the product above.
            let off = (found - DVec2::new(cos, sin)).length();
            assert!(off < 1e-15, "{turn}: {off:e}");
        }
        assert_eq!(unit_vector(0.25), DVec2::Y);
        assert_eq!(unit_vector(0.5), DVec2::NEG_X);
    }

    #[test]
    fn random_azimuths_are_those_of_their_bits() {
        for i in 0..100_000u32 {
            let bits = i.wrapping_mul(0x9e37_79b9);
            let (sin, cos) = (TAU * f64::from(bits) / 4_294_967_296.0).sin_cos();
            let off = (unit_vector_of(bits) - DVec2::new(cos, sin)).length();
            assert!(off < 1e-11, "{bits}: {off:e}");
        }
    }
}
