//! The simulation of a run on a mesh that another run made.

use crate::experiment::ExperimentError;
use crate::settings::Run;
use crate::simulation::Simulation;

/// The simulation of a run that differs from that of `made` in its cell, its material and its protocol only.
///
/// # Errors
/// A cell that is to be paced before and does not become steady.
pub(super) fn simulation(made: &Simulation, run: &Run) -> Result<Simulation, ExperimentError> {
    let mut simulation = made.clone();
    simulation.cell = run.cell.clone();
    simulation.start_state = run.start_state(&run.cell).map_err(ExperimentError::new)?.0;
    simulation.peak_tension = run.peak_tension;
    simulation.material = run.material.clone();
    simulation.protocol = run.protocol;
    simulation.duration = run.duration;
    simulation.numerics.method = run.numerics.method;
    simulation.numerics.cell = run.numerics.cell;
    Ok(simulation)
}
