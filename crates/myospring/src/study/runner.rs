//! Loop over the members of a study.

use super::{
    Cause, Interrupted, Journal, Member, Row, Status, StudyError, StudyObserver, TABLE_EVERY,
    Threads,
};
use crate::clock::Stopwatch;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyReport<R> {
    /// Number of members that were finished before.
    pub resumed: usize,
    /// Whether the observer stopped the study before its end.
    pub stopped: bool,
    /// Rows of all finished members, in the order of the members.
    pub rows: Vec<R>,
}

impl<R: Row> StudyReport<R> {
    /// Returns the number of rows with this status.
    pub fn count(&self, status: Status) -> usize {
        self.rows.iter().filter(|row| row.status() == status).count()
    }
}

/// Computes every member that the journal does not contain; `work` returns the rows of one member,
/// at least one row.
///
/// An error of `work` becomes the member's row, except [`Interrupted`], which gives no row and ends
/// the study. If `work` panics, the row asks the user to report it.
///
/// # Errors
/// Two members with the same name, a journal that cannot be written, or an error of the observer.
pub fn run<M: Member>(
    members: &[M],
    journal: &Journal<M>,
    threads: &Threads,
    observer: &impl StudyObserver<M>,
    work: impl Fn(&M) -> Result<Vec<M::Row>, Cause> + Sync,
) -> Result<StudyReport<M::Row>, StudyError> {
    let work = |group: &[&M]| group.iter().map(|member| work(member)).collect();
    run_together(members, journal, threads, observer, NonZeroUsize::MIN, work)
}

/// Does what [`run`] does, with up to `together` members at a time on a thread: `work` returns the
/// rows of each member, in order.
///
/// # Errors
/// Those of [`run`].
pub fn run_together<M: Member>(
    members: &[M],
    journal: &Journal<M>,
    threads: &Threads,
    observer: &impl StudyObserver<M>,
    together: NonZeroUsize,
    work: impl Fn(&[&M]) -> Vec<Result<Vec<M::Row>, Cause>> + Sync,
) -> Result<StudyReport<M::Row>, StudyError> {
    if let Some(name) = twice(members) {
        return Err(StudyError::SameName { name: name.to_owned() });
    }
    let left = journal.left(members);
    let resumed = members.len() - left.len();
    if journal.damaged() > 0 {
        observer.damaged(journal.damaged());
    }
    let changed = journal.changed(members);
    if changed > 0 {
        observer.changed(changed);
    }
    observer.begins(resumed, members.len());
    let last_table = Mutex::new(Stopwatch::start());
    let group = |group: &[&M]| {
        let keys: Vec<Option<String>> = group.iter().map(|member| member.key()).collect();
        let answers = guarded(group, &work);
        let mut goes_on = answers.iter().all(Option::is_some);
        let done: Vec<_> = group
            .iter()
            .zip(keys)
            .zip(answers)
            .filter_map(|((member, key), rows)| Some((*member, key, rows?)))
            .collect();
        journal.add(done.iter().cloned())?;
        for (member, _, rows) in &done {
            goes_on &= observer.finished(member, rows);
        }
        let mut last = last_table.lock().unwrap_or_else(PoisonError::into_inner);
        if observer.wants_tables() && last.elapsed() > TABLE_EVERY {
            *last = Stopwatch::start();
            observer.table(&journal.rows(members)?).map_err(StudyError::Observer)?;
        }
        if goes_on { Ok(()) } else { Err(End::Stopped) }
    };
    let end = threads.install(|| left.par_chunks(together.get()).try_for_each(group));
    let stopped = match end {
        Ok(()) => false,
        Err(End::Stopped) => true,
        Err(End::Failed(error)) => return Err(error),
    };
    let rows = journal.rows(members)?;
    observer.table(&rows).map_err(StudyError::Observer)?;
    Ok(StudyReport { resumed, stopped, rows })
}

/// Returns a name that two members have.
fn twice<M: Member>(members: &[M]) -> Option<&str> {
    let mut names = BTreeSet::new();
    members.iter().map(Member::name).find(|name| !names.insert(*name))
}

/// Why a study ends before its last member.
enum End {
    Stopped,
    Failed(StudyError),
}

impl From<StudyError> for End {
    fn from(error: StudyError) -> Self {
        Self::Failed(error)
    }
}

/// Returns the rows of each member of a group, at least one row each, or `None` for an interrupted
/// member. Any error is a row.
fn guarded<M: Member>(
    group: &[&M],
    work: &(impl Fn(&[&M]) -> Vec<Result<Vec<M::Row>, Cause>> + Sync),
) -> Vec<Option<Vec<M::Row>>> {
    // A panic in one member must not lose the results of the others.
    let answers = catch_unwind(AssertUnwindSafe(|| work(group)));
    if answers.is_err() && group.len() > 1 {
        return group.iter().flat_map(|member| guarded(&[*member], work)).collect();
    }
    let mut answers = answers.unwrap_or_default().into_iter();
    let rows = |member: &&M| match answers.next() {
        Some(Ok(rows)) if !rows.is_empty() => Some(rows),
        Some(Err(cause)) if cause.is::<Interrupted>() => None,
        Some(Err(cause)) => Some(vec![M::Row::failed(member.name(), cause.to_string())]),
        _ => {
            let reason = "this is an error of the program; please report it together with this";
            Some(vec![M::Row::failed(member.name(), format!("{reason} {}", M::KIND))])
        }
    };
    group.iter().map(rows).collect()
}
