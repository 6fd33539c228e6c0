//! Parameter studies: many runs with different parameter values, such as sensitivity analyses and
//! populations.
//!
//! A [`ParameterStudy`] is read from a short TOML description: what all members have in common (a
//! run file), which numbers vary and how ([`sampling`](super::sampling)), and which metrics are
//! computed. [`run`] computes its members, or a [`Shard`] of them. An [`Answer`] contains their
//! joint results: a table, the accepted members, and which parameters matter
//! ([`sensitivity`](super::sensitivity)).
//!
//! Members that differ only in the cell model share the equilibria of their mesh; members without a
//! mesh are integrated together. The result of a member depends only on its values, not on threads,
//! shards or interruptions.
//!
//! # Example
//! ```
//! use myospring::study::parameters::{Answer, Common, ParameterStudy, Shard, run};
//! use myospring::study::{Journal, Threads};
//!
//! let no_file = |_file: &str| Err(std::io::ErrorKind::NotFound.into());
//! let study = ParameterStudy::from_toml(
//!     r#"
//!     kind = "cell"
//!     [parameters]
//!     tau_si = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
//!     tau_so1 = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
//!     [sampling]
//!     sampler = "saltelli"
//!     size = 64
//!     "#,
//!     no_file,
//! )?;
//! let common = Common::new(&study, no_file)?;
//! let rows = run(&study, &common, Shard::WHOLE, &Journal::in_memory(), &Threads::new(None)?, &())?.rows;
//! let answer = Answer::new(&study, &common.units, rows);
//! let tension = &answer.sensitivity()?[0];
//! assert_eq!(tension.metric, "peak_tension");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod alone;
mod answer;
mod cell_metrics;
mod course;
mod description;
mod elsewhere;
mod error;
mod figures;
mod member;
mod rows;
mod schema;
mod shard;
mod traces;
mod values;
mod work;

pub use answer::{Acceptance, Answer, Ranked, Rejected, Sensitivity};
pub use description::{AcceptanceBand, CountedBeat, Design, MemberKind, ParameterStudy, Varied};
pub use error::ParameterStudyError;
pub use figures::Drawn;
pub use member::{Variation, VariationRow};
pub use rows::{MemberRow, Rows};
pub use schema::schema;
pub use shard::Shard;
pub use traces::{TRACES, TraceAxes, merge_traces, with_whole_curves};
pub use values::Values;
pub use work::Common;

use super::runner::{Members, Part, run_in_parts};
use super::{Journal, StudyError, StudyObserver, StudyReport, Threads};
use crate::cell::batch::TOGETHER;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Number of cells that are integrated together and recorded as one group.
const CELLS_TOGETHER: usize = 64 * TOGETHER;
/// Number of cells that are sampled and recorded as one group: a second of work for a dozen beats
/// each.
const SAMPLED_CELLS_TOGETHER: usize = 64;
/// Number of beats that are recorded as one group: half a second of work.
const BEATS_TOGETHER: usize = 8;
/// Smallest number of groups per thread, so that all threads end at about the same time.
const GROUPS: usize = 4;

/// Computes every member of a shard of a study that the journal does not contain; `common` must
/// come from the same study. The rows come in the collection that the caller names: [`Rows`] for
/// millions of members, or a `Vec`.
///
/// # Errors
/// Those of [`study::run`](super::run); the error of a member is a row.
pub fn run<C: Default + Extend<VariationRow>>(
    study: &ParameterStudy,
    common: &Common,
    part: Shard,
    journal: &Journal<Variation>,
    threads: &Threads,
    observer: &impl StudyObserver<Variation>,
) -> Result<StudyReport<C>, StudyError> {
    run_all(common, &InShard { study, part }, journal, threads, observer)
}

/// Does what [`run`] does, for any members.
///
/// # Errors
/// Those of [`run`].
pub fn run_members(
    common: &Common,
    members: &[Variation],
    journal: &Journal<Variation>,
    threads: &Threads,
    observer: &impl StudyObserver<Variation>,
) -> Result<StudyReport<Vec<VariationRow>>, StudyError> {
    run_all(common, members, journal, threads, observer)
}

/// The members of a part of a study.
struct InShard<'a> {
    study: &'a ParameterStudy,
    part: Shard,
}

impl Members<Variation> for InShard<'_> {
    fn count(&self) -> usize {
        self.part.size(self.study.values.members())
    }

    fn part(&self, places: Range<usize>) -> Part<'_, Variation> {
        let number = |place: usize| self.part.part + place * self.part.of;
        Part::Made(places.filter_map(|place| self.study.member(number(place))).collect())
    }
}

fn run_all<C: Default + Extend<VariationRow>>(
    common: &Common,
    members: &(impl Members<Variation> + Sync + ?Sized),
    journal: &Journal<Variation>,
    threads: &Threads,
    observer: &impl StudyObserver<Variation>,
) -> Result<StudyReport<C>, StudyError> {
    let count = members.count();
    if common.axes.is_some() {
        common.check_curves(&members.part(0..count), journal)?;
    }
    let shares = |groups: usize| count.div_ceil(groups * threads.count());
    let together = match common.kind() {
        MemberKind::Cell if common.tells_beats => shares(1).clamp(1, CELLS_TOGETHER),
        MemberKind::Cell => shares(1).clamp(1, SAMPLED_CELLS_TOGETHER),
        MemberKind::Beat => shares(GROUPS).clamp(1, BEATS_TOGETHER),
    };
    let together = NonZeroUsize::new(together).unwrap_or(NonZeroUsize::MIN);
    let interruption = observer.interruption();
    let work = |group: &[&Variation]| {
        let rows = common.rows(group, &interruption);
        rows.into_iter().map(|row| row.map(|row| vec![row])).collect()
    };
    let report = run_in_parts(members, journal, threads, observer, together, (work, || Ok(())))?;
    match common.failure() {
        None => Ok(report),
        Some(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests;
