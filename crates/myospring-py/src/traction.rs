//! Tractions of a cell on a gel.

use crate::errors;
use crate::experiment::{self, Progress};
use myospring::experiment::tables::TABLES;
use myospring::experiment::traction::{
    Beads, CellPlace, FoundTractions, Source, Traction, TractionFrame,
};
use myospring::experiment::{Files, input};
use myospring::mechanics::gel::Gel;
use myospring::output::npz::{self, Array};
use numpy::{PyArray1, PyArray3, PyArrayMethods as _, PyReadonlyArray3};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Name and value of a column.
type Column = (&'static str, fn(&TractionFrame) -> f64);

/// What one frame has, by the name of its column.
const COLUMNS: [Column; 7] = [
    ("t_ms", |frame| frame.t_ms.unwrap_or(f64::NAN)),
    ("traction_force_nN", |frame| frame.force_nn),
    ("axial_force_nN", |frame| frame.axial_force_nn),
    ("contractile_moment_fJ", |frame| frame.contractile_moment_fj),
    ("gel_energy_fJ", |frame| frame.energy_fj),
    ("noise_floor_nN", |frame| frame.noise_floor_nn),
    ("axial_noise_floor_nN", |frame| frame.axial_noise_floor_nn),
];

/// The arrays, in the order of `FoundTractions::fields`.
const FIELDS: [&str; 4] = ["u_um", "v_um", "traction_x_Pa", "traction_y_Pa"];

/// Tractions that were found.
#[pyclass(module = "myospring._native")]
pub(crate) struct Tractions {
    files: Files,
    outcome: FoundTractions,
}

/// Modulus (kPa), Poisson's ratio and thickness (um) of a gel.
type GelGiven = (f64, f64, Option<f64>);

/// A file of the cell, and its channel.
type Where = Option<(PathBuf, Option<usize>)>;

fn described(
    source: Source,
    (modulus, poisson, thickness): GelGiven,
    cell: Where,
    frame_rate_per_s: Option<f64>,
    threads: Option<usize>,
) -> Traction {
    let gel = Gel { poisson, thickness, ..Gel::half_space(modulus) };
    let cell = cell.map(|(path, channel)| CellPlace::File { path, channel });
    Traction { source, gel, cell, frame_rate_per_s, threads }
}

/// Of displacements in um, to the right and downward: (frames, rows, columns).
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    reason = "what Python hands over is owned; the layer in Python names it"
)]
pub(crate) fn traction_of_arrays(
    py: Python<'_>,
    displacements: [PyReadonlyArray3<'_, f64>; 2],
    spacing_um: f64,
    subset_um: Option<f64>,
    gel: GelGiven,
    cell: Where,
    frame_rate_per_s: Option<f64>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Tractions> {
    let names = ["u", "v"];
    let held = names.iter().zip(&displacements).map(|(name, array)| {
        let array = array.as_array();
        let bytes = npz::to_npy(&Array::floats(array.shape(), array.iter().copied()));
        ((*name).to_owned(), bytes)
    });
    let files = Files::holding(held.collect());
    let source = Source::Arrays {
        files: names.map(PathBuf::from),
        pixel_size_um: spacing_um,
        unit_um: Some(1.0),
        subset_um,
    };
    let description = described(source, gel, cell, frame_rate_per_s, threads);
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Tractions { files, outcome })
}

/// Of pictures of beads, or of a table of displacements; lengths are um.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "the layer in Python names them")]
pub(crate) fn traction_of_beads(
    py: Python<'_>,
    film: PathBuf,
    reference: Option<PathBuf>,
    rest: Option<usize>,
    pixel_size_um: Option<f64>,
    subset_um: Option<f64>,
    channel: Option<usize>,
    gel: GelGiven,
    cell: Where,
    frame_rate_per_s: Option<f64>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Tractions> {
    let source = if TABLES.contains(&input::ending(&film).as_str()) {
        Source::Table { file: film, pixel_size_um, unit_um: None, subset_um }
    } else {
        Source::Beads(Beads { film, reference, rest, pixel_size_um, subset_um, channel })
    };
    let files = Files::default();
    let description = described(source, gel, cell, frame_rate_per_s, threads);
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Tractions { files, outcome })
}

#[pymethods]
impl Tractions {
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

    /// A column: (frames,).
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let Some((_, read)) = COLUMNS.iter().find(|(known, _)| *known == name) else {
            return Err(errors::unknown(py, format!("there is no column `{name}`")));
        };
        Ok(PyArray1::from_iter(py, self.outcome.frames.iter().map(read)))
    }

    /// Numbers of the frames in the film: (frames,).
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.outcome.frames.iter().map(|frame| frame.frame as u64))
    }

    /// Displacements or tractions, rows from the top, to the right and downward: (frames, rows, columns).
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let Some(at) = FIELDS.iter().position(|known| *known == name) else {
            return Err(errors::unknown(py, format!("there is no array `{name}`")));
        };
        let array = &self.outcome.fields()[at];
        let shape = [array.shape()[0], array.shape()[1], array.shape()[2]];
        PyArray1::from_slice(py, array.as_floats().unwrap_or_default()).reshape(shape)
    }

    /// Distance of neighbouring places, um.
    #[getter]
    fn spacing_um(&self) -> f64 {
        self.outcome.spacing_um()
    }

    /// Writes what `myospring traction` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}
