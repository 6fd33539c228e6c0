//! A part of a study, for one of several machines.

use super::super::sha256;
use super::description::ParameterStudy;
use super::error::ParameterStudyError;
use super::member::Variation;
use super::work::Common;
use std::fmt;
use std::str::FromStr;

/// Every so manieth member: `2/8` is the second of eight parts.
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
        let all = (1..).zip(&self.values).skip(part - 1).step_by(of);
        all.map(|(number, values)| Variation::new(number, values.clone())).collect()
    }

    /// What the rows depend on beside the members' values, as text for [`Journal::open`](super::super::Journal::open);
    /// `common` is made of this study.
    pub fn settings(&self, common: &Common) -> String {
        let names: Vec<&str> =
            self.varied.iter().map(|varied| varied.number.key.as_str()).collect();
        let file =
            |(name, bytes): (&String, &Vec<u8>)| format!("# file {name:?} {}\n", sha256(bytes));
        let files: String = common.files().iter().map(file).collect();
        format!(
            "# What the members in this folder depend on; a study goes on only with the same.\n\
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
}
