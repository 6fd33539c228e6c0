//! The values in which members differ.

use super::super::sampling::ParameterSample;
use std::borrow::Cow;

/// The values of all members: one row a member, one column a varied number.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Rows of a design, each computed on request.
    Sampled(ParameterSample),
    /// Given rows.
    Table(Vec<Vec<f64>>),
}

impl Values {
    /// How many members there are.
    pub fn members(&self) -> usize {
        match self {
            Self::Sampled(sample) => sample.count(),
            Self::Table(rows) => rows.len(),
        }
    }

    /// The values of a member, by its number from 1; `None` if there is no such member.
    pub fn of(&self, member: usize) -> Option<Cow<'_, [f64]>> {
        let row = member.checked_sub(1)?;
        match self {
            Self::Sampled(sample) => sample.row(row).map(Cow::Owned),
            Self::Table(rows) => rows.get(row).map(|row| Cow::Borrowed(row.as_slice())),
        }
    }
}
