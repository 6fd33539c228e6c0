//! How well fits find what a synthetic curve was made with: the table in `docs/measured-beats.md`.
//!
//! `cargo run --release -p myospring --example fit_recovery -- [CELLS]`: 200 cells for each row unless told otherwise.

#![allow(clippy::print_stdout, reason = "a table for people")]

use myospring::fit::{Fitter, Observed, Scale, Settings, Stimuli, Unknown};
use myospring::run_file::RunFile;
use myospring::study::sampling::{Distribution, Sampler, sample};
use rayon::prelude::*;
use std::error::Error;
use std::time::Instant;

/// Resting length, um, and frames of a curve of 650 ms.
const LENGTH: f64 = 100.0;
const LASTS_MS: f64 = 648.0;
/// An answer is recovered if every number is so many standard deviations from the truth or nearer.
const RECOVERED: f64 = 5.0;

fn main() -> Result<(), Box<dyn Error>> {
    let cells: usize = std::env::args().nth(1).map_or(Ok(200), |text| text.parse())?;
    // A coarse mesh shortens by its tension as smoothly as a fine one.
    let run = RunFile::from_text("shape.spacing = \"5 um\"")?.resolve()?;
    let fitter = Fitter::of(&run, |path| std::fs::read(path))?;
    println!(
        "{cells} cells in each row, {LENGTH} um long, {LASTS_MS} ms, 8 starts; truth within 25 % of the published"
    );
    println!(
        "| free | frames/s | noise, um | recovered | median standard deviations, % (delay: ms) | error over them | coverage of 95 % | curves | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for free in [&["c_0"][..], &["c_0", "x_3"], &["c_0", "x_3", "sigma"]] {
        for (rate, noise) in [(250.0, 0.1), (250.0, 0.3), (50.0, 0.1), (50.0, 0.3)] {
            row(&fitter, free, rate, noise, cells)?;
        }
    }
    Ok(())
}

/// One cell: of each number how far off it is over its standard deviation, that deviation, whether the interval has
/// the truth.
struct Found {
    numbers: Vec<(f64, f64, bool)>,
    evaluations: usize,
}

fn row(
    fitter: &Fitter,
    free: &[&str],
    rate: f64,
    noise: f64,
    cells: usize,
) -> Result<(), Box<dyn Error>> {
    let names: Vec<&str> = ["tension_over_stiffness"].iter().chain(free).copied().collect();
    // Factors, the delay, and the seed of the noise.
    let mut distributions = vec![Distribution::LogUniform { low: 0.8, high: 1.25 }; names.len()];
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
    let settings = Settings {
        free: Some(names.iter().map(|name| Unknown::named(name)).collect()),
        ..Settings::default()
    };
    let found: Vec<Option<Found>> = (0..cells)
        .into_par_iter()
        .map(|cell| {
            let truth = design.row(cell)?;
            let (factors, delay) = (&truth[..names.len()], truth[names.len()]);
            let factors: Vec<(&str, f64)> =
                names.iter().copied().zip(factors.iter().copied()).collect();
            let shifted: Vec<f64> = times_ms.iter().map(|time| time - delay).collect();
            let mut values = fitter.curve(&factors, LENGTH, &shifted).ok()?;
            for (value, noise) in values.iter_mut().zip(noises.row(cell)?) {
                *value += noise;
            }
            let observed = Observed {
                name: "synthetic".to_owned(),
                times_ms: times_ms.clone(),
                values,
                scale: Scale::Length,
                unit: "um".to_owned(),
                stimuli: Stimuli::Given(vec![50.0]),
            };
            let fit = fitter.fit(&[observed], &settings, &|_| true).ok()??;
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
                let deviation = estimate.standard_deviation?;
                let inside = match estimate.interval {
                    [Some(low), Some(high)] => low <= *truth && *truth <= high,
                    [low, high] => {
                        low.is_none_or(|low| low <= *truth)
                            && high.is_none_or(|high| *truth <= high)
                    }
                };
                let relative = if *name == "delay" { 1.0 } else { 100.0 / truth };
                Some(((estimate.value - truth) / deviation, relative * deviation, inside))
            };
            let numbers = truths.iter().map(number).collect::<Option<Vec<_>>>()?;
            Some(Found { numbers, evaluations: fit.evaluations })
        })
        .collect();
    let took = begun.elapsed().as_secs_f64() * 1000.0 / cells as f64;
    let sound: Vec<&Found> = found
        .iter()
        .flatten()
        .filter(|found| found.numbers.iter().all(|(off, ..)| off.abs() < RECOVERED))
        .collect();
    let columns = sound.first().map_or(0, |found| found.numbers.len());
    let count = sound.len() as f64;
    let each = |of: &dyn Fn(&(f64, f64, bool)) -> f64| -> Vec<f64> {
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
            let mut all: Vec<f64> = sound.iter().map(|found| found.numbers[at].1).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        })
        .collect();
    let errors = each(&|number| number.0 * number.0).into_iter().map(f64::sqrt).collect();
    // Of all cells: one that was not recovered is not covered.
    let coverage: Vec<f64> = (0..columns)
        .map(|at| {
            let inside =
                |found: &Option<Found>| found.as_ref().is_some_and(|found| found.numbers[at].2);
            100.0 * found.iter().filter(|found| inside(found)).count() as f64 / cells as f64
        })
        .collect();
    let evaluations = sound.iter().map(|found| found.evaluations).sum::<usize>() as f64 / count;
    println!(
        "| {} | {rate} | {noise} | {} of {cells} | {} | {} | {} | {evaluations:.0} | {took:.0} |",
        names.join(", "),
        sound.len(),
        text(deviations, 3),
        text(errors, 2),
        text(coverage, 0),
    );
    Ok(())
}
