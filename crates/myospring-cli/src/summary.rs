//! Curves and numbers of a run: what is always written, and first.

use crate::failure::Failure;
use crate::fibres;
use myospring::experiment::Folder;
use myospring::output::report::Summary;
use myospring::output::{csv, json};
use myospring::settings::{FibreReport, Fibres, Run};
use myospring::simulation::{Effort, Outcome, Simulation};
use serde::Serialize;

/// summary.json.
#[derive(Serialize)]
pub(crate) struct Numbers<'a> {
    #[serde(flatten)]
    pub(crate) summary: &'a Summary,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fibres: Option<&'a FibreReport>,
    pub(crate) integration: Effort,
}

/// Writes `traces.csv`, `summary.json` and, of a picture that shows them, `fibres.csv`.
pub(crate) fn write(
    folder: &Folder,
    run: &Run,
    simulation: &Simulation,
    fibres: &Fibres,
    outcome: &Outcome,
    numbers: &Numbers<'_>,
) -> Result<(), Failure> {
    folder.write("traces.csv", csv::traces(&outcome.recording)?)?;
    folder.write("summary.json", json::for_people(numbers)?)?;
    fibres::write(folder, [(run.shape.name(), &simulation.mesh, fibres)])
}
