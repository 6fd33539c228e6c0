//! Members of a study and the rows of its table.

use crate::output::table::Table;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A member of a study.
pub trait Member: Sync {
    /// Word for a member in the journal and in messages, such as `picture`.
    const KIND: &'static str;

    /// Row of its result.
    type Row: Row;

    /// Returns its name, unique in the study.
    fn name(&self) -> &str;

    /// Returns the hash of its input ([`sha256`](super::sha256)). A member whose hash has changed
    /// is computed again, and so is one whose input cannot be read (`None`).
    fn key(&self) -> Option<String>;
}

/// A row of a study's table; its JSON must keep every number to the last bit.
pub trait Row: Clone + Serialize + DeserializeOwned + Send {
    /// Returns the row of a member of which only the reason for its failure is known.
    fn failed(member: &str, reason: String) -> Self;

    /// Returns the outcome of its subject.
    fn status(&self) -> Status;

    /// Returns the table of these rows.
    fn table(rows: &[Self]) -> Table;
}

/// Outcome of the subject of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Finished.
    Ok,
    /// Found but not computed; the row states the reason.
    LeftOut,
    /// Failed, or stopped early.
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
