//! The motion of a cell through a film.

use crate::cell::{pairs, triangles};
use crate::errors;
use crate::experiment::{self, Progress};
use crate::settings;
use myospring::experiment::Files;
use myospring::experiment::track::{Output, Track, Tracked};
use myospring::output::track::TrackRow;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Name and value of a column.
type Column = (&'static str, fn(&TrackRow) -> f64);

/// What one frame has, by the name of its column.
const COLUMNS: [Column; 10] = [
    ("t_ms", |row| row.t_ms),
    ("length_um", |row| row.length_um),
    ("shortening_pct", |row| row.shortening_pct),
    ("width_um", |row| row.width_um),
    ("area_um2", |row| row.area_um2),
    ("stretch_1", |row| row.stretch_1),
    ("stretch_2", |row| row.stretch_2),
    ("sarcomere_um", |row| row.sarcomere_um.unwrap_or(f64::NAN)),
    ("interpolated_pct", |row| row.interpolated_pct),
    ("correlation", |row| row.correlation.unwrap_or(f64::NAN)),
];

/// A cell that was followed.
#[pyclass(module = "myospring._native")]
pub(crate) struct Motion {
    files: Files,
    outcome: Tracked,
}

/// Follows the cell of a film; `given` are settings by key.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "they are those of Python")]
pub(crate) fn track(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate_per_s: Option<f64>,
    subset_um: Option<f64>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Motion> {
    let mut description = Track {
        settings: settings::list(given)?,
        frame_rate: frame_rate_per_s,
        threads,
        ..Track::of(film)
    };
    description.subset_um = subset_um.unwrap_or(description.subset_um);
    let files = Files::default();
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Motion { files, outcome })
}

#[pymethods]
impl Motion {
    /// All numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    /// Names of the columns.
    #[staticmethod]
    fn columns() -> Vec<&'static str> {
        COLUMNS.map(|(name, _)| name).to_vec()
    }

    /// How much the cell contracts, by the column that can be trusted, %: (frames,).
    #[getter]
    fn contraction_pct<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.outcome.report.headline.contraction_pct)
    }

    /// A column: (frames,).
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let Some((_, read)) = COLUMNS.iter().find(|(known, _)| *known == name) else {
            return Err(errors::unknown(py, format!("there is no column `{name}`")));
        };
        Ok(PyArray1::from_iter(py, self.outcome.report.rows.iter().map(read)))
    }

    /// Numbers of the frames in the film: (frames,).
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        let frames = self.outcome.followed.motion.frames.iter().map(|&frame| frame as u64);
        PyArray1::from_iter(py, frames)
    }

    /// Positions of the points, um, without the motion of the stage: (frames, points, 2).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let motion = &self.outcome.followed.motion;
        let mut flat = Vec::with_capacity(2 * motion.len() * motion.mesh.len());
        for frame in 0..motion.len() {
            let [x, y] = motion.positions(frame);
            flat.extend(x.iter().zip(&y).flat_map(|(x, y)| [*x, *y]));
        }
        PyArray1::from_vec(py, flat).reshape([motion.len(), motion.mesh.len(), 2])
    }

    /// Which points were interpolated from their neighbours: (frames, points).
    #[getter]
    fn interpolated<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let motion = &self.outcome.followed.motion;
        let flat: Vec<bool> = motion.interpolated.iter().flatten().copied().collect();
        PyArray1::from_vec(py, flat).reshape([motion.len(), motion.mesh.len()])
    }

    /// Motion of the stage that was taken out, um: (frames, 2).
    #[getter]
    fn stage_um<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.outcome.followed.motion.stage_um.iter().copied())
    }

    /// Points of each triangle: (triangles, 3).
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        triangles(py, &self.outcome.followed.motion.mesh)
    }

    /// Writes what `myospring track` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(
        &mut self,
        py: Python<'_>,
        folder: PathBuf,
        force: bool,
        outputs: Option<Vec<String>>,
    ) -> PyResult<PathBuf> {
        self.outcome.outputs = match &outputs {
            None => Output::DEFAULT.to_vec(),
            Some(words) => {
                words.iter().map(|word| output(py, word)).collect::<PyResult<Vec<_>>>()?
            }
        };
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}

fn output(py: Python<'_>, word: &str) -> PyResult<Output> {
    let found = Output::ALL.into_iter().find(|output| output.word() == word);
    found.ok_or_else(|| errors::unknown_among(py, word, Output::ALL.iter().map(|it| it.word())))
}
