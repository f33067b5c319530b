//! The terminal: progress bars and Ctrl-C.

use super::stdout::{harmless, tell};
use crate::progress::{Cancel, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::Duration;

/// Progress bars on stderr and a [`Cancel`] that Ctrl-C sets.
pub struct Console {
    quiet: bool,
    cancel: Cancel,
    bar: Mutex<ProgressBar>,
}

impl Console {
    /// * `quiet`: no bars, no remarks.
    pub fn new(quiet: bool) -> Self {
        let cancel = Cancel::default();
        super::signals::listen(cancel.clone());
        Self {
            quiet,
            cancel,
            bar: Mutex::new(ProgressBar::hidden()),
        }
    }

    /// Set when the user asked to stop.
    pub fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// Whether remarks and bars are off.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// A remark on stderr, unless quiet.
    pub fn say(&self, remark: impl std::fmt::Display) {
        if !self.quiet {
            let remark = remark.to_string();
            self.with_bar(|bar| bar.suspend(|| tell(harmless(&remark))));
        }
    }

    fn with_bar<T>(&self, f: impl FnOnce(&mut ProgressBar) -> T) -> T {
        f(&mut self
            .bar
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl Progress for Console {
    fn begin(&self, stage: &str, total: u64, unit: &'static str) {
        if self.quiet {
            return;
        }
        let template = format!(
            "{{prefix:>18}} {{bar:30}} {{percent:>3}}%  {{human_pos}}/{{human_len}} {unit}  \
             {{per_sec}}  {{eta}} left  {{msg}}"
        );
        let style = ProgressStyle::with_template(&template)
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key(
                "per_sec",
                move |s: &indicatif::ProgressState, w: &mut dyn std::fmt::Write| {
                    let _ = write!(w, "{}/s", short_count(s.per_sec()));
                },
            )
            .progress_chars("━╸ ");
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(8));
        bar.set_style(style);
        bar.set_prefix(stage.to_owned());
        bar.enable_steady_tick(Duration::from_millis(250));
        self.with_bar(|slot| *slot = bar);
    }

    fn advance(&self, count: u64) {
        self.with_bar(|bar| bar.inc(count));
    }

    fn expect(&self, total: u64) {
        self.with_bar(|bar| bar.set_length(total));
    }

    fn note(&self, remark: &str) {
        self.with_bar(|bar| bar.set_message(remark.to_owned()));
    }

    fn finish(&self) {
        self.with_bar(|bar| {
            bar.finish_and_clear();
            *bar = ProgressBar::hidden();
        });
    }
}

/// `1234567.0` as `1.23 M`.
pub(super) fn short_count(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("{:.2} G", v / 1e9),
        v if v >= 1e6 => format!("{:.2} M", v / 1e6),
        v if v >= 1e3 => format!("{:.1} k", v / 1e3),
        v => format!("{v:.1}"),
    }
}
