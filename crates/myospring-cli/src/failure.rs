//! What goes wrong, as people see it, and the exit code that it gives.

use crate::exit::ExitCode;
use crate::print;
use miette::{
    Diagnostic, LabeledSpan, MietteHandler, MietteHandlerOpts, NamedSource, Report, SourceCode,
};
use myospring::compare::factor::FactorError;
use myospring::microscopy::fibres::FibreError;
use myospring::output::csv::{CsvError, TracesError};
use myospring::output::figure::FigureError;
use myospring::output::files::FileError;
use myospring::output::json::JsonError;
use myospring::output::npz::NpzError;
use myospring::output::page::PageError;
use myospring::output::vtu::VtuError;
use myospring::run_file::{Origin, RunFileError, ShapeError};
use myospring::simulation::SetupError;
use myospring::study::StudyError;
use std::fmt;
use std::io::IsTerminal;

/// Bad input or usage.
pub(crate) const BAD_INPUT: u8 = 2;

/// A message with advice and, where there is one, the place in a file; exit code 2.
#[derive(Debug)]
pub(crate) struct Failure {
    message: String,
    advice: Option<String>,
    source: Option<(NamedSource<String>, std::ops::Range<usize>)>,
}

impl Failure {
    /// A message without advice.
    pub(crate) fn new(message: impl fmt::Display) -> Self {
        Self { message: print::message(&message.to_string()), advice: None, source: None }
    }

    /// Adds how to mend it.
    pub(crate) fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(print::message(&advice.into()));
        self
    }

    /// Adds a line to the advice.
    pub(crate) fn also(self, line: &str) -> Self {
        let advice = match &self.advice {
            Some(advice) => format!("{advice}\n{line}"),
            None => line.to_owned(),
        };
        self.advise(advice)
    }

    /// A problem of a run file; `text` is the file's, if it was read from one.
    pub(crate) fn of_run_file(error: &RunFileError, text: Option<&str>) -> Self {
        let source = match (&error.origin, text) {
            (Origin::Text { file, span, .. }, Some(text)) if is_shown(text, span) => {
                Some((NamedSource::new(file, text.to_owned()), span.clone()))
            }
            _ => None,
        };
        let advice = error.advice().map(|advice| print::message(&advice));
        Self { message: print::message(&error.to_string()), advice, source }
    }

    /// Message and advice, for whoever prints it elsewhere.
    pub(crate) fn in_words(&self) -> String {
        match &self.advice {
            Some(advice) => format!("{}; {advice}", self.message),
            None => self.message.clone(),
        }
    }

    /// Prints it and gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        // A hook that is already set does as well.
        miette::set_hook(Box::new(|_| Box::new(handler()))).ok();
        crate::print::note(&format!("{:?}", Report::new(self)));
        ExitCode::from(BAD_INPUT)
    }
}

/// Whether the line around a place is one that a person can read.
fn is_shown(text: &str, span: &std::ops::Range<usize>) -> bool {
    const LONGEST: usize = 1000;
    let start = text[..span.start.min(text.len())].rfind('\n').map_or(0, |at| at + 1);
    let end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    end - start <= LONGEST && span.len() <= LONGEST
}

/// Lines are broken for a terminal only, so that scripts can search for a message.
fn handler() -> MietteHandler {
    MietteHandlerOpts::new().wrap_lines(std::io::stderr().is_terminal()).build()
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl Diagnostic for Failure {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        self.advice.as_ref().map(|advice| Box::new(advice) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|(source, _)| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, span) = self.source.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(
            Some("here".to_owned()),
            span.clone(),
        ))))
    }
}

impl From<ShapeError> for Failure {
    fn from(error: ShapeError) -> Self {
        match &error {
            ShapeError::Read { .. } => Self::new(&error).advise("check the path and its spelling"),
            _ => Self::new(&error),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::OtherSettings { .. } | StudyError::Occupied { .. } => Self::new(error)
                .advise("--output DIR names another folder, --force begins anew in this one"),
            StudyError::Journal { .. } => {
                Self::new(error).advise("--output names another folder, like --output results/mine")
            }
            StudyError::File(error) => error.into(),
            error => Self::new(error),
        }
    }
}

impl From<FileError> for Failure {
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
        impl From<$error> for Failure {
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
    myospring::settings::MakeError,
    myospring::cell::ModelError
);
