//! What becomes of light that crosses a cylinder, part of it reflected back in each time.

use glam::Vec3;
use std::ops::{Div, Mul, Sub};

/// Shares of light: of one channel, or of three side by side.
pub(crate) trait Share:
    Copy + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// All of it.
    const ALL: Self;
}

impl Share for f64 {
    const ALL: Self = 1.0;
}

impl Share for Vec3 {
    const ALL: Self = Self::ONE;
}

/// R, TT, TRT, and all light of more reflections inside (Chiang et al. 2016).
///
/// * `f`: reflectance of the surface, the same whenever the ray meets it: in a cylinder its angle stays.
/// * `t`: what a crossing leaves on the straight path.
#[inline(always)]
pub(crate) fn straight<S: Share>(f: S, t: S) -> [S; 4] {
    let tt = (S::ALL - f) * (S::ALL - f) * t;
    let trt = tt * t * f;
    [f, tt, trt, trt * t * f / (S::ALL - f * t)]
}

/// Light that is scattered off the straight path, at the first crossing or any later one. Without absorption it
/// and what stays on the path are all there is.
///
/// * `f`, `t`: as above. * `scattered`: the share of light on the path that a crossing scatters off it.
#[inline(always)]
pub(crate) fn scattered<S: Share>(f: S, t: S, scattered: S) -> S {
    (S::ALL - f) * scattered / (S::ALL - f * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Crossing by crossing.
    #[test]
    fn sums_are_those_of_the_crossings() {
        for (f, t, taken) in [(0.05, 0.6, 0.3), (0.9, 0.95, 0.05), (0.4, 1.0, 0.0)] {
            let (mut out, mut off) = (vec![f], 0.0);
            let mut inside = 1.0 - f;
            for _ in 0..2000 {
                off += inside * taken;
                out.push(inside * t * (1.0 - f));
                inside *= t * f;
            }
            let [r, tt, trt, rest] = straight(f, t);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{f} {t}: {a} {b}");
            close(r, out[0]);
            close(tt, out[1]);
            close(trt, out[2]);
            close(rest, out[3..].iter().sum());
            close(scattered(f, t, taken), off);
            if t + taken == 1.0 {
                close(out.iter().sum::<f64>() + off, 1.0);
            }
        }
    }
}
