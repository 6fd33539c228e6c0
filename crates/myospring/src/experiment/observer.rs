//! Observers of experiments.

use crate::interruption::Interruption;

/// Observes an experiment: shows its progress, passes on its notes and warnings, may end it early.
/// `()` does nothing.
pub trait Observer: Sync {
    /// A stage begins, of a number of steps: "frames", 146 of them. It ends when the next one begins.
    fn stage(&self, _what: &str, _of: u64) {}

    /// Steps of the stage that are done.
    fn reached(&self, _done: u64) {}

    /// A note while the experiment runs.
    fn note(&self, _text: &str) {}

    /// A warning that is not among those of the outcome: a figure that could not be drawn.
    fn warn(&self, _text: &str) {}

    /// One of many failed, a picture or a member of a study; its row has the reason, too.
    fn failed(&self, _name: &str, _reason: &str) {}

    /// From now on finished work is kept if the experiment ends early; `doing` says what happens to
    /// it: "the frames that are done are written".
    fn keeps(&self, _doing: &'static str) {}

    /// What ends the experiment early.
    fn interruption(&self) -> Interruption {
        Interruption::default()
    }

    /// Whether the experiment was asked to end some time ago, so that no further figures and pages
    /// are started.
    fn is_late(&self) -> bool {
        false
    }
}

impl Observer for () {}
