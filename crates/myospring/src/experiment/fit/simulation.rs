//! The simulation of a run on a mesh that another run made.

use crate::settings::Run;
use crate::simulation::Simulation;

/// The simulation of a run that differs from that of `made` in its cell, its material and its protocol only.
pub(super) fn simulation(made: &Simulation, run: &Run) -> Simulation {
    let mut simulation = made.clone();
    simulation.cell = run.cell.clone();
    simulation.peak_tension = run.peak_tension;
    simulation.material = run.material.clone();
    simulation.protocol = run.protocol;
    simulation.duration = run.duration;
    simulation.numerics.method = run.numerics.method;
    simulation.numerics.cell = run.numerics.cell;
    simulation
}
