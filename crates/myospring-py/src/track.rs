//! The motion of a cell through a film.

use crate::cell::{pairs, triangles};
use crate::errors;
use crate::experiment::{self, Progress};
use crate::settings;
use crate::words;
use myospring::experiment::Files;
use myospring::experiment::track::{FilmCell, Output, Track, TrackCells, Tracked, TrackedCells};
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

/// All cells of a film.
#[pyclass(module = "myospring._native")]
pub(crate) struct Motions {
    files: Files,
    outcome: TrackedCells,
}

/// Follows the cell of a film; `given` are settings by key.
#[pyfunction]
pub(crate) fn track(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate_per_s: Option<f64>,
    subset_um: Option<f64>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Motion> {
    let description = described(film, given, frame_rate_per_s, subset_um, threads)?;
    let files = Files::default();
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Motion { files, outcome })
}

/// Follows all cells of a film, as [`track`] does one.
#[pyfunction]
pub(crate) fn track_all(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate_per_s: Option<f64>,
    subset_um: Option<f64>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Motions> {
    let description = described(film, given, frame_rate_per_s, subset_um, threads)?;
    let files = Files::default();
    let outcome = experiment::run(py, &TrackCells(description), &files, progress)?;
    Ok(Motions { files, outcome })
}

fn described(
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate: Option<f64>,
    subset_um: Option<f64>,
    threads: Option<usize>,
) -> PyResult<Track> {
    let settings = settings::list(given)?;
    let description = Track { settings, frame_rate, threads, ..Track::of(film) };
    Ok(Track { subset_um: subset_um.unwrap_or(description.subset_um), ..description })
}

#[pymethods]
impl Motions {
    /// All numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    /// In a sentence.
    #[getter]
    fn headline(&self) -> String {
        self.outcome.words()
    }

    /// Name and motion of each cell that was followed.
    #[getter]
    fn cells(&self) -> Vec<(String, Motion)> {
        let motion = |(cell, tracked): (&FilmCell, &Tracked)| {
            let motion = Motion { files: self.files.clone(), outcome: tracked.clone() };
            (cell.name.clone(), motion)
        };
        self.outcome.followed().map(motion).collect()
    }

    /// Name of each cell that was not followed, and why.
    #[getter]
    fn left_out(&self) -> Vec<(String, String)> {
        let cells = self.outcome.cells.iter().filter(|cell| cell.found.is_err());
        cells.map(|cell| (cell.name.clone(), words::in_python(cell.reason()))).collect()
    }

    /// Writes what `myospring track --cell all` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(
        &mut self,
        py: Python<'_>,
        folder: PathBuf,
        force: bool,
        outputs: Option<Vec<String>>,
    ) -> PyResult<PathBuf> {
        let outputs = asked(py, outputs)?;
        for cell in &mut self.outcome.cells {
            if let Ok(tracked) = &mut cell.found {
                tracked.outputs.clone_from(&outputs);
            }
        }
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
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
        self.outcome.outputs = asked(py, outputs)?;
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}

fn asked(py: Python<'_>, outputs: Option<Vec<String>>) -> PyResult<Vec<Output>> {
    let Some(words) = outputs else { return Ok(Output::DEFAULT.to_vec()) };
    words.iter().map(|word| output(py, word)).collect()
}

fn output(py: Python<'_>, word: &str) -> PyResult<Output> {
    let found = Output::ALL.into_iter().find(|output| output.word() == word);
    found.ok_or_else(|| errors::unknown_among(py, word, Output::ALL.iter().map(|it| it.word())))
}
