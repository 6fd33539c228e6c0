//! The shortest program that beats a cell, as the README has it.
#![allow(clippy::print_stdout, clippy::unit_arg, reason = "five lines")]

use myospring::prelude::*;
fn main() -> Result<(), SetupError> {
    let outcome = Simulation::new(built_in::adult_ventricular_mesh()).build()?.run(|_| true);
    Ok(println!("shortens by {:.1?} %", outcome.beats()[0].value("peak_shortening")))
}
