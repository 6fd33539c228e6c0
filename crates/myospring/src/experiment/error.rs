//! Errors of experiments, as people see them.

use super::legible;
use crate::cell::ModelError;
use crate::compare::factor::FactorError;
use crate::measured::ReadError;
use crate::microscopy::fibres::FibreError;
use crate::output::csv::{CsvError, TracesError};
use crate::output::figure::FigureError;
use crate::output::files::FileError;
use crate::output::json::JsonError;
use crate::output::npz::NpzError;
use crate::output::page::PageError;
use crate::output::vtu::VtuError;
use crate::run_file::{Origin, RunFileError, ShapeError};
use crate::settings::{FibresError, MakeError};
use crate::simulation::SetupError;
use crate::study::StudyError;
use std::fmt;
use std::io;
use std::ops::Range;
use std::path::Path;

/// A message, how to mend it, and, if it is about a text, the place in it.
#[derive(Debug, Clone)]
pub struct ExperimentError {
    message: String,
    advice: Option<String>,
    passage: Option<Passage>,
    /// Of a file that could not be read.
    kind: Option<io::ErrorKind>,
    is_unknown_name: bool,
}

/// The place in a text that an error is about.
#[derive(Debug, Clone)]
pub struct Passage {
    /// The file of the text.
    pub file: String,
    /// The whole text.
    pub text: String,
    /// Bytes of the text that the error is about.
    pub span: Range<usize>,
}

impl ExperimentError {
    /// A message without advice.
    pub fn new(message: impl fmt::Display) -> Self {
        let message = legible::message(&message.to_string());
        Self { message, advice: None, passage: None, kind: None, is_unknown_name: false }
    }

    /// A name that does not exist.
    pub(super) fn of_name(message: impl fmt::Display) -> Self {
        Self { is_unknown_name: true, ..Self::new(message) }
    }

    /// A file that could not be read.
    #[must_use]
    pub fn unread(path: &Path, error: &io::Error) -> Self {
        Self::new(format!("cannot read `{}`: {error}", path.display()))
            .advise("check the path and its spelling")
            .of_kind(error.kind())
    }

    fn of_kind(mut self, kind: io::ErrorKind) -> Self {
        self.kind = Some(kind);
        self
    }

    /// Adds how to mend it.
    #[must_use]
    pub fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(legible::message(&advice.into()));
        self
    }

    /// Adds a line to the advice.
    #[must_use]
    pub fn also(self, line: &str) -> Self {
        let advice = match &self.advice {
            Some(advice) => format!("{advice}\n{line}"),
            None => line.to_owned(),
        };
        self.advise(advice)
    }

    /// A problem of a run file; `text` is the file's, if it was read from one.
    #[must_use]
    pub fn of_run_file(error: &RunFileError, text: Option<&str>) -> Self {
        let passage = match (&error.origin, text) {
            (Origin::Text { file, span, .. }, Some(text)) if is_shown(text, span) => {
                Some(Passage { file: file.clone(), text: text.to_owned(), span: span.clone() })
            }
            _ => None,
        };
        let advice = error.advice().map(|advice| legible::message(&advice));
        Self { advice, passage, ..Self::new(error) }
    }

    /// How to mend it.
    #[must_use]
    pub fn advice(&self) -> Option<&str> {
        self.advice.as_deref()
    }

    /// The place in a text that it is about.
    #[must_use]
    pub fn passage(&self) -> Option<&Passage> {
        self.passage.as_ref()
    }

    /// Why a file could not be read or a folder not be used, where that is what went wrong.
    #[must_use]
    pub fn kind(&self) -> Option<io::ErrorKind> {
        self.kind
    }

    /// Whether it is a name that does not exist.
    #[must_use]
    pub fn is_unknown_name(&self) -> bool {
        self.is_unknown_name
    }

    /// Message and advice in one line.
    #[must_use]
    pub fn in_words(&self) -> String {
        match &self.advice {
            Some(advice) => format!("{}; {advice}", self.message),
            None => self.message.clone(),
        }
    }
}

/// Whether the line around a place is one that a person can read.
fn is_shown(text: &str, span: &Range<usize>) -> bool {
    const LONGEST: usize = 1000;
    let start = text[..span.start.min(text.len())].rfind('\n').map_or(0, |at| at + 1);
    let end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    end - start <= LONGEST && span.len() <= LONGEST
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for ExperimentError {}

impl From<ShapeError> for ExperimentError {
    fn from(error: ShapeError) -> Self {
        match &error {
            ShapeError::Read { cause, .. } => {
                Self::new(&error).advise("check the path and its spelling").of_kind(cause.kind())
            }
            _ => Self::new(&error),
        }
    }
}

impl From<ReadError> for ExperimentError {
    fn from(error: ReadError) -> Self {
        match &error {
            ReadError::Read { cause, .. } => Self::new(&error).of_kind(cause.kind()),
            _ => Self::new(&error),
        }
    }
}

impl From<StudyError> for ExperimentError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::OtherSettings { .. } | StudyError::Occupied { .. } => Self::new(error)
                .advise("--output DIR names another folder, --force begins anew in this one")
                .of_kind(io::ErrorKind::AlreadyExists),
            StudyError::Journal { .. } => {
                Self::new(error).advise("--output names another folder, like --output results/mine")
            }
            StudyError::File(error) => error.into(),
            error => Self::new(error),
        }
    }
}

impl From<FileError> for ExperimentError {
    fn from(error: FileError) -> Self {
        let of_folder = matches!(
            error,
            FileError::Read { .. }
                | FileError::Foreign { .. }
                | FileError::NotOurs { .. }
                | FileError::NoManifest { .. }
        );
        let failure = Self::new(error);
        if of_folder { failure.advise("--output DIR names another folder") } else { failure }
    }
}

macro_rules! plain {
    ($($error:ty),*) => {$(
        impl From<$error> for ExperimentError {
            fn from(error: $error) -> Self {
                Self::new(error)
            }
        }
    )*};
}

plain!(
    SetupError,
    CsvError,
    TracesError,
    FactorError,
    JsonError,
    NpzError,
    VtuError,
    FigureError,
    PageError,
    FibreError,
    FibresError,
    MakeError,
    ModelError
);
