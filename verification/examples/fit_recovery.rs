//! How well fits find what a synthetic curve was made with: the table in `docs/reference/accuracy.md`.
//!
//! `cargo run --release -p myospring-verification --example fit_recovery -- [CELLS]`: 200 cells for each row unless told otherwise.

#![allow(clippy::print_stdout, reason = "a table for people")]

use myospring::fit::{FitSettings, Fitter, Observed, Scale, Stimuli, Unknown, Verdict};
use myospring::run_file::RunFile;
use myospring::study::sampling::{Distribution, Sampler, sample};
use rayon::prelude::*;
use std::error::Error;
use std::time::Instant;

/// Resting length, um, and frames of a curve of 650 ms.
const LENGTH: f64 = 100.0;
const LASTS_MS: f64 = 648.0;
/// An answer is recovered if every number is so many standard deviations from the truth or nearer; standard deviations
/// are those of the interval, on the truth's side of the answer.
const RECOVERED: f64 = 5.0;
/// Standard deviations from the middle of a 95 % interval to its ends.
const NORMAL: f64 = 1.96;
/// Factors on the published parameters.
const TRUTHS: [(&str, [f64; 2]); 2] = [("as published", [1.0, 1.0]), ("within 25 %", [0.8, 1.25])];

fn main() -> Result<(), Box<dyn Error>> {
    let cells: usize = std::env::args().nth(1).map_or(Ok(200), |text| text.parse())?;
    // A coarse mesh shortens by its tension as smoothly as a fine one.
    let run = RunFile::from_text("shape.spacing = \"5 um\"")?.resolve()?;
    let fitter = Fitter::of(&run, |path| std::fs::read(path))?;
    println!("{cells} cells in each row, {LENGTH} um long, {LASTS_MS} ms, 8 starts");
    println!(
        "| truth | free | frames/s | noise, um | recovered | missed | not determined | median standard deviations, % \
         (delay: ms) | error over them | coverage of 95 %, % | curves | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for truth in TRUTHS {
        for free in [&["c_0"][..], &["c_0", "x_3"], &["c_0", "x_3", "sigma"]] {
            for (rate, noise) in [(250.0, 0.1), (250.0, 0.3), (50.0, 0.1), (50.0, 0.3)] {
                row(&fitter, truth, free, rate, noise, cells)?;
            }
        }
    }
    Ok(())
}

/// A number of one cell.
struct Number {
    /// How far it is off, over the standard deviation that its interval states.
    off: f64,
    /// Standard deviation by Fisher's information, % or ms.
    deviation: f64,
    covered: bool,
    determined: bool,
}

/// One cell.
struct Found {
    numbers: Vec<Number>,
    /// Whether the truth follows the curve better than the answer.
    missed: bool,
    evaluations: usize,
}

/// Fits a cell whose factors and delay are given, from its curve with this noise.
fn found(
    fitter: &Fitter,
    settings: &FitSettings,
    names: &[&str],
    times_ms: &[f64],
    [truth, noises]: [&[f64]; 2],
) -> Option<Found> {
    let (factors, delay) = (&truth[..names.len()], truth[names.len()]);
    let factors: Vec<(&str, f64)> = names.iter().copied().zip(factors.iter().copied()).collect();
    let shifted: Vec<f64> = times_ms.iter().map(|time| time - delay).collect();
    let mut values = fitter.curve(&factors, LENGTH, &shifted).ok()?;
    for (value, noise) in values.iter_mut().zip(noises) {
        *value += noise;
    }
    let observed = Observed {
        name: "synthetic".to_owned(),
        times_ms: times_ms.to_vec(),
        values,
        scale: Scale::Length,
        unit: "um".to_owned(),
        stimuli: Stimuli::Given(vec![50.0]),
    };
    let fit = fitter.fit(&[observed], settings, &|_| true).ok()??;
    let usual = |name: &str| match name {
        "tension_over_stiffness" => fitter.tension_over_stiffness(),
        name => fitter.simulation().cell.parameters().get(name).unwrap_or(f64::NAN),
    };
    let mut truths: Vec<(&str, f64)> =
        factors.iter().map(|(name, factor)| (*name, factor * usual(name))).collect();
    truths.push(("delay", delay));
    truths.push(("resting_length", LENGTH));
    let number = |(name, truth): &(&str, f64)| {
        let estimate = fit.estimate(name)?;
        let relative = if *name == "delay" { 1.0 } else { 100.0 / truth };
        let [low, high] = estimate.interval;
        let covered = low.is_none_or(|low| low <= *truth) && high.is_none_or(|high| *truth <= high);
        let error = truth - estimate.value;
        let end = if error < 0.0 { low } else { high };
        // Where the curve sets no end, nothing there is far off.
        let off = end.map_or(0.0, |end| NORMAL * error / (end - estimate.value).abs());
        Some(Number {
            off,
            deviation: relative * estimate.standard_deviation?,
            covered,
            determined: estimate.verdict == Verdict::Determined,
        })
    };
    let numbers = truths.iter().map(number).collect::<Option<Vec<_>>>()?;
    let curve = &fit.curves[0];
    let clean = fitter.curve(&factors, LENGTH, &shifted).ok()?;
    let left = |made: &[f64]| -> f64 {
        let frames = curve.measured.iter().zip(made).zip(&curve.used);
        frames.filter(|(_, used)| **used).map(|((a, b), _)| (a - b).powi(2)).sum()
    };
    let missed = left(&curve.fitted) > left(&clean);
    Some(Found { numbers, missed, evaluations: fit.evaluations })
}

