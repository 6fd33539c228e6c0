//! What a study is made of, and what comes of it.

use crate::output::table::Table;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt;

/// One of the many that a study works on.
pub trait Member: Sync {
    /// What a member is called in the journal and in messages: `picture`.
    const KIND: &'static str;

    /// What comes of it.
    type Row: Row;

    /// Its name, which no other member of the study has.
    fn name(&self) -> &str;

    /// The hash of its input ([`sha256`](super::sha256)): another hash is done anew. `None` if the input
    /// cannot be read; then it is done anew, too.
    fn key(&self) -> Option<String>;
}

/// A row of a study's table; JSON must give back every number to the last bit.
pub trait Row: Clone + Serialize + DeserializeOwned + Send {
    /// The row of a member of which nothing is known but why it failed.
    fn failed(member: &str, reason: String) -> Self;

    /// What became of it.
    fn status(&self) -> Status;

    /// The table of some rows.
    fn table(rows: &[Self]) -> Table;
}

/// What became of a row's subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It was done.
    Ok,
    /// It was seen but not done, for a reason that the row gives.
    LeftOut,
    /// It cannot be done, or stopped early.
    Failed,
}

impl fmt::Display for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Ok => "ok",
            Self::LeftOut => "left out",
            Self::Failed => "failed",
        })
    }
}
