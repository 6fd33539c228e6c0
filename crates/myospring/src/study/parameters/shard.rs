//! A part of a study, for one of several machines.

use super::description::ParameterStudy;
use super::error::ParameterStudyError;
use super::member::Variation;
use std::fmt;
use std::str::FromStr;

/// Every n-th member: `2/8` is the second of eight parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub part: usize,
    /// Of how many.
    pub of: usize,
}

impl Shard {
    /// All members.
    pub const WHOLE: Self = Self { part: 1, of: 1 };
}

impl Shard {
    /// The number of members in it, of all.
    pub fn size(self, members: usize) -> usize {
        (members + self.of - self.part) / self.of
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.part, self.of)
    }
}

impl FromStr for Shard {
    type Err = ParameterStudyError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let read = || {
            let (part, of) = text.split_once('/')?;
            let (part, of) = (part.trim().parse().ok()?, of.trim().parse().ok()?);
            (1 <= part && part <= of).then_some(Self { part, of })
        };
        read().ok_or_else(|| ParameterStudyError::Shard { text: text.to_owned() })
    }
}

impl ParameterStudy {
    /// The members of a part, in order: each `of`-th, so that parts take equally long.
    pub fn members(&self, Shard { part, of }: Shard) -> Vec<Variation> {
        (part..=self.values.members())
            .step_by(of)
            .filter_map(|number| self.member(number))
            .collect()
    }

    /// The member of a number, from 1; `None` if there is no such member.
    pub fn member(&self, number: usize) -> Option<Variation> {
        Some(Variation::new(number, self.values.of(number)?.into_owned()))
    }
}
