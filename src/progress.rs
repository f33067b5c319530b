//! The only way long work talks to its caller: progress out, cancellation in.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that long work polls between batches; set by Ctrl-C or by a library user.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Asks the work to stop at its next batch boundary.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`Cancel::cancel`] has been called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Receives the progress of one piece of long work. Calls may come from any thread.
pub trait Progress: Sync {
    /// A stage begins: its name, its length and what is counted (`"photons"`, `"samples"`).
    fn begin(&self, stage: &str, total: u64, unit: &'static str);
    /// `count` more units are done.
    fn advance(&self, count: u64);
    /// The length turns out to be another one: what ends the stage is not a count.
    fn expect(&self, _total: u64) {}
    /// A short remark shown beside the bar, for instance the noise estimate.
    fn note(&self, remark: &str);
    /// The stage is over.
    fn finish(&self);
}

/// Progress that nobody looks at.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: u64, _: &'static str) {}
    fn advance(&self, _: u64) {}
    fn note(&self, _: &str) {}
    fn finish(&self) {}
}
