//! Runs beside each other.

use crate::beat::Beat;
use crate::experiment::{self, Progress};
use crate::{errors, settings};
use myospring::compare::dose::{self, Dose};
use myospring::compare::factor::Factor;
use myospring::experiment::Files;
use myospring::experiment::compare::{Compare, Compared, Side, Source};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is compared.
#[derive(FromPyObject)]
pub(crate) enum Input {
    Beat(Py<Beat>),
    Path(PathBuf),
}

/// Runs that were compared.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Comparison {
    files: Files,
    outcome: Compared,
}

/// Compares runs, called `labels` or else by their own names; `given` are settings by key, `scale` factors by name, each set with its label, `doses` the text of
/// a file of doses.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
#[allow(clippy::too_many_arguments, reason = "they are those of Python")]
pub(crate) fn compare(
    py: Python<'_>,
    inputs: Vec<Input>,
    labels: Vec<String>,
    given: &Bound<'_, PyDict>,
    scale: Vec<(String, Vec<(String, f64)>)>,
    doses: Option<String>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Comparison> {
    let factors = |factors: Vec<(String, f64)>| {
        factors.into_iter().map(|(name, factor)| Factor { name, factor }).collect()
    };
    let scale = scale.into_iter().map(|(label, all)| Dose { label, factors: factors(all) });
    let doses = doses.map(|text| dose::read(&text).map_err(errors::value)).transpose()?;
    let mut held = BTreeMap::new();
    let sources = inputs.into_iter().map(|input| source(input, &mut held));
    let description = Compare {
        inputs: sources.collect::<PyResult<_>>()?,
        labels,
        settings: settings::list(given)?,
        scale: scale.collect(),
        doses: doses.unwrap_or_default(),
        threads,
        results: None,
    };
    let files = Files::holding(held);
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Comparison { files, outcome })
}

/// An input as the library takes it; files of beats go to `held`, by names that no other content has.
fn source(input: Input, held: &mut BTreeMap<String, Vec<u8>>) -> PyResult<Source> {
    let beat = match input {
        Input::Path(path) => return Ok(Source::Path(path)),
        Input::Beat(beat) => beat,
    };
    let beaten = &beat.get().beaten;
    let (made, outcome) = (&beaten.made, &beaten.outcome);
    let title = &beaten.run.title;
    let side = Side::of(
        if title.is_empty() { beaten.name.clone() } else { title.clone() },
        beaten.name.clone(),
        &beaten.run,
        made,
        outcome,
        beaten.shape_sha256.clone(),
    );
    let mut side = side.map_err(|error| errors::of_experiment(&error))?;
    for path in side.file.paths_mut() {
        let Ok(bytes) = beat.get().cell.read(path) else { continue };
        let own = PathBuf::from(&*path);
        let name = own.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for number in 2.. {
            if held.get(path).is_none_or(|other| *other == bytes) {
                break;
            }
            *path = own.with_file_name(format!("{number}_{name}")).display().to_string();
        }
        held.insert(path.clone(), bytes);
    }
    Ok(Source::Run(Box::new(side)))
}

#[pymethods]
impl Comparison {
    /// All numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    /// Each setting in which the runs differ, with its values as people read them.
    #[getter]
    fn settings(&self) -> Vec<(String, Vec<String>)> {
        let rows = self.outcome.differences.iter();
        rows.map(|row| (row.name.clone(), row.values.clone())).collect()
    }

    /// Writes what `myospring compare` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}
