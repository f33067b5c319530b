//! Pixel filters: where in and around its pixel a sample looks.
//!
//! Samples are drawn by the filter itself, so that each counts the same and pixels share none.

use serde::{Deserialize, Serialize};

/// Standard deviation of the Gaussian, pixels. 0.3 shows stairs on single hairs, 0.6 blurs them.
pub const GAUSSIAN_SIGMA: f32 = 0.42;

/// A pixel filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filter {
    /// A Gaussian of [`GAUSSIAN_SIGMA`].
    #[default]
    Gaussian,
    /// Even over the pixel.
    Box,
    /// A tent of two pixels.
    Tent,
}

impl Filter {
    /// Offset from the middle of the pixel, pixels.
    ///
    /// * `u`: two numbers in `[0, 1)`.
    pub fn offset(self, u: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Gaussian => {
                let radius = GAUSSIAN_SIGMA * (-2.0 * (1.0 - u[0]).ln()).sqrt();
                let (sin, cos) = (std::f32::consts::TAU * u[1]).sin_cos();
                [radius * cos, radius * sin]
            }
            Self::Box => u.map(|u| u - 0.5),
            Self::Tent => u.map(|u| {
                if u < 0.5 {
                    (2.0 * u).sqrt() - 1.0
                } else {
                    1.0 - (2.0 - 2.0 * u).sqrt()
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sobol;

    #[test]
    fn filters_are_centered_and_as_wide_as_they_should_be() {
        let net = Sobol::new(3);
        for (filter, variance) in [
            (Filter::Gaussian, GAUSSIAN_SIGMA * GAUSSIAN_SIGMA),
            (Filter::Box, 1.0 / 12.0),
            (Filter::Tent, 1.0 / 6.0),
        ] {
            let n = 1 << 14;
            let (mut mean, mut square) = ([0.0f32; 2], [0.0f32; 2]);
            for i in 0..n {
                let u = net.point(i);
                let at = filter.offset([u[0], u[1]]);
                for axis in 0..2 {
                    mean[axis] += at[axis] / n as f32;
                    square[axis] += at[axis] * at[axis] / n as f32;
                }
            }
            for axis in 0..2 {
                assert!(mean[axis].abs() < 2e-3, "{filter:?}: {mean:?}");
                assert!((square[axis] / variance - 1.0).abs() < 0.01, "{filter:?}");
            }
        }
    }
}
