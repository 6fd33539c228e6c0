//! The simulation of a fitted cell.

use crate::fit::Fitter;
use crate::settings::Run;
use crate::simulation::Simulation;

/// The simulation of a run with what was found.
pub(super) fn simulation(fitter: &Fitter, run: &Run) -> Simulation {
    let mut simulation = fitter.simulation().clone();
    simulation.cell = run.cell.clone();
    simulation.peak_tension = run.peak_tension;
    simulation.material = run.material.clone();
    simulation.protocol = run.protocol;
    simulation.duration = run.duration;
    simulation.numerics.method = run.numerics.method;
    simulation.numerics.cell = run.numerics.cell;
    simulation
}
