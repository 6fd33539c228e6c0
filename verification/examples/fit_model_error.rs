//! How far the intervals of a fit hold where its model is not quite that of the cell: the table in
//! `docs/reference/accuracy.md`.
//!
//! `cargo run --release -p myospring-verification --example fit_model_error -- [CELLS]`: 60 cells for each row unless told otherwise.

#![allow(clippy::print_stdout, reason = "a table for people")]

use myospring::fit::{Fit, FitSettings, FitVerdict, Fitter, Observed, Scale, Stimuli};
use myospring::run_file::RunFile;
use myospring::study::sampling::{Distribution, Sampler, sample};
use rayon::prelude::*;
use std::error::Error;

/// Resting length, um, and frames of a curve of 650 ms.
const LENGTH: f64 = 100.0;
const LASTS_MS: f64 = 648.0;

/// How a cell differs from the model that is fitted to it, which holds all but tension over stiffness and `c_0`.
enum Differs {
    /// Parameters by these factors.
    By(&'static [(&'static str, f64)]),
    /// Viscous, with this retardation time, ms.
    Viscous(f64),
    /// The curve has a wave of this part of its height on top, two periods long.
    Wave(f64),
}

fn fitter(more: &str) -> Result<Fitter, Box<dyn Error>> {
    let run = RunFile::from_text(&format!("shape.spacing = \"7 um\"\n{more}"))?.resolve()?;
    Ok(Fitter::of(&run, |path| std::fs::read(path))?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let cells: usize = std::env::args().nth(1).map_or(Ok(60), |text| text.parse())?;
    let model = fitter("")?;
    println!(
        "| the cell has | frames/s | noise, um | unexplained, % | fits, nearly, not | frames that count as one | coverage of 95 %, % | without counting the misfit | middle error over the stated standard deviation |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let errors = [
        ("the model's parameters", Differs::By(&[])),
        ("`sigma` + 5 %", Differs::By(&[("sigma", 1.05)])),
        ("`sigma` + 10 %", Differs::By(&[("sigma", 1.1)])),
        ("`sigma` + 20 %", Differs::By(&[("sigma", 1.2)])),
        ("`sigma` + 40 %", Differs::By(&[("sigma", 1.4)])),
        ("`sigma` + 80 %", Differs::By(&[("sigma", 1.8)])),
        ("`x_3` + 10 %", Differs::By(&[("x_3", 1.1)])),
        ("`x_3` + 20 %", Differs::By(&[("x_3", 1.2)])),
        ("retardation of 2 ms", Differs::Viscous(2.0)),
        ("retardation of 5 ms", Differs::Viscous(5.0)),
        ("retardation of 10 ms", Differs::Viscous(10.0)),
        ("retardation of 20 ms", Differs::Viscous(20.0)),
        ("retardation of 40 ms", Differs::Viscous(40.0)),
        ("a wave of 1 %", Differs::Wave(0.01)),
        ("a wave of 3 %", Differs::Wave(0.03)),
        ("a wave of 5.5 %", Differs::Wave(0.055)),
        ("a wave of 10 %", Differs::Wave(0.1)),
    ];
    for (title, differs) in &errors {
        let viscous = match differs {
            Differs::Viscous(time) => Some(fitter(&format!(
                "[material]\nretardation_time = \"{time} ms\"\n[numerics]\nintegrator = \"quasi-static\"\n"
            ))?),
            _ => None,
        };
        for (rate, noise) in [(250.0, 0.01), (250.0, 0.1), (50.0, 0.1)] {
            row(&model, viscous.as_ref().unwrap_or(&model), title, differs, [rate, noise], cells)?;
        }
    }
    Ok(())
}

/// Whether the intervals of a fit hold the truth, and whether they did without counting the misfit; errors over the
/// stated standard deviations; the fit.
type Found = ([bool; 8], [f64; 4], Fit);

/// Fits the model to the curve of a cell whose factors and delay are given, with this noise.
fn found(
    [model, cell]: [&Fitter; 2],
    differs: &Differs,
    times_ms: &[f64],
    [truth, noises]: [&[f64]; 2],
) -> Option<Found> {
    let mut factors = vec![("tension_over_stiffness", truth[0]), ("c_0", truth[1])];
    if let Differs::By(others) = differs {
        factors.extend_from_slice(others);
    }
    let shifted: Vec<f64> = times_ms.iter().map(|time| time - truth[2]).collect();
    let mut values = cell.curve(&factors, LENGTH, &shifted).ok()?;
    let height = LENGTH - values.iter().copied().fold(LENGTH, f64::min);
    for ((value, noise), time) in values.iter_mut().zip(noises).zip(times_ms) {
        let wave = match differs {
            Differs::Wave(part) => part * (std::f64::consts::TAU * 2.0 * time / LASTS_MS).sin(),
            _ => 0.0,
        };
        *value += noise + height * wave;
    }
    let observed = Observed {
        name: "cell".to_owned(),
        times_ms: times_ms.to_vec(),
        values,
        scale: Scale::Length,
        unit: "um".to_owned(),
        stimuli: Stimuli::Given(vec![50.0]),
    };
    let fit = model.fit(&[observed], &FitSettings::default(), &|_| true).ok()??;
    let rate = model.simulation().cell.parameters().get("c_0").unwrap_or(f64::NAN);
    let truths = [truth[0] * model.tension_over_stiffness(), truth[1] * rate, truth[2], LENGTH];
    let mut covered = [false; 8];
    let mut off = [0.0; 4];
    let wider = (fit.variance_factor * fit.rise_at_ends / 3.84).sqrt();
    for (place, (estimate, truth)) in fit.estimates.iter().zip(truths).enumerate() {
        let [low, high] = estimate.interval;
        let within = |low: Option<f64>, high: Option<f64>| {
            low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high)
        };
        covered[place] = within(low, high);
        let end = if truth < estimate.value { low } else { high };
        off[place] =
            end.map_or(0.0, |end| 1.96 * ((truth - estimate.value) / (end - estimate.value)).abs());
        let nearer = |end: Option<f64>| Some(estimate.value + (end? - estimate.value) / wider);
        covered[4 + place] = within(nearer(low), nearer(high));
    }
    Some((covered, off, fit))
}

