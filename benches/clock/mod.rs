//! Time that was used rather than passed: what others do on the machine counts little.
#![allow(dead_code, reason = "each bench uses one of the two")]

use std::sync::LazyLock;
use std::time::Instant;

/// Seconds that this thread ran, where the system tells, else those of the clock.
pub(crate) fn thread_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ran = text.split_whitespace().next();
    match ran.and_then(|n| n.parse::<f64>().ok()) {
        Some(nanoseconds) => nanoseconds * 1e-9,
        None => wall_seconds(),
    }
}

/// User and system seconds of this process, where the system tells, else those of the clock.
pub(crate) fn processor_seconds() -> f64 {
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name, in parentheses, may hold anything.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let mut ticks = fields.split_whitespace().skip(11).map(str::parse::<f64>);
    match (ticks.next(), ticks.next()) {
        (Some(Ok(user)), Some(Ok(system))) => (user + system) / TICKS,
        _ => wall_seconds(),
    }
}

fn wall_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}
