//! The modified Bessel function I0 as series: Abramowitz and Stegun 9.8.1 and 9.8.2, off by less than 2e-7 of itself.

/// From here on [`FAR`] holds.
pub(crate) const EDGE: f64 = 3.75;

/// `I0(x)` in powers of `(x / EDGE)^2`.
pub(crate) const NEAR: [f64; 7] = [
    1.0,
    3.515_622_9,
    3.089_942_4,
    1.206_749_2,
    0.265_973_2,
    0.036_076_8,
    0.004_581_3,
];

/// `sqrt(x) exp(-x) I0(x)` in powers of `EDGE / x`.
pub(crate) const FAR: [f64; 9] = [
    0.398_942_28,
    0.013_285_92,
    0.002_253_19,
    -0.001_575_65,
    0.009_162_81,
    -0.020_577_06,
    0.026_355_37,
    -0.016_476_33,
    0.003_923_77,
];

/// The same in single precision.
pub(crate) const fn single<const N: usize>(coefficients: [f64; N]) -> [f32; N] {
    let mut narrow = [0.0; N];
    let mut i = 0;
    while i < N {
        narrow[i] = coefficients[i] as f32;
        i += 1;
    }
    narrow
}
