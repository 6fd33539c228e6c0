//! Observers of a study.

use super::{Cause, Member};
use crate::interruption::Interruption;
use std::time::Duration;

/// How often [`StudyObserver::table`] is called while members are under way.
pub const TABLE_EVERY: Duration = Duration::from_secs(5);

/// Is told about the progress of a study; `()` ignores it.
pub trait StudyObserver<M: Member>: Sync {
    /// Called when the study begins: the number of members finished before, and of all members.
    fn begins(&self, _done: usize, _members: usize) {}

    /// Called with the number of members whose results are damaged and computed again.
    fn damaged(&self, _members: usize) {}

    /// Called with the number of members whose input changed and that are computed again.
    fn changed(&self, _members: usize) {}

    /// Called after a member was finished and recorded in the journal; `false` stops the study.
    fn finished(&self, _member: &M, _rows: &[M::Row]) -> bool {
        true
    }

    /// Returns the interruption that may end the work on members in progress; they end with
    /// [`Interrupted`](super::Interrupted) and stay unfinished.
    fn interruption(&self) -> Interruption {
        Interruption::default()
    }

    /// Called with the rows so far, in the order of the members: every [`TABLE_EVERY`], and at the
    /// end. A study of [parameters](super::parameters), which may have millions of members, never
    /// calls it.
    ///
    /// # Errors
    /// Any error; it ends the study.
    fn table(&self, _rows: &[M::Row]) -> Result<(), Cause> {
        Ok(())
    }
}

impl<M: Member> StudyObserver<M> for () {}
