//! Beats that differ in peak tension and one parameter of the cell model, in a plain loop of the library: what
//! `simulate_batch` of the Python package is measured against (`crates/myospring-py/benches/batch.py`).
//!
//! Prints one JSON line: members, threads, seconds without the mesh, and the sum of what they shorten by.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example batch_loop -- 1000 2
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::integrate::quasi_static::Tolerance;
use myospring::run_file::RunFile;
use myospring::simulation::Simulation;
use std::error::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let members = arguments.next().transpose()?.unwrap_or(1000);
    let threads = arguments.next().transpose()?.unwrap_or(1);
    let file = RunFile::from_text(
        "numerics.integrator = \"quasi-static\"\nnumerics.frame_interval = \"1 s\"",
    )?;
    let run = file.resolve()?;
    let shaped = run.shape.mesh(&run.shape.bytes(|file| std::fs::read(file))?)?;
    let simulation = run.make(shaped, |file| std::fs::read(file))?.simulation;
    let tau = simulation.cell.parameters().get("tau_si").ok_or("tau_si")?;

    let start = Instant::now();
    let path = simulation.shared_path(Tolerance::default())?;
    let beat = |member: usize| -> Result<f64, Box<dyn Error>> {
        let share = member as f64 / members as f64;
        let mut parameters = simulation.cell.parameters().clone();
        parameters.set("tau_si", tau * (0.95 + 0.1 * share))?;
        let simulation = Simulation {
            cell: simulation.cell.with_parameters(parameters)?,
            peak_tension: 20.0 + 40.0 * share,
            ..simulation.clone()
        };
        let outcome = path.prepare(&simulation)?.run(|_progress| true);
        outcome.beats().mean("peak_shortening").ok_or_else(|| "it does not shorten".into())
    };
    let (next, sum) = (AtomicUsize::new(0), Mutex::new(Ok::<f64, String>(0.0)));
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let member = next.fetch_add(1, Ordering::Relaxed);
                    if member >= members {
                        break;
                    }
                    let shortening = beat(member).map_err(|error| error.to_string());
                    if let Ok(mut sum) = sum.lock() {
                        *sum = sum.clone().and_then(|sum| Ok(sum + shortening?));
                    }
                }
            });
        }
    });
    let seconds = start.elapsed().as_secs_f64();
    let sum = sum.into_inner().map_err(|_| "a thread panicked")??;
    println!(
        r#"{{"members": {members}, "threads": {threads}, "seconds": {seconds:.4}, "sum": {sum:.9}}}"#
    );
    Ok(())
}
