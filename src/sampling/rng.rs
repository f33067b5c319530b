//! A counter-based generator: the stream is a hash of (seed, index), then PCG steps.

#[cfg(target_arch = "x86_64")]
use crate::math::lanes::{F64x8, Mask, U64x8, Wide};

/// Mixes 64 bits into 64 well distributed bits (the finalizer of SplitMix64, Steele et al. 2014).
#[inline]
pub fn hash64(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Factor of a generator's step.
const FACTOR: u64 = 6_364_136_223_846_793_005;

/// PCG-XSH-RR (O'Neill 2014) with 64 bits of state. Frozen: baked tables depend on its bits.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
    increment: u64,
}

impl Rng {
    /// The stream of item `index` under `seed`; streams of different pairs are independent.
    #[inline]
    pub fn new(seed: u64, index: u64) -> Self {
        let a = hash64(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        let b = hash64(index.wrapping_add(a));
        Self {
            state: hash64(b ^ 0xd1b5_4a32_d192_ed03),
            increment: (b << 1) | 1,
        }
    }

    /// What it is made of: state and increment.
    #[inline]
    pub(crate) fn parts(&self) -> [u64; 2] {
        [self.state, self.increment]
    }

    /// The generator of these parts.
    #[inline]
    pub(crate) fn of_parts([state, increment]: [u64; 2]) -> Self {
        Self { state, increment }
    }

    /// 32 uniform bits.
    #[inline]
    pub fn bits(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(FACTOR).wrapping_add(self.increment);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// Uniform in `[0, 1)` with 32 bits of resolution.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.bits()) * (1.0 / 4_294_967_296.0)
    }

    /// Uniform in `[0, 1)`, never rounding up to 1 in single precision.
    #[inline]
    pub fn uniform_f32(&mut self) -> f32 {
        (self.bits() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// A pair of independent standard normal numbers (Box and Muller 1958).
    pub fn normal_pair(&mut self) -> (f64, f64) {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        (radius * cos, radius * sin)
    }
}

/// Eight generators side by side, each with the bits that it has alone.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct RngLanes<W: Wide> {
    pub(crate) state: U64x8<W>,
    pub(crate) increment: U64x8<W>,
}

#[cfg(target_arch = "x86_64")]
impl<W: Wide> RngLanes<W> {
    /// 32 uniform bits of each in `lanes`; the others stay where they are.
    #[inline(always)]
    pub(crate) fn bits(&mut self, simd: W, lanes: Mask<W>) -> U64x8<W> {
        let old = self.state;
        let next = old.times(simd.all_bits(FACTOR)).plus(self.increment);
        self.state = next.or(lanes, old);
        let mixed = old.right::<18>().xor(old).right::<27>();
        let turned = mixed.low_turned_right(old.right::<59>());
        turned.and(simd.all_bits(u64::from(u32::MAX)))
    }

    /// Uniform in `[0, 1)`; see [`Rng::uniform`].
    #[inline(always)]
    pub(crate) fn uniform(&mut self, simd: W, lanes: Mask<W>) -> F64x8<W> {
        self.bits(simd, lanes).to_f64() * (1.0 / 4_294_967_296.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighboring_streams_are_uniform_and_uncorrelated() {
        let n = 100_000;
        let (mut mean, mut product) = (0.0, 0.0);
        for i in 0..n {
            let a = Rng::new(1, i).uniform() - 0.5;
            let b = Rng::new(1, i + 1).uniform() - 0.5;
            mean += a;
            product += a * b;
        }
        let n = n as f64;
        assert!((mean / n).abs() < 4.0 * (1.0 / 12.0f64).sqrt() / n.sqrt());
        assert!((product / n).abs() < 4.0 * (1.0 / 12.0) / n.sqrt());
    }

    #[test]
    fn normal_moments() {
        let mut rng = Rng::new(3, 9);
        let n = 200_000;
        let (mut m1, mut m2) = (0.0, 0.0);
        for _ in 0..n {
            let (a, b) = rng.normal_pair();
            m1 += a + b;
            m2 += a * a + b * b;
        }
        let n = 2.0 * f64::from(n);
        assert!((m1 / n).abs() < 4.0 / n.sqrt());
        assert!((m2 / n - 1.0).abs() < 4.0 * (2.0f64).sqrt() / n.sqrt());
    }
}
