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
        /// Error of the operating system.
        cause: io::Error,
    },
    /// The file is not text.
    #[error("`{path}` is {what}")]
    NotText {
        /// The file.
        path: String,
        /// What the file is, and what to do.
        what: &'static str,
    },
    /// A field that is not a number, or a number that cannot be right.
    #[error("`{path}`, line {line}, column `{column}`: {cause}")]
    Field {
        /// The file.
        path: String,
        /// Line number, from 1.
        line: u64,
        /// Name of the column in the header, or its number.
        column: String,
        /// What is wrong, with the value, and how to correct it.
        cause: String,
    },
    /// The file as a whole gives no curves.
    #[error("`{path}`: {cause}")]
    Table {
        /// The file.
        path: String,
        /// What is wrong, and how to correct it.
        cause: String,
    },
}

impl ReadError {
    /// Returns what is wrong, without the name of the file.
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
