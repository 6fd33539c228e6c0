//! Who watches an experiment.

use crate::interruption::Interruption;

/// Watches an experiment: shows how far it has come, passes on what it says, may end it early. `()` does nothing.
pub trait Observer: Sync {
    /// A stage begins, of a number of steps: "frames", 146 of them. It ends when the next one begins.
    fn stage(&self, _what: &str, _of: u64) {}

    /// Steps of the stage that are done.
    fn reached(&self, _done: u64) {}

    /// What is worth knowing while the experiment runs.
    fn note(&self, _text: &str) {}

    /// What is odd, and not among the warnings of the outcome: a figure that could not be drawn.
    fn warn(&self, _text: &str) {}

    /// One of many failed, a picture or a member of a study; its row has the reason, too.
    fn failed(&self, _name: &str, _reason: &str) {}

    /// From now on what is done is kept if the experiment ends early; `doing` says what becomes of it: "the frames that
    /// are done are written".
    fn keeps(&self, _doing: &'static str) {}

    /// What ends the experiment early.
    fn interruption(&self) -> Interruption {
        Interruption::default()
    }

    /// Whether the experiment was to end some time ago, so that no further figures and pages are begun.
    fn is_late(&self) -> bool {
        false
    }
}

impl Observer for () {}
