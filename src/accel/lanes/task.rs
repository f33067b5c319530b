//! Choosing by what the processor has, once for much work.

use super::{Lanes, Plain};
#[cfg(target_arch = "x86_64")]
use super::{avx2::Avx2, avx512::Avx512};

/// What is to be done with the lanes that the processor has.
pub(crate) trait Task {
    type Output;

    /// To be inlined always, with all that it does with lanes: only then is it compiled for them.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Does it with the widest lanes that the processor has.
#[inline(always)]
pub(crate) fn on_this_processor<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        #[allow(unsafe_code, reason = "measured faster; the processor was asked")]
        // SAFETY: the processor has what the functions enable. Nothing else has a name for their lanes.
        return unsafe {
            match has_avx512() {
                true => with_avx512(task),
                false => with_avx2(task),
            }
        };
    }
    task.run::<Plain>()
}

/// Does it with AVX2, if the processor has that.
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) fn on_avx2<T: Task>(task: T) -> Option<T::Output> {
    #[allow(unsafe_code, reason = "the processor was asked")]
    // SAFETY: the processor has what the function enables.
    has_avx2().then(|| unsafe { with_avx2(task) })
}

/// Does it with AVX-512, if the processor has that.
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) fn on_avx512<T: Task>(task: T) -> Option<T::Output> {
    let has_it = has_avx2() && has_avx512();
    #[allow(unsafe_code, reason = "the processor was asked")]
    // SAFETY: the processor has what the function enables.
    has_it.then(|| unsafe { with_avx512(task) })
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,popcnt,lzcnt")]
fn with_avx2<T: Task>(task: T) -> T::Output {
    task.run::<Avx2>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,popcnt,lzcnt")]
fn with_avx512<T: Task>(task: T) -> T::Output {
    task.run::<Avx512>()
}

/// Whether the processor has what [`Avx2`] needs, and BMI1, POPCNT and LZCNT.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("lzcnt")
}

/// Whether it has what [`Avx512`] needs besides.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}
