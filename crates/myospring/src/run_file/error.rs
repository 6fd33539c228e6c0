//! Errors in run files: what, where, and how to solve them.

use crate::settings::{Failure, Problem};
use std::fmt;
use std::ops::Range;

/// Where a value came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// Unknown.
    Unknown,
    /// A place in the text of a run file.
    Text {
        /// Name of the file; empty for a text without one.
        file: String,
        /// Range of bytes in the text.
        span: Range<usize>,
        /// Line, the first is 1.
        line: usize,
        /// Column in characters, the first is 1.
        column: usize,
    },
    /// An option of the command line: `--thickness`.
    Option(String),
    /// A cell of a table.
    Table {
        /// Name of the file.
        file: String,
        /// Line, the header is 1.
        line: u64,
        /// The column's name.
        column: String,
    },
}

impl Origin {
    /// Whether values of both were given together, so that neither overrides the other: options, or one line of a table.
    pub(super) fn stands_beside(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Option(_), Self::Option(_)) => true,
            (Self::Table { line, .. }, Self::Table { line: others, .. }) => line == others,
            _ => false,
        }
    }

    /// The place of a span in a text.
    pub fn in_text(file: &str, text: &str, span: Range<usize>) -> Self {
        let before = &text[..span.start.min(text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        Self::Text { file: file.to_owned(), span, line, column }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => Ok(()),
            Self::Text { file, line, column, .. } if file.is_empty() => {
                write!(formatter, "line {line}, column {column}: ")
            }
            Self::Text { file, line, column, .. } => {
                write!(formatter, "{file}, line {line}, column {column}: ")
            }
            Self::Option(name) => write!(formatter, "option {name}: "),
            Self::Table { file, line, column } => {
                write!(formatter, "{file}, line {line}, column `{column}`: ")
            }
        }
    }
}

/// A problem and where it is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{origin}{problem}")]
pub struct RunFileError {
    /// Its place.
    pub origin: Origin,
    /// The key with its table, `material.thickness`; empty if no key caused it.
    pub key: String,
    /// The problem.
    #[source]
    pub problem: Problem,
}

impl RunFileError {
    /// How to solve it, in one sentence; `None` if the message already says so.
    pub fn advice(&self) -> Option<String> {
        let name = match &self.origin {
            Origin::Option(option) => format!("{option} "),
            Origin::Table { column, .. } => format!("{column}: "),
            _ => format!("{} = ", self.key.rsplit('.').next().unwrap_or_default()),
        };
        self.problem.advice(&name)
    }

    pub(super) fn bare((key, problem): Failure) -> Self {
        Self { origin: Origin::Unknown, key, problem }
    }
}
