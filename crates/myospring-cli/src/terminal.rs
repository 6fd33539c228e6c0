//! The observer that shows an experiment on the terminal.

use crate::{interrupt, print, progress};
use indicatif::ProgressBar;
use myospring::experiment::Observer;
use myospring::interruption::Interruption;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Shows progress on a terminal, prints notes and warnings, and handles Ctrl-C.
pub(crate) struct Terminal {
    quiet: bool,
    bar: Mutex<ProgressBar>,
}

impl Terminal {
    /// A quiet one shows no progress and no notes, only warnings.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, bar: Mutex::new(ProgressBar::hidden()) }
    }

    /// Removes the progress bar before the results are printed.
    pub(crate) fn clear(&self) {
        self.bar().finish_and_clear();
    }

    fn bar(&self) -> MutexGuard<'_, ProgressBar> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for Terminal {
    fn stage(&self, what: &str, of: u64) {
        self.clear();
        *self.bar() = progress::of_members(self.quiet, of as usize, what);
    }

    fn reached(&self, done: u64) {
        self.bar().set_position(done);
    }

    fn note(&self, text: &str) {
        if !self.quiet {
            self.bar().suspend(|| print::note(text));
        }
    }

    fn failed(&self, name: &str, reason: &str) {
        if !self.quiet {
            self.warn(&format!("{name}: {reason}"));
        }
    }

    fn warn(&self, text: &str) {
        self.bar().suspend(|| print::warn(text));
    }

    fn keeps(&self, doing: &'static str) {
        interrupt::heed(doing);
    }

    fn interruption(&self) -> Interruption {
        interrupt::interruption()
    }

    fn is_late(&self) -> bool {
        interrupt::is_late()
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.clear();
    }
}
