//! Many beats: a matrix of parameters in, a matrix of metrics out.

use crate::cell::Cell;
use crate::waiting::interruptible;
use crate::{errors, settings};
use myospring::settings::{Kind, Number, Run};
use myospring::study::parameters::{
    Common, ParameterStudy, ParameterStudyError, Variation, VariationRow, run_members,
};
use myospring::study::{Journal, Observer, StudyError, Threads};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, Ordering};

/// So many members are worked on before their rows are handed on: what they take beside these is bounded.
const AT_ONCE: usize = 8192;

/// The number that a column of the matrix sets.
fn number(py: Python<'_>, name: &str, usual: &Run) -> PyResult<Number> {
    if let Some(setting) = settings::find(name) {
        return match setting.kind {
            Kind::Quantity { .. } | Kind::Whole { .. } => Ok(Number {
                key: setting.key.to_owned(),
                unit: setting.unit().unwrap_or_default().to_owned(),
            }),
            _ => Err(errors::value(format!(
                "`{name}` is no number, so it cannot be a column; give it as a setting that all members share"
            ))),
        };
    }
    let rows = usual.cell.parameters().rows();
    let found = Number::all(usual).into_iter().find(|number| number.parameter() == Some(name));
    found.ok_or_else(|| errors::unknown_among(py, name, rows.iter().map(|row| &*row.name)))
}

/// The metrics (N, M), and why a row has none.
pub(crate) type Answer<'py> = (Bound<'py, PyArray2<f64>>, Vec<Option<String>>);

/// Beats a cell once for each row of `params` (N, K), whose columns `names` say; `given` are settings by key that all
/// share. The metrics (N, M), and why a row has none.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
pub(crate) fn simulate_batch<'py>(
    py: Python<'py>,
    cell: &Cell,
    given: &Bound<'py, PyDict>,
    names: Vec<String>,
    params: PyReadonlyArray2<'py, f64>,
    wanted: Vec<String>,
    threads: Option<usize>,
) -> PyResult<Answer<'py>> {
    let mut file = cell.0.file.clone();
    settings::put(&mut file, given)?;
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let numbers = names.iter().map(|name| number(py, name, &run)).collect::<PyResult<Vec<_>>>()?;
    let rows = params.as_array().outer_iter().map(|row| row.to_vec()).collect();
    let width = wanted.len();
    let study = ParameterStudy::of_rows(file, numbers, wanted, rows)
        .map_err(|error| errors::of_study(py, &error))?;
    let answers = interruptible(py, |stop| {
        let inner = &cell.0;
        let common = Common::still(&study, |path| inner.read(path), Some(&inner.shaped))?;
        let threads = Threads::new(threads)?;
        let mut rows = Vec::with_capacity(study.values.len());
        for (part, values) in study.values.chunks(AT_ONCE).enumerate() {
            let members = (part * AT_ONCE + 1..).zip(values);
            let members: Vec<Variation> =
                members.map(|(number, values)| Variation::new(number, values.clone())).collect();
            rows.extend(rows_of(&common, &members, &threads, stop)?);
        }
        Ok::<_, ParameterStudyError>(rows)
    })?;
    let rows = answers.map_err(|error| errors::of_study(py, &error))?;
    answer(py, rows, width, settings::in_python)
}

/// The rows of some members, in order; fewer once `stop` is set.
pub(crate) fn rows_of(
    common: &Common,
    members: &[Variation],
    threads: &Threads,
    stop: &AtomicBool,
) -> Result<Vec<VariationRow>, StudyError> {
    Ok(run_members(common, members, &Journal::in_memory(), threads, &Stopped(stop))?.rows)
}

/// Numbers of members.
pub(crate) fn numbers_of(numbers: &PyReadonlyArray1<'_, u64>) -> PyResult<Vec<usize>> {
    let number = |number: &u64| usize::try_from(*number).map_err(errors::value);
    numbers.as_array().iter().map(number).collect()
}

/// The numbers of rows as a matrix, and why a row has none, in these words.
pub(crate) fn answer(
    py: Python<'_>,
    rows: Vec<VariationRow>,
    width: usize,
    words: fn(&str) -> String,
) -> PyResult<Answer<'_>> {
    let mut values = Vec::with_capacity(width * rows.len());
    let mut reasons = Vec::with_capacity(rows.len());
    for VariationRow { metrics, reason, .. } in rows {
        if reason.is_empty() {
            values.extend(metrics.into_iter().map(|value| value.unwrap_or(f64::NAN)));
            reasons.push(None);
        } else {
            values.extend(std::iter::repeat_n(f64::NAN, width));
            reasons.push(Some(words(&reason)));
        }
    }
    Ok((PyArray1::from_vec(py, values).reshape([reasons.len(), width])?, reasons))
}

/// Ends a study once its flag is set.
struct Stopped<'a>(&'a AtomicBool);

impl Observer<Variation> for Stopped<'_> {
    fn finished(&self, _member: &Variation, _rows: &[VariationRow]) -> bool {
        self.goes_on()
    }

    fn goes_on(&self) -> bool {
        !self.0.load(Ordering::Relaxed)
    }
}
