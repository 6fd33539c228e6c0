//! How far beats are from converged ones of another program (`crates/myospring/tests/reference/cell_converged.py`): a JSON line
//! for each published set and way of integrating, and the largest of each way.
//!
//! Five beats each at 500, 1000 and 2000 ms; adaptive steps at tolerances 1e-5 (the default) and 1e-9, and the
//! default fixed steps.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example cell_accuracy
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::analysis::trace;
use myospring::cell::adaptive::{self, beats};
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::MinimalModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{self, solve};
use myospring::cell::{CellModel, coelho_2021};
use std::error::Error;

const BEATS: u32 = 5;
const START_MS: f64 = 50.0;
/// Samples of fixed steps; between them tension and potential bend by less than the digits shown.
const SAMPLE_MS: f64 = 0.1;

/// Highest potential variable, highest tension, when (ms), APD90 (ms).
type Numbers = [f64; 4];

fn main() -> Result<(), Box<dyn Error>> {
    let mut models = vec![coelho_2021::model()];
    let variants = [Variant::Epi, Variant::Endo, Variant::M, Variant::Pb, Variant::Tnnp];
    models.extend(variants.map(bueno_orovio_2008::model));
    for way in ["adaptive, 1e-5", "adaptive, 1e-9", "fixed"] {
        let mut largest = [0.0; 4];
        for model in &models {
            let mut worst = [0.0; 4];
            for cycle_ms in [500.0, 1000.0, 2000.0] {
                let found = match way {
                    "fixed" => fixed(model, cycle_ms)?,
                    "adaptive, 1e-5" => adaptive(model, cycle_ms, 1e-5)?,
                    _ => adaptive(model, cycle_ms, 1e-9)?,
                };
                grow(&mut worst, &differences(model, cycle_ms, &found)?);
            }
            print(way, model.name(), worst);
            grow(&mut largest, &worst);
        }
        print(way, "largest", largest);
    }
    Ok(())
}

fn train(model: &MinimalModel, cycle_length_ms: f64) -> (Protocol, f64) {
    let stimulus = model.default_stimulus();
    let protocol =
        Protocol { start_ms: START_MS, cycle_length_ms, beats: BEATS, ..Protocol::once(stimulus) };
    (protocol, START_MS + f64::from(BEATS) * cycle_length_ms)
}

fn adaptive(
    model: &MinimalModel,
    cycle_ms: f64,
    tolerance: f64,
) -> Result<Vec<Numbers>, Box<dyn Error>> {
    let (protocol, duration_ms) = train(model, cycle_ms);
    let beats = beats(model, protocol, adaptive::AdaptiveSettings { tolerance }, duration_ms)?;
    beats
        .iter()
        .map(|beat| {
            let apd90_ms = beat.apd90_ms.ok_or("a beat does not repolarise")?;
            Ok([beat.peak_potential, beat.peak_tension, beat.peak_tension_ms, apd90_ms])
        })
        .collect()
}

fn fixed(model: &MinimalModel, cycle_ms: f64) -> Result<Vec<Numbers>, Box<dyn Error>> {
    let (protocol, duration_ms) = train(model, cycle_ms);
    let course = solve(model, protocol, solve::SolverSettings::default(), duration_ms, SAMPLE_MS)?;
    let place = |time_ms: f64| (time_ms / SAMPLE_MS).round() as usize;
    (0..BEATS)
        .map(|beat| {
            let stimulus_ms = START_MS + f64::from(beat) * cycle_ms;
            let (from, to) = (place(stimulus_ms), place(stimulus_ms + cycle_ms));
            let times = &course.time_ms[from..to];
            let (u, tension) = (&course.potential[from..to], &course.tension[from..to]);
            let peak = trace::peak(times, tension).ok_or("a beat has no tension")?;
            let top = trace::peak(times, u).ok_or("a beat has no potential")?;
            // The sample at the stimulus includes a jump; the one before is at rest.
            let rest = course.potential[from - 1];
            let level = top.value - 0.9 * (top.value - rest);
            let end = trace::falls_through(times, u, level, top.time).ok_or("no repolarisation")?;
            Ok([top.value, peak.value, peak.time, end - stimulus_ms])
        })
        .collect()
}

/// Largest distance from the converged beats; that of tension is relative.
fn differences(
    model: &MinimalModel,
    cycle_ms: f64,
    found: &[Numbers],
) -> Result<Numbers, Box<dyn Error>> {
    let mut worst = [0.0; 4];
    let own = format!("{},{cycle_ms},", model.name());
    let rows = include_str!("../../crates/myospring/tests/reference/cell_converged.csv");
    for row in rows.lines().filter_map(|line| line.strip_prefix(&own)) {
        let numbers: Vec<f64> = row.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let &[beat, u, tension, time_ms, apd90_ms] = &numbers[..] else { return Err(row.into()) };
        let measured = found.get(beat as usize).ok_or("a beat is missing")?;
        let [u_found, tension_found, time_found_ms, apd90_found_ms] = *measured;
        grow(
            &mut worst,
            &[
                (u_found - u).abs(),
                (tension_found / tension - 1.0).abs(),
                (time_found_ms - time_ms).abs(),
                (apd90_found_ms - apd90_ms).abs(),
            ],
        );
    }
    Ok(worst)
}

fn grow(worst: &mut Numbers, found: &Numbers) {
    for (worst, found) in worst.iter_mut().zip(found) {
        *worst = worst.max(*found);
    }
}

fn print(way: &str, set: &str, [u, tension, time_ms, apd90_ms]: Numbers) {
    let line = serde_json::json!({
        "steps": way,
        "set": set,
        "peak_u": u,
        "peak_tension_percent": 100.0 * tension,
        "peak_tension_ms": time_ms,
        "apd90_ms": apd90_ms,
    });
    println!("{line}");
}
