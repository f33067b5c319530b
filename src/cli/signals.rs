//! Ctrl-C and termination: the first signal asks the work to stop, the second ends the program.

use crate::progress::Cancel;
use std::sync::atomic::{AtomicU8, Ordering};

/// 128 plus the number of the signal that came; SIGINT until one has.
static EXIT_CODE: AtomicU8 = AtomicU8::new(130);

/// Exit code of a command that a signal stopped.
pub(super) fn exit_code() -> u8 {
    EXIT_CODE.load(Ordering::Relaxed)
}

/// Called on each signal: stop in order, or at once if that was already asked for.
fn on_signal(cancel: &Cancel, number: u8) {
    EXIT_CODE.store(128 + number, Ordering::Relaxed);
    if cancel.is_cancelled() {
        std::process::exit(i32::from(exit_code()));
    }
    cancel.cancel();
}

/// Lets SIGINT and SIGTERM set `cancel`. A system that refuses handlers keeps its defaults.
#[cfg(unix)]
pub(super) fn listen(cancel: Cancel) {
    use signal_hook::consts::{SIGINT, SIGTERM};
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
        std::thread::spawn(move || {
            for signal in signals.forever() {
                on_signal(&cancel, signal as u8);
            }
        });
    }
}

/// Lets Ctrl-C set `cancel`.
#[cfg(not(unix))]
pub(super) fn listen(cancel: Cancel) {
    let _ = ctrlc::set_handler(move || on_signal(&cancel, 2));
}
