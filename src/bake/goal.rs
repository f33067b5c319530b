//! When a bake is done.

use std::time::Instant;

/// What a bake runs for beside its number of photons: whichever is met first ends it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Goal {
    /// Relative L2 error of S ([`super::Bake::error`]), for instance 0.01.
    ///
    /// The error is looked at after counts of photons that depend on nothing but the sums, so a bake that begins with
    /// nothing meets the same goal with the same photons on any machine. One that goes on from saved sums first looks there.
    pub error: Option<f64>,
    /// A moment to have a table by: time for [`super::Bake::snapshot`] is kept free. What is done by then
    /// does depend on the machine.
    pub until: Option<Instant>,
}

/// What ended a bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All photons were flown.
    Photons,
    /// The error is as small as was asked for.
    Error,
    /// Its time is over.
    Time,
    /// Cancelled. What was done before counts.
    Cancelled,
}

/// Photons after which the error is looked at for the first time, a node.
const FIRST_CHECK: u64 = 1024;

/// Where the error is looked at first.
pub(super) fn first_check(nodes: usize) -> u64 {
    FIRST_CHECK * nodes as u64
}

/// Where to look again after the error was `error` at `photons`: where noise that falls with the
/// root of the count meets the goal, a little late rather than early, but at most at the double,
/// since an estimate from few photons is poor.
pub(super) fn next_check(photons: u64, error: f64, goal: f64) -> u64 {
    let ratio = (error / goal).powi(2) * 1.02;
    // Infinite or huge ratios end at the double.
    let next = (photons as f64 * ratio.clamp(1.02, 2.0)).ceil();
    (next as u64).max(photons + 1)
}
