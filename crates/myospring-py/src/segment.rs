//! The cells of a picture.

use crate::cell::pairs;
use crate::experiment::{self, Progress};
use crate::{errors, settings};
use myospring::experiment::{Files, segment};
use myospring::run_file::RunFile;
use numpy::{IntoPyArray as _, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The cells that were found in a picture.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Segmentation {
    found: segment::Segmented,
    files: Files,
}

/// Finds the cells of a picture; `given` are settings by key, `arrays` the bytes of files that are none, `all` is
/// whether every cell is wanted.
#[pyfunction]
#[pyo3(name = "segment")]
pub(crate) fn find(
    py: Python<'_>,
    given: &Bound<'_, PyDict>,
    arrays: BTreeMap<String, Vec<u8>>,
    all: bool,
    progress: Progress,
) -> PyResult<Segmentation> {
    let mut file = RunFile::default();
    settings::put(&mut file, given)?;
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let picture = run.shape.file().unwrap_or_default().to_owned();
    let files = Files::holding(arrays);
    let asked = segment::Segment { picture, run, all, refused: None, of_cut: Vec::new() };
    let found = experiment::run(py, &asked, &files, progress)?;
    Ok(Segmentation { found, files })
}

#[pymethods]
impl Segmentation {
    /// All numbers, JSON, as `report.json` has them.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.found)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.found)
    }

    /// The rings of the outline of each cell, um, the outer one first: (points, 2) each.
    #[getter]
    fn outlines<'py>(&self, py: Python<'py>) -> PyResult<Vec<Vec<Bound<'py, PyArray2<f64>>>>> {
        let rings = |cell: &segment::Chosen| {
            let rings = cell.cell.outline.rings();
            rings.map(|ring| pairs(py, ring.iter().copied())).collect()
        };
        self.found.chosen.iter().map(rings).collect()
    }

    /// The pixels of each cell in the picture: (rows, columns).
    #[getter]
    fn masks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<bool>>>> {
        let pixels = |cell: &segment::Chosen| {
            let mask = &cell.cell.mask;
            mask.inside().into_pyarray(py).reshape([mask.height(), mask.width()])
        };
        self.found.chosen.iter().map(pixels).collect()
    }

    /// The picture with the outlines, SVG.
    fn overlay_svg(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.found.overlay().map(|figure| figure.to_svg())).map_err(errors::value)
    }

    /// Writes what `myospring segment` writes into a folder; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.found, &folder, force, &self.files)
    }

    /// Writes the outlines to a file in the format that its ending names, and an overlay beside it; their names.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn write(&self, py: Python<'_>, file: PathBuf, force: bool) -> PyResult<Vec<String>> {
        let written = py.detach(|| {
            segment::check(std::slice::from_ref(&file), force, &self.files)?;
            self.found.write(std::slice::from_ref(&file), &self.files)
        });
        written.map_err(|error| errors::of_saving(&error))
    }
}