fn row(
    model: &Fitter,
    cell: &Fitter,
    title: &str,
    differs: &Differs,
    [rate, noise]: [f64; 2],
    cells: usize,
) -> Result<(), Box<dyn Error>> {
    let factor = Distribution::LogUniform { low: 0.8, high: 1.25 };
    let delay = Distribution::Uniform { low: -20.0, high: 20.0 };
    let design = sample(&Sampler::LatinHypercube { size: cells }, &[factor, factor, delay], 7)?;
    let frames = (LASTS_MS * rate / 1000.0) as u32;
    let times_ms: Vec<f64> = (0..=frames).map(|frame| f64::from(frame) * 1000.0 / rate).collect();
    let normal = Distribution::Normal { mean: 0.0, standard_deviation: noise };
    let noises =
        sample(&Sampler::LatinHypercube { size: cells }, &vec![normal; times_ms.len()], 11)?;
    let found: Vec<Found> = (0..cells)
        .into_par_iter()
        .filter_map(|number| {
            let made = [&design.row(number)?[..], &noises.row(number)?];
            found([model, cell], differs, &times_ms, made)
        })
        .collect();
    let with = |verdict| found.iter().filter(|(.., fit)| fit.verdict == verdict).count();
    let middle = |of: &dyn Fn(&Fit) -> f64| {
        let mut all: Vec<f64> = found.iter().map(|(.., fit)| of(fit)).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let stated: Vec<&[bool; 8]> = found
        .iter()
        .filter(|(.., fit)| fit.verdict != FitVerdict::DoesNotFit)
        .map(|(covered, ..)| covered)
        .collect();
    let coverage = |places: std::ops::Range<usize>| {
        let part = |place: usize| {
            let inside = stated.iter().filter(|covered| covered[place]).count();
            format!("{:.0}", 100.0 * inside as f64 / stated.len() as f64)
        };
        if stated.is_empty() {
            "-".to_owned()
        } else {
            places.map(part).collect::<Vec<_>>().join(", ")
        }
    };
    let errors: Vec<String> = (0..4)
        .map(|place| {
            let mut all: Vec<f64> = found.iter().map(|(_, off, _)| off[place]).collect();
            all.sort_by(f64::total_cmp);
            format!("{:.1}", all.get(all.len() / 2).copied().unwrap_or(f64::NAN))
        })
        .collect();
    println!(
        "| {title} | {rate} | {noise} | {:.3} | {}, {}, {} | {:.1} | {} | {} | {} |",
        100.0 * middle(&|fit| fit.curves[0].unexplained),
        with(FitVerdict::Fits),
        with(FitVerdict::FitsNearly),
        with(FitVerdict::DoesNotFit),
        middle(&|fit| fit.curves[0].frames_together),
        coverage(0..4),
        coverage(4..8),
        errors.join(", "),
    );
    Ok(())
}
