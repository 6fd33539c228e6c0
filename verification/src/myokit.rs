//! Beats of all sets of the minimal model, for Myokit to repeat: parameters, stimuli, and our states at
//! samples. `verification/python/myokit_check.py` reads it; the equations there are written from the
//! papers, only the numbers come from here.

use crate::row::Row;
use crate::{Failure, Setting};
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{Settings, solve};
use myospring::cell::{self, CellModel};
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
    model: &'static str,
    parameters: BTreeMap<&'static str, f64>,
    /// A jump of u, or a rate of u (1/ms) for `pulse_ms`.
    amplitude: f64,
    /// 0 for a jump.
    pulse_ms: f64,
    start_ms: f64,
    cycle_length_ms: f64,
    beats: u32,
    time_ms: Vec<f64>,
    /// Ours with default settings, and with the fine step: one column per state variable.
    default_step_ms: f64,
    default: Vec<Vec<f64>>,
    fine_step_ms: f64,
    fine: Vec<Vec<f64>>,
}

fn case(name: &str, beats: u32, fine_step_ms: f64) -> Result<Case, Failure> {
    let model = cell::model(name)?;
    let protocol = Protocol { beats, ..Protocol::once(model.default_stimulus()) };
    let (amplitude, pulse_ms) = match protocol.stimulus {
        Stimulus::Jump { amplitude } => (amplitude, 0.0),
        Stimulus::Pulse { amplitude, duration_ms } => (amplitude, duration_ms),
    };
    let duration = if beats == 1 { 600.0 } else { f64::from(beats) * protocol.cycle_length_ms };
    let run = |settings| solve(&*model, protocol, settings, duration, 1.0);
    let default = run(Settings::default())?;
    let fine = run(Settings { step_ms: fine_step_ms, ..Settings::default() })?;
    Ok(Case {
        model: CellModel::name(&*model),
        parameters: model.parameters().rows().iter().map(|row| (row.name, row.value)).collect(),
        amplitude,
        pulse_ms,
        start_ms: protocol.start_ms,
        cycle_length_ms: protocol.cycle_length_ms,
        beats,
        time_ms: default.time_ms,
        default_step_ms: Settings::default().step_ms,
        default: default.states,
        fine_step_ms,
        fine: fine.states,
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
