//! The cells of many pictures.

use crate::experiment::{self, Progress};
use crate::settings;
use myospring::experiment::Files;
use myospring::experiment::batch::{Batch, Batched, Pictures};
use myospring::output::table::Column;
use myospring::study::Row as _;
use myospring::study::pictures::CellRow;
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// The rows of a batch, by column: words, or numbers of which those that are missing are NaN.
type Columns<'py> = Bound<'py, PyDict>;

/// Beats the cells of the pictures of a folder, of a table or of a list; `given` are settings by key that all share.
/// The columns of the table, all numbers as JSON, and warnings.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "the parts of a batch, each once")]
pub(crate) fn beat_pictures<'py>(
    py: Python<'py>,
    folder: Option<PathBuf>,
    pattern: Option<String>,
    table: Option<PathBuf>,
    pictures: Vec<PathBuf>,
    stacks: bool,
    given: &Bound<'py, PyDict>,
    figures: bool,
    jobs: Option<usize>,
    output: Option<PathBuf>,
    force: bool,
    progress: Progress,
) -> PyResult<(Columns<'py>, String, Vec<String>)> {
    let pictures = match (table, folder) {
        (Some(table), folder) => Pictures::Table { table, folder },
        (None, Some(folder)) => Pictures::Folder { folder, pattern },
        (None, None) => Pictures::Files(pictures),
    };
    let settings = settings::list(given)?;
    let batch = Batch { pictures, stacks, settings, figures, jobs, target: output, force };
    let batched = experiment::run(py, &batch, &Files::default(), progress)?;
    let numbers = experiment::numbers(&batched)?;
    Ok((columns(py, &batched)?, numbers, experiment::warnings(&batched)))
}

fn columns<'py>(py: Python<'py>, batched: &Batched) -> PyResult<Columns<'py>> {
    let columns = PyDict::new(py);
    for column in CellRow::table(&batched.rows).columns {
        match column {
            Column::Text { name, values } => columns.set_item(name, values)?,
            Column::Number { name, values } => {
                let values: Vec<f64> =
                    values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                columns.set_item(name, values.into_pyarray(py))?;
            }
        }
    }
    Ok(columns)
}
