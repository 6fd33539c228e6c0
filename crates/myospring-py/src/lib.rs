//! The part of the Python package `myospring` that is written in Rust, its module `_native`.
//!
//! A thin door to the library: settings by name go in, arrays come out. What people see, with its defaults and
//! documentation, is the layer in Python above it (`python/myospring`), whose signatures are made from the same table
//! of settings ([`settings`]).

mod action_potential;
mod analyse;
mod batch;
mod beat;
mod cell;
mod compare;
mod errors;
mod experiment;
mod fit;
mod head;
mod many_pictures;
mod metrics;
mod name;
mod pictures;
mod presets;
mod segment;
mod settings;
mod study;
mod tension_map;
mod tissue;
mod track;
mod traction;
mod waiting;
mod whole_frame;
mod words;

use pyo3::prelude::*;
use std::ffi::OsString;

/// The program `myospring` with the arguments of a command line, its own name first; the code to end with.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| myospring_cli::main(arguments).0)
}

/// The module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<cell::Cell>()?;
    module.add_class::<beat::Beat>()?;
    module.add_class::<fit::Fitter>()?;
    module.add_class::<analyse::Analysis>()?;
    module.add_class::<fit::FilmFit>()?;
    module.add_class::<tension_map::TensionMap>()?;
    module.add_class::<compare::Comparison>()?;
    module.add_class::<track::Motion>()?;
    module.add_class::<track::Motions>()?;
    module.add_class::<traction::Tractions>()?;
    module.add_class::<tissue::Waves>()?;
    module.add_class::<tissue::Posts>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<study::Members>()?;
    module.add_class::<segment::Segmentation>()?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(segment::find, module)?)?;
    module.add_function(wrap_pyfunction!(many_pictures::beat_pictures, module)?)?;
    module.add_function(wrap_pyfunction!(beat::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(beat::repeat, module)?)?;
    module.add_function(wrap_pyfunction!(fit::read_curves, module)?)?;
    module.add_function(wrap_pyfunction!(fit::read_calcium, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit_film, module)?)?;
    module.add_function(wrap_pyfunction!(fit::is_film, module)?)?;
    module.add_function(wrap_pyfunction!(tension_map::tension_map, module)?)?;
    module.add_function(wrap_pyfunction!(batch::simulate_batch, module)?)?;
    module.add_function(wrap_pyfunction!(action_potential::action_potential, module)?)?;
    module.add_function(wrap_pyfunction!(analyse::analyse, module)?)?;
    module.add_function(wrap_pyfunction!(compare::compare, module)?)?;
    module.add_function(wrap_pyfunction!(presets::presets, module)?)?;
    module.add_function(wrap_pyfunction!(presets::preset_cell, module)?)?;
    module.add_function(wrap_pyfunction!(presets::simulate_preset, module)?)?;
    module.add_function(wrap_pyfunction!(presets::load, module)?)?;
    module.add_function(wrap_pyfunction!(track::track, module)?)?;
    module.add_function(wrap_pyfunction!(track::track_all, module)?)?;
    module.add_function(wrap_pyfunction!(traction::traction_of_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(traction::traction_of_beads, module)?)?;
    module.add_function(wrap_pyfunction!(tissue::map_waves, module)?)?;
    module.add_function(wrap_pyfunction!(tissue::track_posts, module)?)?;
    module.add_function(wrap_pyfunction!(metrics::metrics, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::tiff, module)?)?;
    module.add_function(wrap_pyfunction!(whole_frame::whole_frame, module)?)?;
    module.add_function(wrap_pyfunction!(study::study_toml, module)?)?;
    module.add_function(wrap_pyfunction!(study::with_rows, module)?)?;
    module.add_function(wrap_pyfunction!(settings::settings, module)?)?;
    module.add_function(wrap_pyfunction!(settings::models, module)?)?;
    module.add_function(wrap_pyfunction!(settings::parameters, module)?)?;
    module.add_function(wrap_pyfunction!(words::said, module)?)
}
