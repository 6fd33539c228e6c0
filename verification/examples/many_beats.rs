//! Many beats in one process: its memory stays what it was after the first of them.
//!
//! ```text
//! cargo run --release -p myospring-verification --example many_beats -- [BEATS]
//! ```
//!
//! Each beat is that of the built-in cell with another peak tension, on a coarse mesh, along its equilibria: set up, run, measured. 10 000
//! unless stated. Prints the memory in use after each tenth (Linux), and fails if the last is more than 1 MB above the first.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program of its own")]

use myospring::integrate::Method;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::Simulation;

const MOST_KB: u64 = 1000;

fn main() {
    let beats: usize = std::env::args().nth(1).map_or(10_000, |beats| beats.parse().unwrap());
    let (mesh, _) = lattice::from_outline(&built_in::adult_ventricular(), Some(4.0)).unwrap();
    let mut in_use = Vec::new();
    println!("| beats | memory, kB |\n|---|---|");
    for beat in 1..=beats {
        let mut simulation = Simulation::new(mesh.clone());
        simulation.numerics.method = Method::QuasiStatic;
        simulation.peak_tension = 30.0 + 40.0 * (beat % 97) as f64 / 97.0;
        let outcome = simulation.build().unwrap().run(|_| true);
        assert!(outcome.stop.is_none());
        assert!(outcome.beats()[0].value("peak_shortening").unwrap() > 5.0);
        if beat % (beats / 10).max(1) == 0 {
            in_use.push(resident_kb());
            println!("| {beat} | {} |", in_use[in_use.len() - 1]);
        }
    }
    let grown = in_use[in_use.len() - 1].saturating_sub(in_use[0]);
    println!("\ngrown by {grown} kB since the first tenth");
    std::process::exit(i32::from(grown > MOST_KB));
}

/// Memory of this process that is in use, kB; 0 where the system does not tell.
fn resident_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
