//! The unloaded twitch of every cell model of the list, over what is measured: the table and the figure of
//! `docs/explanation/which-cell-model.md`.
//!
//! `cargo run --release -p myospring-verification --example unloaded_twitches -- docs/pictures/which-cell-model.png`
//!
//! Each model has the material that a run takes with it unless told otherwise, on the built-in cell along its path of
//! equilibria. The toy, and models without tension, are left out.
#![allow(clippy::print_stdout, reason = "an example prints")]

use myospring::analysis::bands;
use myospring::cell::{self, CellModel};
use myospring::output::figure::{ContractionOptions, contraction};
use myospring::output::files;
use myospring::recording::Recording;
use myospring::run_file::RunFile;
use std::path::PathBuf;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// Columns of the table.
const METRICS: [&str; 6] = [
    "peak_tension",
    "peak_shortening",
    "maximum_shortening_rate",
    "shortening_rate_over_peak",
    "time_to_peak_from_stimulus",
    "relaxation_time_50",
];

fn main() -> Result<(), Failure> {
    println!("| model | {} |", METRICS.join(" | "));
    let mut twitches: Vec<(String, Recording)> = Vec::new();
    let pulls = |model: &&Arc<dyn CellModel>| {
        let relative = model.tension_kind().published_peak().is_some();
        (relative || model.feels_stretch()) && model.name() != "toy_alpha"
    };
    for model in cell::models().iter().filter(pulls) {
        let name = model.name();
        let text = format!("[cell]\nmodel = \"{name}\"\n[numerics]\nintegrator = \"quasi-static\"");
        let run = RunFile::from_text(&text)?.resolve()?;
        let read = |file: &str| std::fs::read(file);
        let made = run.make(run.shape.mesh(&run.shape.bytes(read)?)?, read)?;
        let outcome = made.simulation.build()?.run(|_progress| true);
        let beats = outcome.beats();
        let first = beats.first().ok_or("no beat")?;
        let values = METRICS.map(|metric| {
            first.value(metric).map_or("-".to_owned(), |value| format!("{value:.2}"))
        });
        println!("| {name} | {} |", values.join(" | "));
        twitches.push((name.to_owned(), outcome.recording));
    }
    let path = std::env::args().nth(1).map_or_else(|| "twitches.png".into(), PathBuf::from);
    let band = bands::band("peak_shortening").ok_or("no band")?;
    let options = ContractionOptions {
        stimulus_times_ms: vec![50.0],
        reference_band: Some(([band.low, band.high], "unloaded adult ventricular cells")),
    };
    let curves: Vec<(&str, &Recording)> =
        twitches.iter().map(|(name, recording)| (name.as_str(), recording)).collect();
    files::write(&path, contraction(&curves, &options)?.to_png(200.0)?)?;
    Ok(())
}
