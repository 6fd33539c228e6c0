//! Fibres and sarcomeres of all that a picture shows.

use crate::cell::pairs;
use crate::experiment::{self, Progress};
use crate::{errors, settings};
use myospring::experiment::Files;
use myospring::experiment::segment::{FrameReport, ReadWholeFrame};
use myospring::run_file::RunFile;
use numpy::{IntoPyArray as _, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::collections::BTreeMap;

type Places<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>);

/// Points (um), columns and numbers by name, and notes; what was not read is NaN.
#[pyfunction]
pub(crate) fn whole_frame<'py>(
    py: Python<'py>,
    given: &Bound<'py, PyDict>,
    arrays: BTreeMap<String, Vec<u8>>,
) -> PyResult<(Places<'py>, Bound<'py, PyDict>, Bound<'py, PyList>)> {
    let mut file = RunFile::default();
    settings::put(&mut file, given)?;
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let picture = run.shape.file().unwrap_or_default().to_owned();
    let files = Files::holding(arrays);
    let read = experiment::run(py, &ReadWholeFrame { picture, run }, &files, Progress::None)?;
    let warnings = experiment::warnings(&read);
    let FrameReport { width_um, height_um, pixel_size_um, spacing_um, ref fibres, .. } =
        read.report();
    let frame = &read.read;
    let places = &frame.places;
    let columns = PyDict::new(py);
    let column = |name: &str, values: Vec<f64>| columns.set_item(name, array(py, values));
    let read = |value: f64, is: bool| if is { value } else { f64::NAN };
    let each = |value: &dyn Fn(&myospring::microscopy::fibres::Fibre) -> f64| {
        places.iter().map(|(_, place)| value(place)).collect()
    };
    column("direction_deg", each(&|place| read(place.angle_deg(), place.from_picture)))?;
    column("sarcomere_um", each(&|place| place.sarcomere_um.unwrap_or(f64::NAN)))?;
    column("order", each(&|place| read(place.order, place.from_picture)))?;
    column("coverage", each(&|place| read(place.coverage, place.from_picture)))?;
    let doubtful = frame.doubtful_lengths();
    let doubtful = places.iter().map(|(_, place)| place.sarcomere_um.is_some_and(&doubtful));
    columns.set_item("sarcomere_doubtful", doubtful.collect::<Vec<bool>>().into_pyarray(py))?;
    let numbers = PyDict::new(py);
    for (name, value) in [
        ("width_um", Some(width_um)),
        ("height_um", Some(height_um)),
        ("pixel_size_um", Some(pixel_size_um)),
        ("spacing_um", Some(spacing_um)),
        ("read_pct", Some(fibres.read_pct)),
        ("direction_deg", fibres.direction_deg),
        ("alignment", fibres.alignment),
        ("sarcomere_um", fibres.sarcomere_um),
        ("sarcomere_q1_um", fibres.sarcomere_q1_um),
        ("sarcomere_q3_um", fibres.sarcomere_q3_um),
    ] {
        numbers.set_item(name, value)?;
    }
    let doubt = fibres.sarcomere_doubt.map(|doubt| doubt.to_string());
    numbers.set_item("sarcomere_doubt", doubt)?;
    let points = pairs(py, places.iter().map(|(point, _)| *point))?;
    Ok(((points, columns), numbers, PyList::new(py, warnings)?))
}

fn array(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}
