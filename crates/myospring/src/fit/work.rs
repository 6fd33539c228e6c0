//! Progress of a fit, and whether to continue.

use crate::clock::Stopwatch;
use crate::interruption::Interruption;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Interval between calls that report progress.
const ASKED_EVERY: Duration = Duration::from_millis(100);

/// The work done.
pub(super) struct Work<'a> {
    evaluations: AtomicUsize,
    stopped: AtomicBool,
    /// The part of all work that is done, and when it was last reported.
    heard: Mutex<(f64, Stopwatch)>,
    goes_on: &'a (dyn Fn(f64) -> bool + Sync),
    interruption: &'a Interruption,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        goes_on: &'a (dyn Fn(f64) -> bool + Sync),
        interruption: &'a Interruption,
    ) -> Self {
        let (evaluations, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
        let heard = Mutex::new((0.0, Stopwatch::start()));
        Self { evaluations, stopped, heard, goes_on, interruption }
    }

    /// Reports the part of all work that is done; returns whether to continue.
    pub(super) fn done(&self, part: f64) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        *heard = (heard.0.max(part), Stopwatch::start());
        let part = heard.0;
        drop(heard);
        if !(self.goes_on)(part) {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.is_wanted()
    }

    /// Counts one more curve; returns whether to continue.
    pub(super) fn counts(&self) -> bool {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        let heard = *self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if heard.1.elapsed() > ASKED_EVERY { self.done(heard.0) } else { self.is_wanted() }
    }

    pub(super) fn is_wanted(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed) && !self.interruption.is_requested()
    }

    pub(super) fn evaluations(&self) -> usize {
        self.evaluations.load(Ordering::Relaxed)
    }
}
