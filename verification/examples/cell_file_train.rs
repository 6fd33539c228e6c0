//! A train of stimuli at 1 Hz of a cell model read from a file, as JSON: the potential each ms of
//! the last beat, by stiff steps of some tolerances, and the time that a beat takes.
//!
//! `verification/cell-models/compare_trains.py` compares it with CVODE.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example cell_file_train -- FILE BEATS
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::cell::CellModel;
use myospring::cell::equation_model::EquationModel;
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell_files::{Choices, open};
use serde_json::json;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

const CYCLE_MS: f64 = 1000.0;
const START_MS: f64 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, beats] = &arguments[..] else { return Err("give FILE and BEATS".into()) };
    let beats: u32 = beats.parse()?;
    let model = Arc::new(EquationModel::new(open(Path::new(file), &Choices::default())?)?);
    let Stimulus::Pulse { amplitude, duration_ms } = model.default_stimulus() else {
        return Err("the stimulus is no current".into());
    };
    let protocol = Protocol {
        start_ms: START_MS,
        beats,
        cycle_length_ms: CYCLE_MS,
        ..Protocol::once(model.default_stimulus())
    };
    let usual = model.usual_settings();
    let mut runs = Vec::new();
    for tolerance in [usual.tolerance, 1e-2 * usual.tolerance] {
        let settings = myospring::cell::solve::SolverSettings { tolerance, ..usual };
        let mut cell = CellIntegrator::new(model.clone(), protocol, settings)?;
        let start = Instant::now();
        let last_ms = CYCLE_MS * f64::from(beats - 1);
        cell.advance_to(last_ms, 1.0, 0.0)?;
        let mut potential = Vec::new();
        for sample in 0..=1000 {
            cell.advance_to(last_ms + f64::from(sample), 1.0, 0.0)?;
            potential.push(model.potential(cell.state()));
        }
        let ms_a_beat = 1e3 * start.elapsed().as_secs_f64() / f64::from(beats);
        runs.push(json!({"tolerance": tolerance, "ms_a_beat": ms_a_beat, "potential": potential}));
    }
    let roles = &model.equations().roles;
    let state = &model.equations().states[roles.potential.state].name;
    println!(
        "{}",
        json!({
            "potential": state, "stimulus": roles.stimulus.name, "amplitude": amplitude,
            "duration_ms": duration_ms, "start_ms": START_MS, "cycle_ms": CYCLE_MS, "runs": runs,
            "method": usual.method,
        })
    );
    Ok(())
}
