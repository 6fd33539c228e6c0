//! Fibres and sarcomeres of all that a picture shows.

use crate::cell::pairs;
use crate::{errors, settings, words};
use myospring::microscopy::whole_frame::WholeFrame;
use myospring::output::files;
use myospring::run_file::RunFile;
use myospring::settings::Fibre;
use numpy::{IntoPyArray as _, PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
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
    let source = run.shape.source.picture();
    let source = source.ok_or_else(|| PyValueError::new_err("give a picture"))?;
    let asked = match run.fibre {
        Fibre::Auto(asked) => asked.settings(),
        Fibre::Picture(settings) => settings,
        Fibre::LongAxis | Fibre::Angle(_) => {
            return Err(PyValueError::new_err("the fibres are read from the picture"));
        }
    };
    let shape = &run.shape;
    let made = py.detach(move || {
        let read = |path: &str| {
            arrays.get(path).map_or_else(|| files::read(path.as_ref()), |it| Ok(it.clone()))
        };
        let bytes = shape.bytes(read)?;
        source.unsegmented(&bytes)
    });
    let cells = made.map_err(|error| errors::of_shape(&error))?;
    let frame =
        py.detach(|| WholeFrame::read(&cells, &asked, run.shape.spacing)).map_err(errors::value)?;
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
    let quartiles = frame.summary.sarcomere_quartiles_um;
    for (name, value) in [
        ("width_um", Some(frame.size_um[0])),
        ("height_um", Some(frame.size_um[1])),
        ("pixel_size_um", Some(cells.pixel_size.um())),
        ("spacing_um", Some(frame.spacing_um)),
        ("read_pct", Some(100.0 * frame.summary.share_from_picture)),
        ("direction_deg", frame.direction_deg),
        ("alignment", frame.alignment),
        ("sarcomere_um", frame.summary.median_sarcomere_um),
        ("sarcomere_q1_um", quartiles.map(|[first, _]| first)),
        ("sarcomere_q3_um", quartiles.map(|[_, third]| third)),
    ] {
        numbers.set_item(name, value)?;
    }
    let mut notes: Vec<String> = cells.notes.iter().map(|note| words::in_python(note)).collect();
    notes.extend(frame.note().map(words::in_python));
    let doubt = frame.summary.sarcomere_doubt.map(|doubt| doubt.to_string());
    numbers.set_item("sarcomere_doubt", doubt)?;
    let points = pairs(py, places.iter().map(|(point, _)| *point))?;
    Ok(((points, columns), numbers, PyList::new(py, notes)?))
}

fn array(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}
