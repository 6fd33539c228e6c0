//! Beats of all sets of the minimal model, for Myokit to repeat: parameters, stimuli, and our states at
//! samples. `verification/python/myokit_check.py` reads it; the equations there are written from the
//! papers, only the numbers come from here.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::cell;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{SolverSettings, solve};
use serde::Serialize;
use std::collections::BTreeMap;

/// The sets: all models of the list but the toy.
const MODELS: [&str; 6] = [
    "coelho_2021",
    "bueno_orovio_2008_epi",
    "bueno_orovio_2008_endo",
    "bueno_orovio_2008_m",
    "bueno_orovio_2008_pb",
    "bueno_orovio_2008_tnnp",
];

#[derive(Serialize)]
struct Case {
    model: String,
    parameters: BTreeMap<String, f64>,
    /// A jump of u, or a rate of u (1/ms) for `pulse_ms`.
    amplitude: f64,
    /// 0 for a jump.
    pulse_ms: f64,
    start_ms: f64,
    cycle_length_ms: f64,
    beats: u32,
    time_ms: Vec<f64>,
    solutions: Vec<Solution>,
}

/// One of our ways to integrate the cell.
#[derive(Serialize)]
struct Solution {
    name: String,
    /// Largest difference allowed, of the state's largest value.
    tolerance: f64,
    reason: String,
    /// One column per state variable.
    states: Vec<Vec<f64>>,
}

/// Largest error of adaptive steps with a tolerance of 1e-5 for each of them.
pub const ADAPTIVE: f64 = 5e-4;

/// Largest error per ms of a fixed step: the equations jump at thresholds, which leaves order 1. Steeper
/// for tnnp, whose V barely reaches the narrow bell k(V), so that its tension follows the height of the
/// upstroke steeply.
pub fn error_per_ms(model: &str) -> f64 {
    if model == "bueno_orovio_2008_tnnp" { 1.0 } else { 0.5 }
}

fn case(name: &str, beats: u32, fine_step_ms: f64) -> Result<Case, Failure> {
    let model = cell::model(name)?;
    let protocol = Protocol { beats, ..Protocol::once(model.default_stimulus()) };
    let (amplitude, pulse_ms) = match protocol.stimulus {
        Stimulus::Jump { amplitude } => (amplitude, 0.0),
        Stimulus::Pulse { amplitude, duration_ms } => (amplitude, duration_ms),
    };
    let duration = if beats == 1 { 600.0 } else { f64::from(beats) * protocol.cycle_length_ms };
    let (fixed, rate) = (SolverSettings::default(), error_per_ms(name));
    let fine = SolverSettings { step_ms: fine_step_ms, ..fixed };
    let adaptive = model.usual_settings();
    let order = format!("order 1 at the model's thresholds: {rate} per ms of step");
    let each = format!("a tolerance of {} for each step", adaptive.tolerance);
    let (mut time_ms, mut solutions) = (Vec::new(), Vec::new());
    for (name, settings, tolerance, reason) in [
        (format!("fine step of {fine_step_ms} ms"), fine, rate * fine_step_ms, &order),
        (format!("step of {} ms", fixed.step_ms), fixed, rate * fixed.step_ms, &order),
        ("adaptive steps, as in a run".to_owned(), adaptive, ADAPTIVE, &each),
    ] {
        let trace = solve(&*model, protocol, settings, duration, 1.0)?;
        let (reason, states) = (reason.clone(), trace.states);
        solutions.push(Solution { name, tolerance, reason, states });
        time_ms = trace.time_ms;
    }
    Ok(Case {
        model: model.name().to_owned(),
        parameters: model
            .parameters()
            .rows()
            .iter()
            .map(|row| (row.name.to_string(), row.value))
            .collect(),
        amplitude,
        pulse_ms,
        start_ms: protocol.start_ms,
        cycle_length_ms: protocol.cycle_length_ms,
        beats,
        time_ms,
        solutions,
    })
}

/// Writes `myokit-ours.json` for the script; gives no rows itself.
///
/// # Errors
/// A cell that cannot be integrated, a file that cannot be written.
pub fn write(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let (train, fine_step_ms) = if setting.quick { (2, 0.001) } else { (10, 0.0002) };
    let mut cases = Vec::new();
    for name in MODELS {
        for beats in [1, train] {
            cases.push(case(name, beats, fine_step_ms)?);
        }
    }
    let file = std::fs::File::create(setting.folder.join("myokit-ours.json"))?;
    serde_json::to_writer(std::io::BufWriter::new(file), &cases)?;
    Ok(Vec::new())
}
