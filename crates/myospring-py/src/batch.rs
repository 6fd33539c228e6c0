//! Many beats: a matrix of parameters in, a matrix of metrics out.

use crate::cell::{Cell, Inner};
use crate::waiting::interruptible;
use crate::{beat, errors, metrics, settings};
use myospring::integrate::Method;
use myospring::integrate::quasi_static::Tolerance;
use myospring::run_file::RunFile;
use myospring::settings::{Kind, Made, Named, Run, Setting, Value};
use myospring::simulation::{Ready, SharedPath, Simulation};
use myospring::study::Threads;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a column of the matrix sets.
enum Varied {
    /// A setting.
    Setting(&'static Setting),
    /// A parameter of the cell model.
    Parameter(String),
}

impl Varied {
    fn of(py: Python<'_>, name: &str, usual: &Run) -> PyResult<Self> {
        if let Some(setting) = settings::find(name) {
            return match setting.kind {
                Kind::Quantity { .. } | Kind::Whole { .. } => Ok(Self::Setting(setting)),
                _ => Err(errors::value(format!(
                    "`{name}` is no number, so it cannot be a column; give it as a setting that all members share"
                ))),
            };
        }
        let parameters = usual.cell.parameters();
        if parameters.get(name).is_some() {
            return Ok(Self::Parameter(name.to_owned()));
        }
        Err(errors::unknown_among(py, name, parameters.rows().iter().map(|row| &*row.name)))
    }

    /// The table of a run file that the column belongs to.
    fn table(&self) -> &'static str {
        match self {
            Self::Setting(setting) => setting.key.split_once('.').map_or("", |(table, _)| table),
            Self::Parameter(_) => "cell",
        }
    }
}

/// The metrics (N, M), and why a row has none.
type Answer<'py> = (Bound<'py, PyArray2<f64>>, Vec<Option<String>>);

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
    let (run, made) = beat::make(py, &cell.0, &file)?;
    let columns =
        names.iter().map(|name| Varied::of(py, name, &run)).collect::<PyResult<Vec<_>>>()?;
    let known = metrics::metrics();
    for name in &wanted {
        if !known.iter().any(|(metric, ..)| metric == name) {
            return Err(errors::unknown_among(py, name, known.iter().map(|(metric, ..)| *metric)));
        }
    }
    let rows: Vec<Vec<f64>> =
        params.as_array().outer_iter().map(|row| row.iter().copied().collect()).collect();
    let batch = Batch { cell: &cell.0, file, made, columns, wanted, shared: OnceLock::new() };
    let threads = py.detach(|| Threads::new(threads)).map_err(errors::value)?;
    let answers = interruptible(py, |stop| {
        threads.install(|| rows.par_iter().map(|row| batch.member(row, stop)).collect::<Vec<_>>())
    })?;
    let width = batch.wanted.len();
    let mut values = Vec::with_capacity(width * answers.len());
    let mut reasons = Vec::with_capacity(answers.len());
    for answer in answers {
        match answer {
            Ok(row) => {
                values.extend(row);
                reasons.push(None);
            }
            Err(reason) => {
                values.extend(std::iter::repeat_n(f64::NAN, width));
                reasons.push(Some(settings::in_python(&reason)));
            }
        }
    }
    let matrix = PyArray1::from_vec(py, values).reshape([reasons.len(), width])?;
    Ok((matrix, reasons))
}

/// What all members share.
struct Batch<'a> {
    cell: &'a Inner,
    file: RunFile,
    made: Made,
    columns: Vec<Varied>,
    wanted: Vec<String>,
    /// Mechanics of members that differ in the cell model alone, once the first of them is begun.
    shared: OnceLock<Result<SharedPath, String>>,
}

impl Batch<'_> {
    /// The metrics of one row, or why there are none.
    fn member(&self, row: &[f64], stop: &AtomicBool) -> Result<Vec<f64>, String> {
        if stop.load(Ordering::Relaxed) {
            return Err("interrupted".to_owned());
        }
        let run = self.run_of(row)?;
        let simulation = self.simulation(&run)?;
        let along = run.numerics.method == Method::QuasiStatic;
        let ready = if along && !self.varies(&["shape", "segmentation", "mechanics", "material"]) {
            let shared = self.shared.get_or_init(|| {
                let usual = Tolerance::default();
                self.made.simulation.shared_path(usual).map_err(|error| error.to_string())
            });
            shared.as_ref().map_err(Clone::clone)?.prepare(&simulation).map(Ready::AlongPath)
        } else {
            simulation.build()
        };
        let ready = ready.map_err(|error| error.to_string())?;
        let outcome = ready.run(|_progress| !stop.load(Ordering::Relaxed));
        if let Some(reason) = &outcome.stop {
            return Err(reason.to_string());
        }
        let beats = outcome.beats();
        let value = |name: &String| metrics::value(&beats, name).unwrap_or(f64::NAN);
        Ok(self.wanted.iter().map(value).collect())
    }

    fn simulation(&self, run: &Run) -> Result<Simulation, String> {
        if !self.varies(&["shape", "segmentation", "mechanics"]) {
            let Simulation { mesh, fibres, myofibril_content, .. } = &self.made.simulation;
            let driven = run.driven(|path| self.cell.read(path));
            let (cell, _) = driven.map_err(|error| error.to_string())?;
            let content = myofibril_content.clone();
            return Ok(Simulation {
                cell,
                ..run.simulation(mesh.clone(), fibres.clone(), content)
            });
        }
        let shaped = if self.varies(&["shape", "segmentation"]) {
            run.shape.mesh(&self.cell.bytes).map_err(|error| error.to_string())?
        } else {
            self.cell.shaped.clone()
        };
        let made = run.make(shaped, |path| self.cell.read(path));
        Ok(made.map_err(|error| error.to_string())?.simulation)
    }

    fn varies(&self, tables: &[&str]) -> bool {
        self.columns.iter().any(|column| tables.contains(&column.table()))
    }

    fn run_of(&self, row: &[f64]) -> Result<Run, String> {
        let mut file = self.file.clone();
        let mut parameters = match file.get("cell.parameters") {
            Some(Value::Named(given)) => given.clone(),
            _ => Named::new(),
        };
        let mut changed = false;
        for (column, &number) in self.columns.iter().zip(row) {
            match column {
                Varied::Setting(setting) => {
                    if !number.is_finite() {
                        let name = settings::name(setting);
                        return Err(format!("`{name}` = {number} is not a finite number"));
                    }
                    file.set(setting.key, settings::number(setting, number))
                        .map_err(|error| error.to_string())?;
                }
                Varied::Parameter(name) => {
                    parameters.insert(name.clone(), Value::Number(number));
                    changed = true;
                }
            }
        }
        if changed {
            file.set("cell.parameters", Value::Named(parameters))
                .map_err(|error| error.to_string())?;
        }
        file.resolve().map_err(|error| error.to_string())
    }
}
