//! Reports the progress of a study to the observer of an experiment.

use super::observer::Observer;
use crate::interruption::Interruption;
use crate::study::{Cause, Member, Row as _, Status, StudyObserver};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes the table of some rows.
pub(super) type WriteTable<'a, M> = &'a (dyn Fn(&[<M as Member>::Row]) -> Result<(), Cause> + Sync);

/// Passes on what a study tells.
pub(super) struct Watched<'a, M: Member> {
    pub(super) observer: &'a dyn Observer,
    pub(super) interruption: Interruption,
    /// What a member is called, and why its row failed.
    pub(super) words: fn(&M, &M::Row) -> (String, String),
    /// Writes the rows so far, now and then.
    pub(super) table: Option<WriteTable<'a, M>>,
    pub(super) done: AtomicU64,
}

impl<M: Member> StudyObserver<M> for Watched<'_, M> {
    fn begins(&self, done: usize, members: usize) {
        self.observer.stage(&format!("{}s", M::KIND), members as u64);
        if done > 0 {
            self.observer.note(&format!("continuing: {done} of {members} {}s are done", M::KIND));
        }
        self.done.store(done as u64, Ordering::Relaxed);
        self.observer.reached(done as u64);
    }

    fn damaged(&self, members: usize) {
        self.observer.warn(&format!(
            "the stored results of {members} {}s were changed or damaged; they are computed again",
            M::KIND
        ));
    }

    fn changed(&self, members: usize) {
        self.observer.warn(&format!(
            "{members} stored {}s had other input (another picture, other parameters or another sampling); they are \
             computed again",
            M::KIND
        ));
    }

    fn finished(&self, member: &M, rows: &[M::Row]) -> bool {
        for row in rows.iter().filter(|row| row.status() == Status::Failed) {
            let (name, reason) = (self.words)(member, row);
            self.observer.failed(&name, &reason);
        }
        self.observer.reached(1 + self.done.fetch_add(1, Ordering::Relaxed));
        !self.interruption.is_requested()
    }

    fn interruption(&self) -> Interruption {
        self.interruption.clone()
    }

    fn table(&self, rows: &[M::Row]) -> Result<(), Cause> {
        self.table.map_or(Ok(()), |write| write(rows))
    }
}
