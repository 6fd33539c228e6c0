//! What goes wrong, as Python's own exceptions.

use crate::words;
use myospring::experiment::ExperimentError;
use myospring::measured::ReadError;
use myospring::parameter::nearest;
use myospring::run_file::RunFileError;
use myospring::settings::{MakeError, Problem, ShapeError};
use myospring::study::StudyError;
use myospring::study::parameters::ParameterStudyError;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::io;

/// A name that does not exist: `UnknownNameError`, a `KeyError` that prints its message as it is.
pub(crate) fn unknown(py: Python<'_>, message: String) -> PyErr {
    let made = || {
        let class = py.import("myospring._errors")?.getattr("UnknownNameError")?;
        class.call1((message,))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// A problem of a setting: names that do not exist are a `KeyError`, all else is a `ValueError`.
pub(crate) fn of_settings(py: Python<'_>, error: &RunFileError) -> PyErr {
    of_problem(py, &error.to_string(), &error.problem)
}

/// The same for a problem that has no place.
pub(crate) fn of_problem(py: Python<'_>, message: &str, problem: &Problem) -> PyErr {
    let mut message = words::in_python(message);
    if let Some(advice) = advice(problem) {
        message = format!("{message}; {advice}");
    }
    let is_name = match problem {
        Problem::UnknownKey { .. } | Problem::Model(_) => true,
        Problem::UnknownWord { key, .. } => key == "shape.built_in",
        Problem::Parameter(cause) => {
            matches!(cause, myospring::parameter::ParameterError::Unknown { .. })
        }
        _ => false,
    };
    if is_name { unknown(py, message) } else { PyValueError::new_err(message) }
}

/// How to mend it, where the message does not say it and the words of the program would mislead.
fn advice(problem: &Problem) -> Option<String> {
    Some(match problem {
        Problem::UnknownKey { known, .. } => format!("there are: {}", known.join(", ")),
        Problem::NotAMultiple { unit, .. } => {
            format!("give a multiple of {unit} ms, or change that one too")
        }
        Problem::TooMany { .. } => {
            "give a longer interval, fewer beats or a shorter duration".to_owned()
        }
        Problem::Parameter(_) | Problem::Parameters(_) => {
            "myospring.parameters(model) lists the parameters with their ranges".to_owned()
        }
        Problem::Model(_) => "myospring.models() lists the cell models".to_owned(),
        _ => return None,
    })
}

/// A shape that gives no mesh.
pub(crate) fn of_shape(error: &ShapeError) -> PyErr {
    let message = words::in_python(&error.to_string());
    match error {
        ShapeError::Read { cause, .. } => of_reading(cause, message),
        _ => PyValueError::new_err(message),
    }
}

/// A shape that was meshed and gives no simulation.
pub(crate) fn of_making(error: &MakeError) -> PyErr {
    PyValueError::new_err(words::in_python(&error.to_string()))
}

/// A study that cannot be.
pub(crate) fn of_study(py: Python<'_>, error: &ParameterStudyError) -> PyErr {
    of_description(py, error, true)
}

/// A study that cannot be, whose description was a text, or tables.
pub(crate) fn of_description(py: Python<'_>, error: &ParameterStudyError, of_text: bool) -> PyErr {
    match error {
        ParameterStudyError::Run(error) => of_settings(py, error),
        ParameterStudyError::Shape(error) => of_shape(error),
        ParameterStudyError::Metric { name, known, .. } => {
            unknown_among(py, name, known.iter().copied())
        }
        ParameterStudyError::Name(_) => unknown(py, words::in_python(&error.to_string())),
        ParameterStudyError::Read { cause, .. } => {
            of_reading(cause, words::in_python(&error.to_string()))
        }
        ParameterStudyError::Study(error) => of_journal(error),
        // A description that was a dict has no lines.
        ParameterStudyError::Toml(cause) if !of_text => value(cause.message()),
        _ => value(error),
    }
}

/// A folder of results that cannot be gone on with.
pub(crate) fn of_journal(error: &StudyError) -> PyErr {
    PyOSError::new_err(words::in_python(&error.to_string()))
}

/// A table of measured curves that cannot be read.
pub(crate) fn of_measured(error: &ReadError) -> PyErr {
    match error {
        ReadError::Read { cause, .. } => of_reading(cause, words::in_python(&error.to_string())),
        _ => value(error),
    }
}

/// An experiment that cannot be done.
pub(crate) fn of_experiment(error: &ExperimentError) -> PyErr {
    let message = words::in_python(&error.in_words());
    if error.is_unknown_name() {
        return Python::attach(|py| unknown(py, message));
    }
    match error.kind() {
        Some(io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(message),
        Some(_) => PyOSError::new_err(message),
        None => PyValueError::new_err(message),
    }
}

/// Results that cannot be written.
pub(crate) fn of_saving(error: &ExperimentError) -> PyErr {
    PyOSError::new_err(words::in_python(&error.in_words()))
}

fn of_reading(cause: &io::Error, message: String) -> PyErr {
    match cause.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
        _ => PyOSError::new_err(message),
    }
}

/// Anything else that a value is to blame for.
#[allow(clippy::needless_pass_by_value, reason = "for `map_err`")]
pub(crate) fn value(error: impl ToString) -> PyErr {
    PyValueError::new_err(words::in_python(&error.to_string()))
}

/// A name that is none of those that there are.
pub(crate) fn unknown_among<'a>(
    py: Python<'_>,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> PyErr {
    let known: Vec<&str> = known.collect();
    let near = nearest(name, known.iter().copied()).map(|near| format!("; did you mean `{near}`?"));
    unknown(
        py,
        format!(
            "there is no `{name}`{}; there are: {}",
            near.unwrap_or_default(),
            known.join(", ")
        ),
    )
}
