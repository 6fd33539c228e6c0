//! A cell: its outline and its mesh, from a picture, a mask, an outline or the program.

use crate::waiting::interruptible;
use crate::{errors, settings, words};
use ciborium::{from_reader, into_writer};
use myospring::experiment::Files;
use myospring::experiment::track::Followed;
use myospring::mesh::Mesh;
use myospring::mesh::quality::MeshReport;
use myospring::output::{figure, files};
use myospring::run_file::RunFile;
use myospring::settings::{ShapeBytes, Shaped, Source, table};
use numpy::{IntoPyArray as _, PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

/// Name of the frame at rest of a film.
pub(crate) const REST: &str = "rest.tif";

/// A cell that was found and meshed.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Cell(pub(crate) Arc<Inner>);

/// What a cell is.
pub(crate) struct Inner {
    /// The settings that make it.
    pub(crate) file: RunFile,
    /// The bytes of its files by name as written; also of those that are no files but arrays.
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    pub(crate) bytes: ShapeBytes,
    pub(crate) shaped: Shaped,
    pub(crate) name: String,
}

#[pymethods]
impl Cell {
    /// Finds and meshes a cell; `given` are settings by key, `arrays` the bytes of files that are none.
    #[new]
    fn new(
        py: Python<'_>,
        given: &Bound<'_, PyDict>,
        arrays: BTreeMap<String, Vec<u8>>,
    ) -> PyResult<Self> {
        let mut file = RunFile::default();
        settings::put(&mut file, given)?;
        Self::made(py, file, arrays)
    }

    /// Name of the cell, for people and folders.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Number of masses, springs and triangles.
    #[getter]
    fn counts(&self) -> (usize, usize, usize) {
        let MeshReport { masses, springs, triangles, .. } = self.0.shaped.report;
        (masses, springs, triangles)
    }

    /// Length, width, mean width (um), aspect ratio, long axis (degrees), spacing (um), area (um^2).
    #[getter]
    fn dimensions(&self) -> (f64, f64, f64, f64, f64, f64, f64) {
        let Shaped { report, outline, .. } = &self.0.shaped;
        let size = &report.dimensions;
        (
            size.length_um,
            size.width_um,
            size.mean_width_um,
            size.aspect_ratio,
            size.long_axis_deg,
            report.spacing_um,
            outline.area(),
        )
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.shaped.report.warnings.iter().map(|text| words::in_python(text)).collect()
    }

    /// Positions of the masses at rest, um: (nodes, 2).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [x, y] = &self.0.shaped.mesh.points;
        pairs(py, x.iter().zip(y).map(|(x, y)| [*x, *y]))
    }

    /// Nodes of each triangle: (triangles, 3).
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        triangles(py, &self.0.shaped.mesh)
    }

    /// The rings of the outline, um, the outer one first: (points, 2) each.
    #[getter]
    fn outline<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        self.0.shaped.outline.rings().map(|ring| pairs(py, ring.iter().copied())).collect()
    }

    /// The pixels of the cell in its picture: (rows, columns), and the side of one, um.
    #[getter]
    fn mask<'py>(&self, py: Python<'py>) -> PyResult<Option<(Bound<'py, PyArray2<bool>>, f64)>> {
        let Some((_, cell)) = &self.0.shaped.picture else { return Ok(None) };
        let mask = &cell.mask;
        let [columns, rows] = [mask.width(), mask.height()];
        let values = mask.inside();
        Ok(Some((values.into_pyarray(py).reshape([rows, columns])?, mask.pixel_size().um())))
    }

    /// The lattice as a figure, SVG.
    fn lattice_svg(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| figure::mesh(&self.0.shaped.mesh).map(|figure| figure.to_svg()))
            .map_err(errors::value)
    }

    /// All that makes the cell again.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let Inner { file, files, .. } = &*self.0;
        let mut written = Vec::new();
        into_writer(&(file.to_toml(), files), &mut written).map_err(errors::value)?;
        Ok(PyBytes::new(py, &written))
    }

    /// The cell of a state.
    #[staticmethod]
    fn of_state(py: Python<'_>, state: &[u8]) -> PyResult<Self> {
        let (text, files): (String, BTreeMap<String, Vec<u8>>) =
            from_reader(state).map_err(errors::value)?;
        let file = RunFile::from_text(&text).map_err(|error| errors::of_settings(py, &error))?;
        Self::made(py, file, files)
    }
}

