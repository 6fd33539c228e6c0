//! Loop over the members of a study.

use super::{
    Cause, Interrupted, Journal, Member, Row, Status, StudyError, StudyObserver, TABLE_EVERY,
    Threads,
};
use crate::clock::Stopwatch;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::ops::{Deref, Range};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyReport<C> {
    /// Number of members that were finished before.
    pub resumed: usize,
    /// Whether the observer stopped the study before its end.
    pub stopped: bool,
    /// Rows of all finished members, in the order of the members.
    pub rows: C,
}

impl<R: Row> StudyReport<Vec<R>> {
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
) -> Result<StudyReport<Vec<M::Row>>, StudyError> {
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
) -> Result<StudyReport<Vec<M::Row>>, StudyError> {
    if let Some(name) = twice(members) {
        return Err(StudyError::SameName { name: name.to_owned() });
    }
    let last_table = Mutex::new(Stopwatch::start());
    let table = || {
        let mut last = last_table.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() > TABLE_EVERY {
            *last = Stopwatch::start();
            observer.table(&journal.rows(members)?).map_err(StudyError::Observer)?;
        }
        Ok(())
    };
    let report: StudyReport<Vec<M::Row>> =
        run_in_parts(members, journal, threads, observer, together, (work, table))?;
    observer.table(&report.rows).map_err(StudyError::Observer)?;
    Ok(report)
}

/// The members of a study, of which no two have one name. Those of a large study are made in parts, so that they take little memory.
pub(super) trait Members<M> {
    fn count(&self) -> usize;

    /// Those at some places in the order of the study.
    fn part(&self, places: Range<usize>) -> Part<'_, M>;
}

/// Some members.
pub(super) enum Part<'a, M> {
    Given(&'a [M]),
    Made(Vec<M>),
}

impl<M> Deref for Part<'_, M> {
    type Target = [M];

    fn deref(&self) -> &[M] {
        match self {
            Self::Given(members) => members,
            Self::Made(members) => members,
        }
    }
}

impl<M> Members<M> for [M] {
    fn count(&self) -> usize {
        self.len()
    }

    fn part(&self, places: Range<usize>) -> Part<'_, M> {
        Part::Given(&self[places])
    }
}

/// Number of members that are made at a time, and smallest number of groups for each thread among them: threads wait for each other at
/// the end of a part.
const PART: usize = 1 << 16;
const GROUPS_A_PART: usize = 16;

/// Computes the members that the journal does not have, and returns the rows of all in any
/// collection. Members are made in parts; `recorded` is called after each group.
pub(super) fn run_in_parts<M: Member, C: Default + Extend<M::Row>>(
    members: &(impl Members<M> + Sync + ?Sized),
    journal: &Journal<M>,
    threads: &Threads,
    observer: &impl StudyObserver<M>,
    together: NonZeroUsize,
    (work, recorded): (
        impl Fn(&[&M]) -> Vec<Result<Vec<M::Row>, Cause>> + Sync,
        impl Fn() -> Result<(), StudyError> + Sync,
    ),
) -> Result<StudyReport<C>, StudyError> {
    let count = members.count();
    let size = PART.max(GROUPS_A_PART * threads.count() * together.get());
    let parts =
        || (0..count).step_by(size).map(|start| members.part(start..count.min(start + size)));
    let (mut resumed, mut changed) = (count, 0);
    for part in parts() {
        let left = journal.left(&part)?;
        resumed -= left.members.len();
        changed += left.changed;
    }
    if journal.damaged() > 0 {
        observer.damaged(journal.damaged());
    }
    if changed > 0 {
        observer.changed(changed);
    }
    observer.begins(resumed, count);
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
        recorded()?;
        if goes_on { Ok(()) } else { Err(End::Stopped) }
    };
    let end = parts().try_for_each(|part| {
        let left = journal.left(&part)?.members;
        threads.install(|| left.par_chunks(together.get()).try_for_each(group))
    });
    let stopped = match end {
        Ok(()) => false,
        Err(End::Stopped) => true,
        Err(End::Failed(error)) => return Err(error),
    };
    let mut rows = C::default();
    for part in parts() {
        rows.extend(journal.rows(&part)?);
    }
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

#[cfg(test)]
mod tests {
    use super::super::Interrupted;
    use super::*;
    use crate::output::table::Table;
    use serde::{Deserialize, Serialize};
    use std::sync::atomic::{AtomicUsize, Ordering};

    struct Number {
        name: String,
        number: usize,
    }

    impl Member for Number {
        const KIND: &'static str = "number";
        type Row = Square;

        fn name(&self) -> &str {
            &self.name
        }

        fn key(&self) -> Option<String> {
            Some(String::new())
        }
    }

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Square(usize);

    impl Row for Square {
        fn failed(_: &str, _: String) -> Self {
            Self(0)
        }

        fn status(&self) -> Status {
            Status::Ok
        }

        fn table(_: &[Self]) -> Table {
            Table { columns: Vec::new() }
        }
    }

    /// The first numbers, and how many were made at a time at most.
    struct Numbers {
        count: usize,
        most: AtomicUsize,
    }

    impl Members<Number> for Numbers {
        fn count(&self) -> usize {
            self.count
        }

        fn part(&self, places: Range<usize>) -> Part<'_, Number> {
            self.most.fetch_max(places.len(), Ordering::Relaxed);
            Part::Made(places.map(|number| Number { name: number.to_string(), number }).collect())
        }
    }

    #[test]
    fn a_study_that_is_made_in_parts_has_every_row_in_order_and_goes_on_after_an_interruption() {
        struct Begins(Mutex<Vec<[usize; 2]>>);
        impl StudyObserver<Number> for Begins {
            fn begins(&self, done: usize, members: usize) {
                self.0.lock().unwrap().push([done, members]);
            }
        }
        let numbers = Numbers { count: PART + 1000, most: AtomicUsize::new(0) };
        let (journal, threads) = (Journal::in_memory(), Threads::new(Some(2)).unwrap());
        let together = NonZeroUsize::new(500).unwrap();
        let begins = Begins(Mutex::default());
        // The first time it ends in the second part.
        let run = |ends: usize| {
            let square = |member: &&Number| {
                let number = member.number;
                if number >= ends {
                    Err(Interrupted.into())
                } else {
                    Ok(vec![Square(number * number)])
                }
            };
            let work = |group: &[&Number]| group.iter().map(square).collect();
            let work = (work, || Ok(()));
            let report = run_in_parts(&numbers, &journal, &threads, &begins, together, work);
            report.unwrap() as StudyReport<Vec<Square>>
        };
        assert!(run(PART + 300).stopped);
        let report = run(usize::MAX);
        assert!(!report.stopped && report.rows.len() == PART + 1000);
        assert!(report.rows.iter().enumerate().all(|(at, row)| row.0 == at * at));
        assert_eq!(*begins.0.lock().unwrap(), [[0, PART + 1000], [report.resumed, PART + 1000]]);
        assert!((PART..=PART + 300).contains(&report.resumed), "{}", report.resumed);
        assert_eq!(numbers.most.into_inner(), PART);
    }
}
