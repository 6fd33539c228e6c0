//! The numbers of a beat by name.

use myospring::analysis::Metric;
use myospring::analysis::beats::known;
use pyo3::prelude::*;

/// All metrics of a beat in the order of reading: name, unit, definition.
#[pyfunction]
pub(crate) fn metrics() -> Vec<(&'static str, &'static str, &'static str)> {
    let row = |Metric { name, unit, definition, .. }: Metric| (name, unit, definition);
    known(true).into_iter().map(row).collect()
}
