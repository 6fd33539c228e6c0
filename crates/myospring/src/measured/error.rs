//! Why a file has no curves.

use std::io;

/// Why a file has no curves.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("cannot read `{path}`: {cause}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        cause: io::Error,
    },
    /// It is no text.
    #[error("`{path}` is {what}")]
    NotText {
        /// The file.
        path: String,
        /// What it is, and what to do.
        what: &'static str,
    },
    /// A field that is no number, or one that cannot be.
    #[error("`{path}`, line {line}, column `{column}`: {cause}")]
    Field {
        /// The file.
        path: String,
        /// Its line, from 1.
        line: u64,
        /// The column as its header calls it, or its number.
        column: String,
        /// What is wrong, with the value, and how to mend it.
        cause: String,
    },
    /// The file as a whole gives no curves.
    #[error("`{path}`: {cause}")]
    Table {
        /// The file.
        path: String,
        /// What is wrong, and how to mend it.
        cause: String,
    },
}

impl ReadError {
    /// What is wrong, without the name of the file.
    pub(super) fn cause(&self) -> String {
        match self {
            Self::Read { cause, .. } => cause.to_string(),
            Self::NotText { what, .. } => format!("it is {what}"),
            Self::Field { line, column, cause, .. } => {
                format!("line {line}, column `{column}`: {cause}")
            }
            Self::Table { cause, .. } => cause.clone(),
        }
    }
}
