//! Random and quasi-random points. Every number is a function of (seed, index): nothing is shared
//! between threads, so any order of work gives the same bits.

mod rng;
mod sobol;

#[cfg(target_arch = "x86_64")]
pub(crate) use rng::RngLanes;
pub use rng::{Rng, hash64};
pub use sobol::Sobol;

/// A point uniform on the unit disk from two numbers in `[0, 1)` (Shirley and Chiu 1997).
pub fn concentric_disk(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let quarter = std::f64::consts::FRAC_PI_4;
    let (r, phi) = if a.abs() > b.abs() {
        (a, quarter * (b / a))
    } else {
        (b, 2.0 * quarter - quarter * (a / b))
    };
    (r * phi.cos(), r * phi.sin())
}
