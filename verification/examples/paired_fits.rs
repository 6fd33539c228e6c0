//! How well fits find the myofilaments of a cell whose calcium was recorded together with its length, as a table.
//!
//! Cells of `land_2017` with random `k_ws` and tension over stiffness (within 30 % of the run's), driven by made-up calcium that is slower
//! than the model's own and differs from beat to beat. Length and calcium are sampled with noise, a part of a beat's height, and fitted
//! with and without the recorded calcium.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example paired_fits -- [CELLS]
//! ```

#![allow(clippy::print_stdout, reason = "it prints a table")]

use myospring::cell::calcium::CalciumTrace;
use myospring::experiment::BeatOptions;
use myospring::experiment::fit::{FittableCell, Models, RecordedCalcium};
use myospring::fit::{Fit, FitOptions, FitVerdict, Fitter};
use myospring::measured::{Curve, Kind};
use myospring::run_file::RunFile;
use myospring::simulation::Simulation;
use myospring::study::Threads;
use myospring_verification::random::Random;
use std::error::Error;
use std::time::Instant;

/// Length of a recording, ms, and interval between beats.
const LENGTH_MS: f64 = 5200.0;
const PERIOD_MS: f64 = 1000.0;
/// The first beat.
const FIRST_MS: f64 = 300.0;
/// The run stimulates here.
const STIMULUS_MS: f64 = 50.0;
const NAMES: [&str; 2] = ["k_ws", "tension_over_stiffness"];

/// Calcium, uM: two exponentials, higher in every other beat.
fn calcium(t: f64) -> f64 {
    let (rise, fall) = (45.0, 190.0);
    let of = |s: f64| (-s / fall).exp() - (-s / rise).exp();
    let top = rise * fall / (fall - rise) * f64::ln(fall / rise);
    let beat = |number: u32| {
        let since = t - FIRST_MS - PERIOD_MS * f64::from(number);
        let height = if number.is_multiple_of(2) { 0.55 } else { 0.48 };
        if since > 0.0 { height * of(since) / of(top) } else { 0.0 }
    };
    0.09 + (0..5).map(beat).sum::<f64>()
}

fn curve(kind: Kind, unit: &'static str, times_ms: Vec<f64>, values: Vec<f64>) -> Curve {
    let (lines, stimuli_ms) = (vec![0; values.len()], Vec::new());
    Curve { name: kind.word().to_owned(), kind, unit, times_ms, values, lines, stimuli_ms }
}

/// A cell and its recording.
struct Cell {
    truths: [f64; 2],
    length: Curve,
    calcium: Curve,
}

impl Cell {
    fn of(truth: &Fitter, [rate, noise_pct]: [f64; 2], seed: u64) -> Result<Self, Box<dyn Error>> {
        let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let factors = [0, 1].map(|_| 1.3_f64.powf(2.0 * random.uniform() - 1.0));
        let step = 1e3 / rate;
        let frames = (LENGTH_MS / step) as usize;
        let times: Vec<f64> = (0..frames).map(|at| step * at as f64).collect();
        let named: Vec<(&str, f64)> = NAMES.into_iter().zip(factors).collect();
        let on_clock: Vec<f64> = times.iter().map(|time| STIMULUS_MS + time).collect();
        let mut length = truth.curve(&named, 110.0, &on_clock)?;
        let low = length.iter().copied().fold(f64::INFINITY, f64::min);
        let noise = 0.01 * noise_pct;
        for value in &mut length {
            *value += noise * (110.0 - low) * random.normal();
        }
        let ca = times.iter().map(|time| calcium(*time) + noise * 0.5 * random.normal()).collect();
        let usual = [
            truth.simulation().cell.parameters().get("k_ws").unwrap_or(f64::NAN),
            truth.tension_over_stiffness(),
        ];
        Ok(Self {
            truths: [usual[0] * factors[0], usual[1] * factors[1]],
            length: curve(Kind::Length, "um", times.clone(), length),
            calcium: curve(Kind::Calcium, "uM", times, ca),
        })
    }

