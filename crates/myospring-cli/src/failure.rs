//! Errors as the program prints them, and their exit code.

use crate::exit::ExitCode;
use crate::print;
use miette::{
    Diagnostic, LabeledSpan, MietteHandler, MietteHandlerOpts, NamedSource, Report, SourceCode,
};
pub(crate) use myospring::experiment::ExperimentError as Failure;
use std::fmt;
use std::io::IsTerminal;

/// Bad input or usage.
pub(crate) const BAD_INPUT: u8 = 2;

/// Prints a failure and returns the exit code.
pub(crate) fn report(failure: Failure) -> ExitCode {
    // A hook that is already set is kept.
    miette::set_hook(Box::new(|_| Box::new(handler()))).ok();
    let passage = failure.passage();
    let source = passage.map(|passage| NamedSource::new(&passage.file, passage.text.clone()));
    print::note(&format!("{:?}", Report::new(Printed { failure, source })));
    ExitCode::from(BAD_INPUT)
}

/// Lines are wrapped only for a terminal, so that scripts can search for a message.
fn handler() -> MietteHandler {
    MietteHandlerOpts::new().wrap_lines(std::io::stderr().is_terminal()).build()
}

/// A failure in a text, with the text.
#[derive(Debug)]
struct Printed {
    failure: Failure,
    source: Option<NamedSource<String>>,
}

impl fmt::Display for Printed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.failure.fmt(formatter)
    }
}

impl std::error::Error for Printed {}

impl Diagnostic for Printed {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        self.failure.advice().map(|advice| Box::new(advice) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.failure.passage()?.span.clone();
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), span);
        Some(Box::new(std::iter::once(label)))
    }
}