fn row(
    fitter: &Fitter,
    (title, [low, high]): (&str, [f64; 2]),
    free: &[&str],
    rate: f64,
    noise: f64,
    cells: usize,
) -> Result<(), Box<dyn Error>> {
    let names: Vec<&str> = ["tension_over_stiffness"].iter().chain(free).copied().collect();
    // Factors, the delay, and the seed of the noise.
    // As published within a millionth.
    let high = high.max(low * (1.0 + 1e-6));
    let mut distributions = vec![Distribution::LogUniform { low, high }; names.len()];
    distributions.push(Distribution::Uniform { low: -20.0, high: 20.0 });
    let design = sample(&Sampler::LatinHypercube { size: cells }, &distributions, 7)?;
    let frames = (LASTS_MS * rate / 1000.0) as u32;
    let times_ms: Vec<f64> = (0..=frames).map(|frame| f64::from(frame) * 1000.0 / rate).collect();
    let noises = sample(
        &Sampler::LatinHypercube { size: cells },
        &vec![Distribution::Normal { mean: 0.0, standard_deviation: noise }; times_ms.len()],
        11,
    )?;
    let begun = Instant::now();
    let settings = FitSettings {
        free: Some(names.iter().map(|name| Unknown::named(name)).collect()),
        ..FitSettings::default()
    };
    let found: Vec<Option<Found>> = (0..cells)
        .into_par_iter()
        .map(|cell| {
            found(fitter, &settings, &names, &times_ms, [&design.row(cell)?, &noises.row(cell)?])
        })
        .collect();
    let took = begun.elapsed().as_secs_f64() * 1000.0 / cells as f64;
    let sound: Vec<&Found> = found
        .iter()
        .flatten()
        .filter(|found| found.numbers.iter().all(|number| number.off.abs() < RECOVERED))
        .collect();
    let columns = sound.first().map_or(0, |found| found.numbers.len());
    let count = sound.len() as f64;
    let each = |of: &dyn Fn(&Number) -> f64| -> Vec<f64> {
        (0..columns)
            .map(|at| sound.iter().map(|found| of(&found.numbers[at])).sum::<f64>() / count)
            .collect()
    };
    let text = |values: Vec<f64>, digits: usize| {
        values.iter().map(|value| format!("{value:.digits$}")).collect::<Vec<_>>().join(", ")
    };
    // The middle one: x_3 hardly shows in the fastest cells.
    let deviations = (0..columns)
        .map(|at| {
            let mut all: Vec<f64> = sound.iter().map(|found| found.numbers[at].deviation).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        })
        .collect();
    let errors = each(&|number| number.off * number.off).into_iter().map(f64::sqrt).collect();
    // Of all cells: one that was not recovered is not covered.
    let coverage: Vec<f64> = (0..columns)
        .map(|at| {
            let inside = |found: &Option<Found>| {
                found.as_ref().is_some_and(|found| found.numbers[at].covered)
            };
            100.0 * found.iter().filter(|found| inside(found)).count() as f64 / cells as f64
        })
        .collect();
    let count_of = |of: &dyn Fn(&Found) -> bool| found.iter().flatten().filter(|it| of(it)).count();
    let evaluations = sound.iter().map(|found| found.evaluations).sum::<usize>() as f64 / count;
    println!(
        "| {title} | {} | {rate} | {noise} | {} of {cells} | {} | {} | {} | {} | {} | {evaluations:.0} | {took:.0} |",
        free.join(", "),
        sound.len(),
        count_of(&|found| found.missed),
        count_of(&|found| found.numbers.iter().any(|number| !number.determined)),
        text(deviations, 3),
        text(errors, 2),
        text(coverage, 0),
    );
    Ok(())
}
