//! How many beats of a cell are computed per second on one thread, and how accurate they are.
//!
//! Prints one JSON line for each of: one cell at a time, a population of cells with their own parameters, and a study
//! of such cells from its description to its table; the epicardial set with tension and the paper's cell. Pacing at
//! 1 Hz, tolerance 1e-5.
//! `cbps` are cell-beats per second of wall time, `cbps_cpu` per second of this thread's processor time
//! (Linux), each the median of three runs. `tension_error_percent` and `apd90_error_ms` are the
//! largest over the first five beats of the published set in the same runs, against the converged
//! solution of another program (`crates/myospring/tests/reference/cell_converged.py`).
//!
//! ```sh
//! cargo run --release -p myospring-verification --example cell_throughput
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::cell::adaptive::{self, beats};
use myospring::cell::batch::{self, BatchSettings, CellBeat, Paced};
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::{Identity, MinimalModel};
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{CellModel, coelho_2021};
use myospring::interruption::Interruption;
use myospring::output::table::Table;
use myospring::parameter::ParameterSet;
use myospring::study::parameters::{Answer, Common, ParameterStudy, Shard};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const CYCLE_MS: f64 = 1000.0;
/// Of a study.
const MEMBERS: usize = 1024;

fn main() -> Result<(), Box<dyn Error>> {
    let epi = Variant::Epi;
    let sets = [
        (bueno_orovio_2008::identity(epi), bueno_orovio_2008::parameters(epi)),
        (coelho_2021::IDENTITY, coelho_2021::parameters()),
    ];
    for (identity, parameters) in &sets {
        let model = MinimalModel::new(*identity, parameters.clone())?;
        let (protocol, duration_ms) = train(&model, 2000);
        report("one cell", &model, 2000, || {
            Ok(beats(&model, protocol, adaptive::AdaptiveSettings::default(), duration_ms)?)
        })?;
    }
    for (identity, parameters) in &sets {
        let model = MinimalModel::new(*identity, parameters.clone())?;
        let cells = population(*identity, parameters)?;
        let method = SolverSettings::of(CellMethod::Adaptive);
        let settings = BatchSettings { method, sample_interval_ms: None };
        report("population", &model, 20 * cells.len(), || {
            let outcomes = batch::run(&cells, &settings)?;
            Ok(outcomes.into_iter().next().ok_or("no cell")??.beats)
        })?;
    }
    for (identity, parameters) in &sets {
        let model = MinimalModel::new(*identity, parameters.clone())?;
        let (protocol, duration_ms) = train(&model, 5);
        // The published set, by the integrator of all.
        let published =
            beats(&model, protocol, adaptive::AdaptiveSettings::default(), duration_ms)?;
        report("study", &model, 20 * MEMBERS, || {
            study(model.name())?;
            Ok(published.clone())
        })?;
    }
    Ok(())
}

/// Beats at 1 Hz from 50 ms on, and how long they take.
fn train(model: &MinimalModel, beats: u32) -> (Protocol, f64) {
    let protocol =
        Protocol { cycle_length_ms: CYCLE_MS, beats, ..Protocol::once(model.default_stimulus()) };
    (protocol, protocol.start_ms + f64::from(beats) * CYCLE_MS)
}

/// 512 cells, 20 beats each: the set itself first, then `tau_si` and `tau_so1` between 80 and 120 %.
fn population(identity: Identity, parameters: &ParameterSet) -> Result<Vec<Paced>, Box<dyn Error>> {
    let mut cells = Vec::new();
    for index in 0..512_u32 {
        let mut own = parameters.clone();
        for (name, golden) in [("tau_si", 0.618_033_988_7), ("tau_so1", 0.754_877_666_2)] {
            let factor =
                if index == 0 { 1.0 } else { 0.8 + 0.4 * (f64::from(index) * golden).fract() };
            let value = parameters.get(name).ok_or("no such parameter")?;
            own.set(name, factor * value)?;
        }
        let model = MinimalModel::new(identity, own)?;
        let (protocol, duration_ms) = train(&model, 20);
        cells.push(Paced::new(Arc::new(model), protocol, duration_ms)?);
    }
    Ok(cells)
}

/// As the population, sampled, and all the way to the columns of a table.
fn study(model: &str) -> Result<Table, Box<dyn Error>> {
    let description = format!(
        r#"
        kind = "cell"
        run = {{ cell = {{ model = "{model}" }}, stimulus = {{ beats = 20 }} }}
        [parameters]
        tau_si = {{ distribution = "uniform", low = 0.8, high = 1.2, relative = true }}
        tau_so1 = {{ distribution = "uniform", low = 0.8, high = 1.2, relative = true }}
        [sampling]
        sampler = "latin-hypercube"
        size = {MEMBERS}
        "#
    );
    let no_file = |_file: &str| Err(std::io::ErrorKind::NotFound.into());
    let study = ParameterStudy::from_toml(&description, no_file)?;
    let common = Common::new(&study, no_file)?;
    // This thread and no other, whose time is measured.
    let rows = study.members(Shard::WHOLE);
    let groups = rows.chunks(64).map(|group| group.iter().collect::<Vec<_>>());
    let rows = groups.flat_map(|group| common.rows(&group, &Interruption::default()));
    let rows = rows.collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    Ok(Answer::new(&study, &common.units, rows).table())
}

/// Times `work` three times and prints the line; `work` gives the beats of the published set.
fn report(
    kind: &str,
    model: &MinimalModel,
    cell_beats: usize,
    work: impl Fn() -> Result<Vec<CellBeat>, Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let (mut wall, mut processor, mut beats) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..3 {
        let (start, start_cpu) = (Instant::now(), processor_seconds());
        beats = work()?;
        wall.push(start.elapsed().as_secs_f64());
        processor.extend(processor_seconds().zip(start_cpu).map(|(end, start)| end - start));
    }
    let rate = |mut seconds: Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        seconds.get(1).map(|median| (cell_beats as f64 / median).round())
    };
    let (tension, apd) = errors(model.name(), &beats)?;
    let line = serde_json::json!({
        "peer": format!("myospring {kind}: {}", model.name()),
        "version": env!("CARGO_PKG_VERSION"),
        "beats": cell_beats,
        "states": 6,
        "tolerance": adaptive::AdaptiveSettings::default().tolerance,
        "cbps": rate(wall),
        "cbps_cpu": rate(processor),
        "tension_error_percent": tension,
        "apd90_error_ms": apd,
    });
    println!("{line}");
    Ok(())
}

/// Largest errors of the first five beats: peak tension, per cent, and APD90, ms.
fn errors(model: &str, beats: &[CellBeat]) -> Result<(f64, f64), Box<dyn Error>> {
    let (mut tension, mut apd) = (0.0_f64, 0.0_f64);
    let rows = include_str!("../../crates/myospring/tests/reference/cell_converged.csv");
    let own = format!("{model},{CYCLE_MS},");
    for row in rows.lines().filter_map(|line| line.strip_prefix(&own)) {
        let numbers: Vec<f64> = row.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let &[beat, _, peak_tension, _, apd90_ms] = &numbers[..] else { return Err(row.into()) };
        let measured = beats.get(beat as usize).ok_or("a beat is missing")?;
        let measured_apd = measured.apd90_ms.ok_or("a beat does not repolarise")?;
        tension = tension.max(100.0 * (measured.peak_tension / peak_tension - 1.0).abs());
        apd = apd.max((measured_apd - apd90_ms).abs());
    }
    Ok((tension, apd))
}

/// Processor time of this thread, s, where the system tells it without a library.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}
