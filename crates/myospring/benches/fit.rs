//! A cell's own parameters from its curve, on one thread: `cargo bench -p myospring --bench fit`.
#![allow(missing_docs, reason = "the macros of criterion make public items")]
#![allow(clippy::expect_used, reason = "a benchmark may stop here")]

use criterion::{Criterion, criterion_group, criterion_main};
use myospring::fit::{FitSettings, Fitter, Observed, Scale, Stimuli};
use myospring::run_file::RunFile;
use myospring::study::Threads;
use std::f64::consts::PI;
use std::hint::black_box;

/// What both models are asked for, as a part of the run's own.
const TRUTH: [(&str, f64); 1] = [("tension_over_stiffness", 0.8)];

/// A cell of a model.
fn cell(model: &str) -> Fitter {
    let run = RunFile::from_text(&format!("cell.model = \"{model}\"")).expect("it is one");
    let run = run.resolve().expect("it can be run");
    Fitter::of(&run, |path| std::fs::read(path)).expect("a cell to fit")
}

/// A curve of it: 163 frames, 250 a second; of several beats 250 frames each, with beats as they are seen. A ripple
/// stands for noise.
fn measured(fitter: &Fitter, beats: u32) -> Observed {
    let frames = if beats == 1 { 163 } else { 250 };
    let times_ms: Vec<f64> = (0..frames).map(|frame| 4.0 * f64::from(frame)).collect();
    let beat = fitter.curve(&TRUTH, 100.0, &times_ms).expect("it beats");
    let ripple = |frame: u32| 0.14 * (1.7 * f64::from(frame) * f64::from(frame)).sin();
    let (mut times_ms, mut values) = (Vec::new(), Vec::new());
    for frame in 0..beats * frames {
        times_ms.push(4.0 * f64::from(frame));
        values.push(beat[(frame % frames) as usize] + ripple(frame));
    }
    let starts = (0..beats).map(|beat| 50.0 + f64::from(4 * frames * beat)).collect();
    let stimuli = if beats == 1 { Stimuli::Given(starts) } else { Stimuli::Seen(starts) };
    let (name, unit) = ("cell".to_owned(), "um".to_owned());
    Observed { name, times_ms, values, scale: Scale::Length, unit, stimuli }
}

/// A curve that no setting of either model follows: three beats in 146 frames, 30 a second, each a half sine that falls
/// as fast as it rises.
fn strange() -> Observed {
    let times_ms: Vec<f64> = (0..146).map(|frame| 1000.0 / 30.0 * f64::from(frame)).collect();
    let starts = vec![200.0, 1750.0, 3300.0];
    let beat = |time: f64| {
        let since = starts.iter().rev().find(|start| **start <= time).map_or(-1.0, |s| time - s);
        if (0.0..900.0).contains(&since) { (PI * since / 900.0).sin() } else { 0.0 }
    };
    let ripple = |time: f64| 0.05 * (0.017 * time * time).sin();
    let values = times_ms.iter().map(|time| 100.0 - 4.0 * beat(*time) + ripple(*time)).collect();
    let (name, unit) = ("cell".to_owned(), "um".to_owned());
    Observed { name, times_ms, values, scale: Scale::Length, unit, stimuli: Stimuli::Seen(starts) }
}

fn fits(criterion: &mut Criterion) {
    let threads = Threads::new(Some(1)).expect("one thread");
    let mut group = criterion.benchmark_group("fit");
    group.sample_size(10);
    for model in ["coelho_2021", "land_2017"] {
        let fitter = cell(model);
        let simulation = fitter.simulation().clone();
        let curves = [measured(&fitter, 1)];
        group.bench_function(format!("a curve of {model}, its mesh included"), |bench| {
            bench.iter(|| {
                let fitter = Fitter::new(simulation.clone()).expect("a cell to fit");
                let fit =
                    threads.install(|| fitter.fit(&curves, &FitSettings::default(), &|_| true));
                black_box(fit.is_ok())
            });
        });
        group.bench_function(format!("another curve of {model}"), |bench| {
            bench.iter(|| {
                let fit =
                    threads.install(|| fitter.fit(&curves, &FitSettings::default(), &|_| true));
                black_box(fit.is_ok())
            });
        });
        let curves = [measured(&fitter, 8)];
        group.bench_function(format!("eight beats of {model} in 2000 frames"), |bench| {
            bench.iter(|| {
                let fit =
                    threads.install(|| fitter.fit(&curves, &FitSettings::default(), &|_| true));
                black_box(fit.is_ok())
            });
        });
        let curves = [strange()];
        group.bench_function(format!("a curve that {model} cannot follow"), |bench| {
            bench.iter(|| {
                let fit =
                    threads.install(|| fitter.fit(&curves, &FitSettings::default(), &|_| true));
                black_box(fit.is_ok())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);
