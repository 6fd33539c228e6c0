//! run.json and run.toml: the record of a run, and the file that repeats it.

use crate::experiment::Inputs;
use crate::settings::Run;
use crate::simulation::{Outcome, Simulation, StopReason};
use serde::Serialize;

/// Where the time went.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[allow(clippy::struct_field_names, reason = "the names are keys of run.json and carry the unit")]
pub struct Timings {
    /// Reading the shape and meshing it.
    pub mesh_s: f64,
    /// Finding the stable time step, or solving the path of equilibria; a reference beat of the cell model
    /// where its parameters are not the published ones. Beside a path, the figure of the mesh is drawn.
    pub preparation_s: f64,
    /// The cell model during the beat.
    pub cell_s: f64,
    /// The mesh following its tension.
    pub mechanics_s: f64,
    /// Measuring shapes and keeping samples during the beat.
    pub recording_s: f64,
    /// Writing curves and numbers, and making the outputs, of which `outputs` has the split.
    pub outputs_s: f64,
    /// From start to end.
    pub total_s: f64,
}

/// Why a run ended early.
#[derive(Serialize)]
pub struct Stop<'a> {
    #[serde(flatten)]
    reason: &'a StopReason,
    message: String,
}

impl<'a> Stop<'a> {
    /// The stop of a finished run; `None` if it is complete.
    pub fn of(outcome: &'a Outcome) -> Option<Self> {
        outcome.stop.as_ref().map(|reason| Self { reason, message: reason.to_string() })
    }
}

/// The run file that repeats this run: spacing and time step are explicit, and files are named
/// relative to its place, from which `up` leads to the top of the results.
pub fn resolved(
    run: &Run,
    (inputs, up): (&Inputs, &str),
    simulation: &Simulation,
    spacing: f64,
    time_step: Option<f64>,
) -> String {
    let text = inputs.renamed(run.settled(spacing, time_step), up).to_toml();
    let model = simulation.cell.name();
    format!(
        "# Written by myospring {}: every setting of this run ({model}).\n{text}",
        env!("CARGO_PKG_VERSION")
    )
}
