//! Beats of measured curves.

use crate::experiment::{self, Progress};
use crate::fit::{self, Measured, Reading};
use myospring::experiment::analyse::{Analyse, Analysed};
use myospring::experiment::{BeatOptions, Files};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A curve: file, times (ms), values.
type Values<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// A loop: number of the beat, times (ms), calcium, motion.
type Loop<'py> =
    (usize, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// How beats are found, by name.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Finding {
    stimulus_times_ms: Vec<f64>,
    stimulus_period_ms: Option<f64>,
    stimulus_start_ms: Option<f64>,
    smoothing_ms: Option<f64>,
    keep_drift: bool,
}

/// Curves whose beats were looked for.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Analysis {
    files: Files,
    outcome: Analysed,
}

/// Finds the beats of tables and of curves.
#[pyfunction]
pub(crate) fn analyse(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    curves: Vec<Measured>,
    reading: Reading,
    finding: Finding,
    progress: Progress,
) -> PyResult<Analysis> {
    let description = Analyse {
        paths,
        curves: curves.into_iter().map(fit::curve).collect::<PyResult<_>>()?,
        table: reading.options()?,
        beats: BeatOptions {
            stimuli_ms: finding.stimulus_times_ms,
            period_ms: finding.stimulus_period_ms,
            start_ms: finding.stimulus_start_ms,
            smoothing_ms: finding.smoothing_ms,
            keep_drift: finding.keep_drift,
        },
    };
    let files = Files::default();
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Analysis { files, outcome })
}

#[pymethods]
impl Analysis {
    /// All numbers, JSON.
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    /// Of each curve its file, times (ms) and values.
    fn curves<'py>(&self, py: Python<'py>) -> Vec<Values<'py>> {
        let curves = self.outcome.curves.iter().map(|read| {
            let [times, values] = [&read.curve.times_ms, &read.curve.values]
                .map(|values| PyArray1::from_slice(py, values));
            (read.file.clone(), times, values)
        });
        curves.collect()
    }

    /// Of each pair of curves the loops of its beats.
    fn loops<'py>(&self, py: Python<'py>) -> Vec<Vec<Loop<'py>>> {
        let array = |values: &[f64]| PyArray1::from_slice(py, values);
        let loops = self.outcome.pairs.iter().map(|pair| {
            let loops = pair.paired.loops.iter();
            let of = |(beat, one): &(usize, _)| {
                let myospring::analysis::paired::Loop { times_ms, calcium, motion, .. } = one;
                (*beat, array(times_ms), array(calcium), array(motion))
            };
            loops.map(of).collect()
        });
        loops.collect()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    /// Writes what `myospring analyse` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}
