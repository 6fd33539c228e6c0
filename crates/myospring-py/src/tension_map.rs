//! Maps of tension of films.

use crate::cell::{Cell, pairs};
use crate::experiment::{self, Progress};
use crate::{errors, settings};
use myospring::experiment::Files;
use myospring::experiment::tension_map::{FilmMap, MapTension};
use myospring::experiment::track::Track;
use myospring::output::table::{Column, Table};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Where the cell of a film pulls.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct TensionMap {
    pub(crate) map: FilmMap,
    pub(crate) cell: Py<Cell>,
    pub(crate) files: Files,
}

/// The film of a path, with settings by key.
pub(crate) fn track(
    path: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate: Option<f64>,
) -> PyResult<Track> {
    Ok(Track { settings: settings::list(given)?, frame_rate, ..Track::of(path) })
}

/// The map of a film; `given` are settings by key.
#[pyfunction]
pub(crate) fn tension_map(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate_per_s: Option<f64>,
    progress: Progress,
) -> PyResult<TensionMap> {
    let asked = MapTension { track: track(film, given, frame_rate_per_s)? };
    let files = Files::default();
    let map = experiment::run(py, &asked, &files, progress)?;
    let cell = Py::new(py, Cell::of_film(&map.followed, &files))?;
    Ok(TensionMap { map, cell, files })
}

/// Names and values of columns.
pub(crate) type Columns<'py> = Vec<(String, Bound<'py, PyArray1<f64>>)>;

/// The numbers of a table.
pub(crate) fn columns(py: Python<'_>, table: Table) -> Columns<'_> {
    let number = |column| match column {
        Column::Number { name, values } => {
            let values = values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
            Some((name, PyArray1::from_vec(py, values)))
        }
        Column::Text { .. } => None,
    };
    table.columns.into_iter().filter_map(number).collect()
}

#[pymethods]
impl TensionMap {
    /// The cell of the film at rest.
    #[getter]
    fn cell(&self, py: Python<'_>) -> Py<Cell> {
        self.cell.clone_ref(py)
    }

    /// Its numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.map)
    }

    /// What a reader must know.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.map)
    }

    /// In a sentence.
    #[getter]
    fn headline(&self) -> String {
        self.map.words()
    }

    /// Names and values of the columns of `tension_map.csv`, an entry for each triangle.
    fn columns<'py>(&self, py: Python<'py>) -> Columns<'py> {
        columns(py, self.map.table())
    }

    /// Those of `tension_frames.csv`, an entry for each frame.
    fn frame_columns<'py>(&self, py: Python<'py>) -> Columns<'py> {
        columns(py, self.map.frames_table())
    }

    /// Tension of each triangle in each frame, kPa, not a number where it is not known, and its standard deviation:
    /// (frames, triangles).
    fn frame_tensions<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        let (film, triangles) = (&self.map.film, self.map.followed.motion.mesh.simplices.len());
        let frames = 0..film.frames.len();
        let tensions = frames.clone().flat_map(|frame| self.map.known_tensions_kpa(frame));
        let deviations = frames.clone().flat_map(|frame| film.deviations_kpa(frame));
        let shape = [frames.len(), triangles];
        let tensions = PyArray1::from_vec(py, tensions.collect()).reshape(shape)?;
        Ok([tensions, PyArray1::from_vec(py, deviations.collect()).reshape(shape)?])
    }

    /// Where the map puts the masses at the peak, um: (nodes, 2).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [x, y] = &self.map.map.positions_um;
        pairs(py, x.iter().zip(y).map(|(x, y)| [*x, *y]))
    }

    /// The figure, SVG.
    fn svg(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.map.figure()).map(|figure| figure.to_svg()).map_err(errors::value)
    }

    /// Writes the map; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.map, &folder, force, &self.files)
    }
}