    fn fit(&self, text: &str, with_calcium: bool) -> Result<Fit, Box<dyn Error>> {
        let read = |path: &str| std::fs::read(path);
        let run = RunFile::from_text(text)?.resolve()?;
        let made = run.make(run.shape.mesh(&run.shape.bytes(read)?)?, read)?;
        let curves = [("length".to_owned(), Ok(self.length.clone()))];
        let beats = BeatOptions::default();
        let own = if with_calcium { vec![self.calcium.clone()] } else { Vec::new() };
        let (driving, notes) = RecordedCalcium::default().among(&own, &curves, &beats)?;
        if with_calcium && driving.is_none() {
            return Err(notes.join("; ").into());
        }
        let options = FitOptions { starts: 4, ..FitOptions::default() };
        let own = (beats, Vec::new(), driving);
        let cell = FittableCell::new(run, made, Models::OfRun, &options, own)?;
        let mut found = cell.fit(&curves, &[], &Threads::new(None)?, &())?;
        Ok(found.remove(0).found?)
    }
}

fn row(
    [rate, noise]: [f64; 2],
    (cells, with_calcium): (u64, bool),
    (truth, text): (&Fitter, &str),
) -> Result<(), Box<dyn Error>> {
    let (mut errors, mut covered) = ([const { Vec::new() }; 2], [0; 2]);
    let (mut follows, mut misfit, mut spread) = (0, 0.0_f64, [0.0; 2]);
    let begun = Instant::now();
    for seed in 1..=cells {
        let cell = Cell::of(truth, [rate, noise], seed)?;
        let fit = cell.fit(text, with_calcium)?;
        follows += u64::from(fit.verdict != FitVerdict::DoesNotFit);
        misfit += 100.0 * fit.curves[0].misfit / fit.curves[0].height() / cells as f64;
        for (at, name) in NAMES.into_iter().enumerate() {
            let estimate = fit.estimate(name).ok_or("no estimate")?;
            let truth = cell.truths[at];
            errors[at].push(100.0 * (estimate.value / truth - 1.0));
            let [low, high] = estimate.interval;
            covered[at] += u64::from(
                low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high),
            );
            if let [Some(low), Some(high)] = estimate.interval {
                spread[at] += 100.0 * (high - low) / 3.92 / truth / cells as f64;
            }
        }
    }
    let ms = 1e3 * begun.elapsed().as_secs_f64() / cells as f64;
    let of = |at: usize| {
        let count = errors[at].len() as f64;
        let mean = errors[at].iter().sum::<f64>() / count;
        let squares = errors[at].iter().map(|error: &f64| (error - mean).powi(2)).sum::<f64>();
        let deviation = (squares / (count - 1.0)).sqrt();
        let inside = 100 * covered[at] / cells;
        format!("{mean:+.1} ({deviation:.1}) | {:.1} | {inside} %", spread[at])
    };
    let calcium = if with_calcium { "recorded" } else { "the model's" };
    println!(
        "| {calcium} | {rate} | {noise} % | {follows} of {cells} | {misfit:.1} % | {} | {} | {ms:.0} |",
        of(0),
        of(1)
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let cells: u64 = std::env::args().nth(1).map_or(Ok(40), |text| text.parse())?;
    // A coarse mesh shortens by its tension as smoothly as a fine one.
    let text = "cell.model = \"land_2017\"\nshape.spacing = \"5 um\"\nnumerics.integrator = \"quasi-static\"";
    let run = RunFile::from_text(text)?.resolve()?;
    let usual = Fitter::of(&run, |path| std::fs::read(path))?;
    let fine: Vec<f64> = (0..5500).map(f64::from).collect();
    let values: Vec<f64> = fine.iter().map(|time| calcium(*time)).collect();
    let trace = CalciumTrace::new(&fine, &values)?;
    let cell = usual.simulation().cell.with_calcium(&trace).ok_or("takes no calcium")?;
    let truth = Fitter::new(Simulation { cell, ..usual.simulation().clone() })?;
    println!(
        "| calcium | frames/s | noise | follows | off by | k_ws: bias (SD), % | SD stated, % | within 95 % | tension over stiffness: bias \
         (SD), % | SD stated, % | within 95 % | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for rate in [30.0, 100.0, 250.0] {
        for noise in [0.5, 2.0, 5.0] {
            row([rate, noise], (cells, true), (&truth, text))?;
        }
    }
    row([250.0, 0.5], (cells, false), (&truth, text))?;
    row([100.0, 2.0], (cells, false), (&truth, text))
}
