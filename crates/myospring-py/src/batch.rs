//! Many beats: a matrix of parameters in, a matrix of metrics out.

use crate::cell::Cell;
use crate::experiment::{Progress, Watch, watched};
use crate::{errors, settings, words};
use myospring::experiment::Observer;
use myospring::interruption::Interruption;
use myospring::settings::{NumericSetting, Run, ValueKind};
use myospring::study::parameters::{
    Common, ParameterStudy, ParameterStudyError, Shard, Variation, VariationRow, run_members,
};
use myospring::study::{Journal, StudyError, StudyObserver, Threads};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicU64, Ordering};

/// So many members are worked on before their rows are handed on: what they take beside these is bounded.
const AT_ONCE: usize = 8192;

/// The number that a column of the matrix sets.
fn number(py: Python<'_>, name: &str, usual: &Run) -> PyResult<NumericSetting> {
    if let Some(setting) = settings::find(name) {
        return match setting.kind {
            ValueKind::Quantity { .. } | ValueKind::Whole { .. } => Ok(NumericSetting {
                key: setting.key.to_owned(),
                unit: setting.unit().unwrap_or_default().to_owned(),
            }),
            _ => Err(errors::value(format!(
                "`{name}` is no number, so it cannot be a column; give it as a setting that all members share"
            ))),
        };
    }
    // Parameters of the cell model, and settings as a study names them: `peak_tension`, in kPa.
    NumericSetting::named(usual, name).map_err(|_| {
        let rows = usual.cell.parameters().rows();
        errors::unknown_among(py, name, rows.iter().map(|row| &*row.name))
    })
}

/// The metrics (N, M), and why a row has none, in Python's hands.
pub(crate) type Answered<'py> = (Bound<'py, PyArray2<f64>>, Vec<Option<String>>);

/// Metrics of members, row by row, and why a row has none.
pub(crate) struct Matrix {
    width: usize,
    values: Vec<f64>,
    reasons: Vec<Option<String>>,
}

impl Matrix {
    /// Of so many metrics, with room for so many members.
    pub(crate) fn new(width: usize, members: usize) -> Self {
        let values = Vec::with_capacity(width * members);
        Self { width, values, reasons: Vec::with_capacity(members) }
    }

    /// Adds the rows of some members; a reason is put in these words.
    pub(crate) fn add(&mut self, rows: Vec<VariationRow>, words: fn(&str) -> String) {
        for VariationRow { metrics, reason, .. } in rows {
            if reason.is_empty() {
                self.values.extend(metrics.into_iter().map(|value| value.unwrap_or(f64::NAN)));
                self.reasons.push(None);
            } else {
                self.values.extend(std::iter::repeat_n(f64::NAN, self.width));
                self.reasons.push(Some(words(&reason)));
            }
        }
    }

    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Answered<'_>> {
        let shape = [self.reasons.len(), self.width];
        Ok((PyArray1::from_vec(py, self.values).reshape(shape)?, self.reasons))
    }
}

/// Beats a cell once for each row of `params` (N, K), whose columns `names` say; `given` are settings by key that all
/// share. The metrics (N, M), and why a row has none.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
#[allow(clippy::too_many_arguments, reason = "they are those of Python")]
pub(crate) fn simulate_batch<'py>(
    py: Python<'py>,
    cell: &Cell,
    given: &Bound<'py, PyDict>,
    names: Vec<String>,
    params: PyReadonlyArray2<'py, f64>,
    wanted: Vec<String>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Answered<'py>> {
    let mut file = cell.0.file.clone();
    settings::put(&mut file, given)?;
    let file =
        ParameterStudy::along_equilibria(file).map_err(|error| errors::of_settings(py, &error))?;
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let numbers = names.iter().map(|name| number(py, name, &run)).collect::<PyResult<Vec<_>>>()?;
    let rows = params.as_array().outer_iter().map(|row| row.to_vec()).collect();
    let width = wanted.len();
    let study = ParameterStudy::of_rows(file, numbers, wanted, rows)
        .map_err(|error| errors::of_study(py, &error))?;
    let matrix = watched(py, progress, |watch| {
        let inner = &cell.0;
        let study = ParameterStudy { interruption: watch.interruption(), ..study };
        let common = Common::still(&study, |path| inner.read(path), Some(&inner.shaped))?;
        let threads = Threads::new(threads)?;
        let mut matrix = Matrix::new(width, study.values.members());
        watch.stage("members", study.values.members() as u64);
        let watched = Watched { watch, done: AtomicU64::new(0) };
        for members in study.in_turn(Shard::WHOLE, AT_ONCE) {
            matrix.add(rows_of(&common, &members, &threads, &watched)?, words::in_python);
        }
        Ok::<_, ParameterStudyError>(matrix)
    })?;
    matrix.map_err(|error| errors::of_study(py, &error))?.into_python(py)
}

/// The rows of some members, in order; fewer once they are asked to end early.
pub(crate) fn rows_of(
    common: &Common,
    members: &[Variation],
    threads: &Threads,
    observer: &impl StudyObserver<Variation>,
) -> Result<Vec<VariationRow>, StudyError> {
    Ok(run_members(common, members, &Journal::in_memory(), threads, observer)?.rows)
}

/// Numbers of members.
pub(crate) fn numbers_of(numbers: &PyReadonlyArray1<'_, u64>) -> PyResult<Vec<usize>> {
    let number = |number: &u64| usize::try_from(*number).map_err(errors::value);
    numbers.as_array().iter().map(number).collect()
}

/// Passes on how many members are done.
struct Watched<'a> {
    watch: &'a Watch,
    done: AtomicU64,
}

impl StudyObserver<Variation> for Watched<'_> {
    fn finished(&self, _member: &Variation, _rows: &[VariationRow]) -> bool {
        self.watch.reached(self.done.fetch_add(1, Ordering::Relaxed) + 1);
        !self.interruption().is_requested()
    }

    fn interruption(&self) -> Interruption {
        self.watch.interruption()
    }
}

/// Ends a study early.
pub(crate) struct Stopped<'a>(pub(crate) &'a Interruption);

impl StudyObserver<Variation> for Stopped<'_> {
    fn finished(&self, _member: &Variation, _rows: &[VariationRow]) -> bool {
        !self.0.is_requested()
    }

    fn interruption(&self) -> Interruption {
        self.0.clone()
    }
}
