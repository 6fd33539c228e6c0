//! Whoever watches a study.

use super::{Cause, Member};
use crate::interruption::Interruption;
use std::time::Duration;

/// How often [`Observer::table`] is called while members are under way.
pub const TABLE_EVERY: Duration = Duration::from_secs(5);

/// What to say of members whose kept results are damaged.
pub fn damaged(count: usize, members: &str) -> String {
    format!(
        "the results of {count} {members} that were kept here were changed or damaged since; they are computed anew"
    )
}

/// Watches a study; `()` does not.
pub trait Observer<M: Member>: Sync {
    /// The study begins; so many of its members were done before.
    fn begins(&self, _done: usize, _members: usize) {}

    /// How many members have damaged results, which are computed anew.
    fn damaged(&self, _members: usize) {}

    /// A member was done and stands in the journal; `false` begins no other.
    fn finished(&self, _member: &M, _rows: &[M::Row]) -> bool {
        true
    }

    /// What may end the work on members under way; they are left undone, with [`Interrupted`](super::Interrupted).
    fn interruption(&self) -> Interruption {
        Interruption::default()
    }

    /// Whether [`Observer::table`] is called while members are under way; of very many that takes long.
    fn wants_tables(&self) -> bool {
        true
    }

    /// The rows so far, in the order of the members: every [`TABLE_EVERY`], and at the end.
    ///
    /// # Errors
    /// Whatever stands in the way of going on; the study ends with it.
    fn table(&self, _rows: &[M::Row]) -> Result<(), Cause> {
        Ok(())
    }
}

impl<M: Member> Observer<M> for () {}
