//! The members of a study computed here or elsewhere: the settings they depend on, which members
//! are not done, and their rows.

use super::super::{Journal, Member as _, StudyError, sha256};
use super::description::ParameterStudy;
use super::member::{Variation, VariationRow};
use super::shard::Shard;
use super::work::Common;
use std::iter::successors;

/// Number of members that are created at a time.
const AT_ONCE: usize = 4096;

impl ParameterStudy {
    /// What the rows depend on in addition to the members' values, as text for
    /// [`Journal::open`](super::super::Journal::open); `common` is made of this study.
    pub fn settings(&self, common: &Common) -> String {
        let names: Vec<&str> =
            self.varied.iter().map(|varied| varied.number.key.as_str()).collect();
        let file =
            |(name, bytes): (&String, &Vec<u8>)| format!("# file {name:?} {}\n", sha256(bytes));
        let files: String = common.files().iter().map(file).collect();
        format!(
            "# The settings of the members in this folder; a study continues only with the same ones.\n\
             # version {}, kind {:?}, beat {:?}, traces {}\n# metrics {}\n# varied {}\n{files}\n{}",
            env!("CARGO_PKG_VERSION"),
            self.kind,
            self.beat,
            self.traces,
            self.metrics.join(", "),
            names.join(", "),
            self.run.to_toml(),
        )
    }

    /// Numbers of the members of a part that a journal does not have.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub fn left(
        &self,
        part: Shard,
        journal: &Journal<Variation>,
    ) -> Result<Vec<usize>, StudyError> {
        let mut left = Vec::new();
        for members in self.in_turn(part, AT_ONCE) {
            left.extend(journal.left(&members)?.members.iter().map(|member| member.number));
        }
        Ok(left)
    }

    /// Adds rows to a journal; they are on the disk when this returns. Rows of members of other
    /// studies are left out.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn note(
        &self,
        journal: &Journal<Variation>,
        rows: Vec<VariationRow>,
    ) -> Result<(), StudyError> {
        let member = |row: VariationRow| Some((self.member(row.member)?, row));
        let done: Vec<(Variation, VariationRow)> = rows.into_iter().filter_map(member).collect();
        journal.add(done.iter().map(|(member, row)| (member, member.key(), vec![row.clone()])))
    }

    /// Adds the rows of a part that a journal has, in the order of the members.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub fn add_noted(
        &self,
        part: Shard,
        journal: &Journal<Variation>,
        rows: &mut impl Extend<VariationRow>,
    ) -> Result<(), StudyError> {
        for members in self.in_turn(part, AT_ONCE) {
            rows.extend(journal.rows(&members)?);
        }
        Ok(())
    }

    /// The members of a part in order, a group at a time, so that only one group is in memory.
    pub fn in_turn(
        &self,
        Shard { part, of }: Shard,
        at_once: usize,
    ) -> impl Iterator<Item = Vec<Variation>> {
        let starts = successors(Some(part - 1), move |start| Some(start + at_once * of));
        let starts = starts.take_while(|start| *start < self.values.members());
        starts.map(move |start| {
            let some = (start..self.values.members()).step_by(of).take(at_once);
            some.filter_map(|at| self.member(at + 1)).collect()
        })
    }
}
