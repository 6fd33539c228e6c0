//! run.json and run.toml: what a run was, and what repeats it.

use crate::outputs;
use myospring::experiment::Inputs;
use myospring::integrate::engine::EngineUsed;
use myospring::settings::Run;
use myospring::simulation::{Effort, Outcome, Simulation, StopReason};
use serde::Serialize;

/// Where the time went.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[allow(clippy::struct_field_names, reason = "the names are keys of run.json and carry the unit")]
pub(super) struct Timings {
    /// Reading the shape and meshing it.
    pub(super) mesh_s: f64,
    /// Finding the stable time step, or solving the path of equilibria; a reference beat of the cell model
    /// where its parameters are not the published ones.
    pub(super) preparation_s: f64,
    /// The cell model during the beat.
    pub(super) cell_s: f64,
    /// The mesh following its tension.
    pub(super) mechanics_s: f64,
    /// Measuring shapes and keeping samples during the beat.
    pub(super) recording_s: f64,
    /// Writing curves and numbers, and making the outputs, of which `outputs` has the split.
    pub(super) outputs_s: f64,
    /// From start to end.
    pub(super) total_s: f64,
}

/// run.json.
#[derive(Serialize)]
pub(super) struct Record<'a> {
    pub(super) program: &'static str,
    pub(super) version: &'static str,
    pub(super) input: Option<String>,
    pub(super) shape_sha256: String,
    pub(super) run_file_sha256: String,
    pub(super) stop: Option<Stop<'a>>,
    #[serde(flatten)]
    pub(super) effort: Effort,
    /// What moved the masses, where they were moved in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) engine: Option<EngineUsed>,
    pub(super) machine_threads: usize,
    pub(super) timings: Timings,
    /// What the outputs took; empty as long as none is made.
    pub(super) outputs: &'a outputs::Record,
}

/// Why a run ended early.
#[derive(Serialize)]
pub(super) struct Stop<'a> {
    #[serde(flatten)]
    pub(super) reason: &'a StopReason,
    pub(super) message: String,
}

impl<'a> Stop<'a> {
    pub(super) fn of(outcome: &'a Outcome) -> Option<Self> {
        outcome.stop.as_ref().map(|reason| Self { reason, message: reason.to_string() })
    }
}

/// The run file that repeats this run: spacing and time step spelled out, files named from where it stands, `up` from
/// which leads to the top of the results.
pub(crate) fn resolved(
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
