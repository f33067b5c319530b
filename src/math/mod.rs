//! Maps of cells, light in cylinders, frames, turns, triangles, splines, exponentials, a Bessel function, what is quick in single precision, steps, numbers eight at a time, unit vectors in 32 bits, the unicube map and Fresnel equations.

pub(crate) mod bessel;
pub(crate) mod cells;
pub(crate) mod crossings;
pub mod decay;
pub mod ease;
pub mod frame;
pub mod fresnel;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes;
pub mod octahedral;
pub(crate) mod quick;
pub(crate) mod shear;
pub(crate) mod spline;
pub mod symmetry;
pub(crate) mod triangle;
pub mod turn;
pub mod unicube;

/// Runs loops with the widest registers that the processor has. Results are the same bits: the compiler neither
/// reorders sums nor contracts products. What is to profit must be inlined.
#[inline(always)]
pub(crate) fn widest<R>(f: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = lanes::Avx512::detect() {
        return lanes::Wide::run(avx512, f);
    }
    f()
}

/// Whether [`widest`] has registers of 512 bits.
pub(crate) fn has_wide_registers() -> bool {
    #[cfg(target_arch = "x86_64")]
    return lanes::Avx512::detect().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    false
}
