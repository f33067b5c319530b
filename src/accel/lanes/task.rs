//! Choosing by what the processor has, once for much work.

#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, has_avx2, has_avx512};
use super::{Lanes, Plain};

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
        // SAFETY: the processor has what the functions enable.
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
