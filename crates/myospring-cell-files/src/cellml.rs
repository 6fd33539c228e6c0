//! CellML 1.0, 1.1 and 2.0: components, connections, units, imports, annotations.
//!
//! Specifications: <https://www.cellml.org/specifications>. Not supported, and refused with a
//! reason: reactions, resets, delays, equations that would need a solver.

mod connections;
mod element;
mod finish;
mod import;
mod math;
mod tree;
mod units;

use crate::draft::{Draft, Problem};

/// Reads the text of a file, and of the files that it imports, to a draft.
pub(crate) fn parse(
    file: &str,
    text: &str,
    beside: &dyn Fn(&str) -> Option<String>,
) -> Result<Draft, Problem> {
    let mut sources = import::Sources::new(beside);
    let model = sources.model(file, text, "", 0)?;
    finish::draft(&model)
}