impl Cell {
    /// Finds and meshes the cell of a run file; `files` are the bytes of files that are none.
    pub(crate) fn made(
        py: Python<'_>,
        file: RunFile,
        mut files: BTreeMap<String, Vec<u8>>,
    ) -> PyResult<Self> {
        let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
        let shaped = interruptible(py, |interruption| {
            let run = run.clone().interrupted_by(interruption);
            let read = |path: &str| {
                files.get(path).map_or_else(|| files::read(path.as_ref()), |it| Ok(it.clone()))
            };
            let bytes = run.shape.bytes(read)?;
            let shaped = run.shape.mesh(&bytes)?;
            Ok((bytes, shaped))
        })?;
        let (bytes, shaped) = shaped.map_err(|error| errors::of_shape(&error))?;
        // A cell stays what it is, also where its files are not.
        let drawn = run.shape.source.picture().and_then(|picture| picture.outline.as_deref());
        files.extend(run.shape.file().map(|path| (path.to_owned(), bytes.shape.clone())));
        files.extend(drawn.map(str::to_owned).zip(bytes.outline.clone()));
        let name = run.shape.name().to_owned();
        Ok(Self(Arc::new(Inner { file, files, bytes, shaped, name })))
    }

    /// The cell of a film at rest.
    pub(crate) fn of_film(followed: &Followed, read: &Files) -> Self {
        let Followed { run, rest_picture, shaped, .. } = followed;
        let mut run = run.clone();
        let mut files = BTreeMap::from([(REST.to_owned(), rest_picture.to_vec())]);
        let mut bytes = ShapeBytes { shape: rest_picture.to_vec(), outline: None };
        if let Source::Picture(source) = &mut run.shape.source {
            REST.clone_into(&mut source.path);
            bytes.outline = source.outline.as_ref().and_then(|path| read.bytes(path).ok());
            files.extend(source.outline.clone().zip(bytes.outline.clone()));
        }
        let (whole, mut file) = (run.to_run_file(), RunFile::default());
        for setting in table().filter(|setting| settings::is_of_cell(setting)) {
            // What a run says of itself can be said of it.
            whole.get(setting.key).and_then(|value| file.set(setting.key, value.clone()).ok());
        }
        let (shaped, name) = (shaped.clone(), followed.run.shape.name().to_owned());
        Self(Arc::new(Inner { file, files, bytes, shaped, name }))
    }
}

impl Inner {
    /// Its files, which results never replace.
    pub(crate) fn files(&self) -> Files {
        Files::holding(self.files.clone())
    }

    /// Reads a file by its name as written.
    pub(crate) fn read(&self, path: &str) -> io::Result<Vec<u8>> {
        self.files.get(path).map_or_else(|| files::read(path.as_ref()), |bytes| Ok(bytes.clone()))
    }
}

/// Points as an array (points, 2).
pub(crate) fn pairs(
    py: Python<'_>,
    points: impl Iterator<Item = [f64; 2]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let flat: Vec<f64> = points.flatten().collect();
    let count = flat.len() / 2;
    PyArray1::from_vec(py, flat).reshape([count, 2])
}

pub(crate) fn triangles<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<Bound<'py, PyArray2<u32>>> {
    let flat: Vec<u32> = mesh.simplices.iter().flat_map(|simplex| simplex.nodes).collect();
    let count = flat.len() / 3;
    PyArray1::from_vec(py, flat).reshape([count, 3])
}
