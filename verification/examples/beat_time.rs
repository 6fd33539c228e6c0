//! Seconds that a beat of the built-in cell takes, without figures and files.
//!
//! ```text
//! cargo run --release -p myospring-verification --example beat_time -- MILLISECONDS SPACING THREADS
//! ```
//!
//! SPACING in um and THREADS may be `default`. Prints one JSON line; the length at the end does not
//! depend on the number of threads, to the last bit.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program of its own")]

use myospring::integrate::stencil::worthwhile_threads;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::{Effort, Simulation};
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize| arguments.get(index).and_then(|text| text.parse::<f64>().ok());
    let mesh = lattice::from_outline(&built_in::adult_ventricular(), number(1)).unwrap().0;
    let (masses, springs) = (mesh.len(), mesh.springs.len());
    let mut simulation = Simulation::new(mesh);
    simulation.duration = number(0).unwrap_or(600.0);
    simulation.numerics.engine.threads =
        number(2).map_or_else(|| worthwhile_threads(springs), |threads| threads as usize);
    let prepared = simulation.prepare().unwrap();
    let start = Instant::now();
    let outcome = prepared.run(|_| true);
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(outcome.stop, None);
    let Effort::Verlet { steps, .. } = outcome.effort else { unreachable!("a run in time") };
    println!(
        "{{\"masses\": {masses}, \"threads\": {}, \"steps\": {}, \"seconds\": {seconds:.4}, \
         \"length_um\": {}}}",
        simulation.numerics.engine.threads,
        steps,
        outcome.recording.samples.last().unwrap().length_um
    );
}
