//! Members that are worked on elsewhere, by any engine: which are left, and their rows as these come back.

use super::super::{Journal, Member as _, StudyError};
use super::description::ParameterStudy;
use super::member::{Variation, VariationRow};
use super::shard::Shard;
use std::iter::successors;

/// So many members are made at a time.
const AT_ONCE: usize = 4096;

impl ParameterStudy {
    /// Numbers of the members of a part that a journal does not have.
    pub fn left(&self, part: Shard, journal: &Journal<Variation>) -> Vec<usize> {
        let mut left = Vec::new();
        for members in self.in_turn(part) {
            left.extend(journal.left(&members).into_iter().map(|member| member.number));
        }
        left
    }

    /// Adds rows to a journal; they are on the disk when this returns. Rows of no member of this study are left out.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn note(
        &self,
        journal: &Journal<Variation>,
        rows: Vec<VariationRow>,
    ) -> Result<(), StudyError> {
        let member = |row: VariationRow| {
            let values = self.values.get(row.member.checked_sub(1)?)?;
            Some((Variation::new(row.member, values.clone()), row))
        };
        let done: Vec<(Variation, VariationRow)> = rows.into_iter().filter_map(member).collect();
        journal.add(done.iter().map(|(member, row)| (member, member.key(), vec![row.clone()])))
    }

    /// The rows of a part that a journal has, in the order of the members.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub fn noted(
        &self,
        part: Shard,
        journal: &Journal<Variation>,
    ) -> Result<Vec<VariationRow>, StudyError> {
        let mut rows = Vec::new();
        for members in self.in_turn(part) {
            rows.extend(journal.rows(&members)?);
        }
        Ok(rows)
    }

    /// The members of a part, some at a time.
    fn in_turn(&self, Shard { part, of }: Shard) -> impl Iterator<Item = Vec<Variation>> {
        let starts = successors(Some(part - 1), move |start| Some(start + AT_ONCE * of));
        let starts = starts.take_while(|start| *start < self.values.len());
        starts.map(move |start| {
            let some = (start..self.values.len()).step_by(of).take(AT_ONCE);
            some.map(|at| Variation::new(at + 1, self.values[at].clone())).collect()
        })
    }
}
