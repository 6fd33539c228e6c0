//! How many beats of ToR-ORd are computed per second of processor time, and how accurate they are.
//!
//! Prints two JSON lines for each tolerance: one endocardial cell at 1 Hz, and 1000 of them with other conductances, one
//! beat each, side by side and sampled each ms. Errors are those of the one cell: a lane takes its steps. `verification/peers/bench_tor_ord.py` lays Myokit beside it.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example tor_ord_throughput
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::cell::CellModel;
use myospring::cell::batch::{self, BatchSettings, Paced};
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolveError, SolverSettings};
use myospring::cell::tomek_2019::{Layer, TomekModel, Variant, parameters};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const CYCLE_MS: f64 = 1000.0;
const BEATS: u32 = 20;
const CELLS: u32 = 1000;
/// Between samples of a population, ms.
const SAMPLED_MS: f64 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let endo: Arc<dyn CellModel> = Arc::new(TomekModel::published(Layer::Endo, Variant::Published));
    let exact = last_beat(&endo, 1e-8)?;
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let [apd90, calcium] = last_beat(&endo, tolerance)?;
        let errors = [(apd90 - exact[0]).abs(), 100.0 * (calcium / exact[1] - 1.0).abs()];
        let start = now();
        paced(&endo, tolerance, BEATS)?.advance_to(CYCLE_MS * f64::from(BEATS), 1.0, 0.0)?;
        report("one cell", tolerance, f64::from(BEATS) / (now() - start), errors);
        let cells = population()?;
        let method = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
        let settings = BatchSettings { method, sample_interval_ms: Some(SAMPLED_MS) };
        let start = now();
        for outcome in batch::run(&cells, &settings)? {
            outcome?;
        }
        let rate = f64::from(CELLS) / (now() - start);
        report("1000 cells of a population", tolerance, rate, errors);
    }
    Ok(())
}

fn report(name: &str, tolerance: f64, rate: f64, [apd90, calcium]: [f64; 2]) {
    println!(
        "{{\"name\": \"{name}\", \"tolerance\": {tolerance:e}, \"cbps_cpu\": {rate:.2}, \
         \"apd90_error_ms\": {apd90:.3e}, \"calcium_error_percent\": {calcium:.3e}}}"
    );
}

fn paced(
    model: &Arc<dyn CellModel>,
    tolerance: f64,
    beats: u32,
) -> Result<CellIntegrator, SolveError> {
    let stimulus = model.default_stimulus();
    let protocol =
        Protocol { start_ms: 0.0, cycle_length_ms: CYCLE_MS, beats, ..Protocol::once(stimulus) };
    let settings = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
    CellIntegrator::new(Arc::clone(model), protocol, settings)
}

/// APD90 of the last beat from its stimulus, ms, and its largest calcium, mM.
fn last_beat(model: &Arc<dyn CellModel>, tolerance: f64) -> Result<[f64; 2], SolveError> {
    const EACH_MS: f64 = 0.05;
    let mut cell = paced(model, tolerance, BEATS)?;
    let start = CYCLE_MS * f64::from(BEATS - 1);
    cell.advance_to(start, 1.0, 0.0)?;
    let (mut v, mut calcium) = (Vec::new(), 0.0_f64);
    for sample in 0..(CYCLE_MS / EACH_MS) as u32 {
        cell.advance_to(start + EACH_MS * f64::from(sample), 1.0, 0.0)?;
        v.push(cell.state()[0]);
        calcium = calcium.max(cell.state()[5]);
    }
    let peak = v.iter().copied().fold(f64::MIN, f64::max);
    let level = peak - 0.9 * (peak - v[0]);
    let last = v.iter().rposition(|value| *value > level).unwrap_or(0);
    let part = (v[last] - level) / (v[last] - v[last + 1]);
    Ok([EACH_MS * (last as f64 + part), calcium])
}

/// Conductances between 80 and 120 % of the published ones.
fn population() -> Result<Vec<Paced>, Box<dyn Error>> {
    const CHANGED: [(&str, f64); 4] = [
        ("P_Ca", 0.618_033_988_7),
        ("G_Kr", 0.754_877_666_2),
        ("G_Ks", 0.819_172_5),
        ("G_K1", 0.856_7),
    ];
    let cell = |index: u32| {
        let mut set = parameters(Layer::Endo, Variant::Published);
        for (name, golden) in CHANGED {
            let factor = 0.8 + 0.4 * (f64::from(index) * golden).fract();
            let value = factor * set.get(name).unwrap_or(f64::NAN);
            set.set(name, value)?;
        }
        let model = TomekModel::new(Layer::Endo, Variant::Published, set)?;
        let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
        Ok(Paced::new(Arc::new(model), protocol, CYCLE_MS)?)
    };
    (0..CELLS).map(cell).collect()
}

/// Seconds of processor time of this process, where the system tells; else of the wall.
fn now() -> f64 {
    let Ok(stat) = std::fs::read_to_string("/proc/self/schedstat") else {
        static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
        return START.get_or_init(Instant::now).elapsed().as_secs_f64();
    };
    let nanoseconds = stat.split_whitespace().next().and_then(|field| field.parse::<f64>().ok());
    nanoseconds.unwrap_or(f64::NAN) * 1e-9
}
