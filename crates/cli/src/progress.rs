//! How far the work is, on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Work that takes less needs no bar.
const PATIENCE: Duration = Duration::from_millis(400);

/// What the bar counts to.
const STEPS: f64 = 1000.0;

/// A bar on standard error with the time left, if that is a terminal. It is gone when this is dropped.
pub(crate) struct Progress {
    bar: ProgressBar,
    start: Instant,
    is_wanted: bool,
    is_shown: AtomicBool,
}

impl Progress {
    /// A bar for work that starts now, if it `is_wanted`.
    pub(crate) fn new(is_wanted: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %, {eta} left") {
            bar.set_style(style);
        }
        let is_wanted = is_wanted && std::io::stderr().is_terminal();
        Self { bar, start: Instant::now(), is_wanted, is_shown: AtomicBool::new(false) }
    }

    /// Shows that a share from 0 to 1 of the work is done; may be called from any thread.
    pub(crate) fn report(&self, share: f64) {
        if !self.is_wanted {
            return;
        }
        self.bar.set_position((share * STEPS) as u64);
        if self.start.elapsed() > PATIENCE && !self.is_shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
