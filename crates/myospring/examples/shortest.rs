//! The shortest program that beats a cell, as the README has it.
#![allow(clippy::print_stdout, clippy::unit_arg, reason = "five lines")]

use myospring::prelude::*;
fn main() -> Result<(), SetupError> {
    let beats = Simulation::new(built_in::adult_ventricular_mesh()).build()?.run(|_| true).beats();
    Ok(println!("{:.1} % shorter", beats[0].value("peak_shortening").unwrap_or_default()))
}
