//! Cosine and sine of an angle given as a fraction of a turn.
//!
//! A random azimuth needs no reduction of large angles, so a polynomial does, in a third of the time
//! of the library's functions; and those differ by a last bit from one processor to the next, which
//! these do not.

use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

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
    use std::f64::consts::TAU;

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
}
