//! How well the tension that a curve asks for is found: every model, 30 to 1000 frames a second, noise of 0 to 10 %.
//!
//! `cargo run --release -p myospring-verification --example own_tension` prints the tables of `docs/reference/accuracy.md`;
//! `-- docs/pictures/own-tension.png` draws its picture instead.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

#[path = "../../crates/myospring/tests/common/known_tension.rs"]
mod known_tension;

use known_tension::{Truth, covered, own};
use myospring::cell::{self, TensionKind};
use myospring::fit::Fitter;
use myospring::mechanics::support::SupportKind;
use myospring::output::figure::{self, DrawnTension};
use myospring::output::files;
use rayon::prelude::*;
use std::path::Path;

/// Frames a second, and how many curves of each cell and noise.
const RATES: [(f64, u64); 5] = [(30.0, 24), (60.0, 12), (120.0, 6), (300.0, 3), (1000.0, 1)];
/// Noise, a part of the amplitude.
const NOISES: [f64; 3] = [0.003, 0.02, 0.1];
/// Cells whose peak is sought, their frame rate and noise.
const CELLS: u64 = 200;
const PEAK_RATE: f64 = 60.0;
const PEAK_NOISE: f64 = 0.03;

/// A cell, its truth, and what finds its tension.
struct Known {
    model: String,
    fitter: Fitter,
    truth: Truth,
}

impl Known {
    fn of(model: &str) -> Self {
        let (simulation, truth) = Truth::of(model, SupportKind::MassCentre);
        let fitter = Fitter::of_tension(simulation).unwrap();
        Self { model: model.to_owned(), fitter, truth }
    }

    /// How many frames have the truth in their band, and how many there are.
    fn covered(&self, rate: f64, curves: u64, noise: f64) -> [usize; 2] {
        let one = |seed: u64| {
            let (observed, tensions) = self.truth.filmed(rate, noise, 100 + seed);
            let (_, own) = own(&self.fitter, observed.clone());
            covered(&own, &observed, &tensions)
        };
        (0..curves).map(one).fold([0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]])
    }
}

fn percent([part, all]: [usize; 2]) -> f64 {
    100.0 * part as f64 / all as f64
}

fn main() {
    if let Some(path) = std::env::args_os().nth(1) {
        return draw(path.as_ref());
    }
    let pulls = cell::models()
        .into_iter()
        .filter(|model| model.tension_kind() != TensionKind::None && model.given_peak().is_none());
    let names: Vec<String> = pulls.map(|model| model.name().to_owned()).collect();
    let cells: Vec<Known> = names.par_iter().map(|name| Known::of(name)).collect();
    println!("Frames with the true tension in their 95 % band, %, of all models:\n");
    println!(
        "| frames/s | {} |",
        NOISES.map(|noise| format!("noise {} %", 100.0 * noise)).join(" | ")
    );
    println!("|---|---|---|---|");
    let mut by_model = vec![[0; 2]; cells.len()];
    for (rate, curves) in RATES {
        let parts = NOISES.map(|noise| {
            let all: Vec<[usize; 2]> =
                cells.par_iter().map(|cell| cell.covered(rate, curves, noise)).collect();
            for (sum, one) in by_model.iter_mut().zip(&all) {
                *sum = [sum[0] + one[0], sum[1] + one[1]];
            }
            let all = all.into_iter().fold([0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
            format!("{:.1}", percent(all))
        });
        println!("| {rate} | {} |", parts.join(" | "));
    }
    println!(
        "\nOf each model: frames in their band, cells of {CELLS} whose peak lies in its interval ({PEAK_RATE} frames/s, noise \
         {} %), and the largest error without noise at 1000 frames/s:\n",
        100.0 * PEAK_NOISE
    );
    println!(
        "| model | frames in band, % | mean peaks in the interval by noise, % | by beats, % | error without noise, of the peak | \
         tension at rest, of the peak |"
    );
    println!("|---|---|---|---|---|---|");
    for (cell, frames) in cells.iter().zip(by_model) {
        let Known { model, fitter, truth } = cell;
        let found: Vec<[bool; 2]> = (0..CELLS)
            .into_par_iter()
            .map(|seed| truth.peak_is_covered(fitter, PEAK_RATE, PEAK_NOISE, 1000 + seed))
            .collect();
        let within = |which: usize| {
            percent([found.iter().filter(|found| found[which]).count(), found.len()])
        };
        println!(
            "| `{model}` | {:.1} | {:.1} | {:.1} | {:.1e} | {:.1e} |",
            percent(frames),
            within(0),
            within(1),
            truth.off_when_clean(fitter),
            truth.rest / truth.peak()
        );
    }
}

/// The tension of a noisy curve beside the true one.
fn draw(path: &Path) {
    let Known { fitter, truth, .. } = Known::of("coelho_2021");
    let (observed, tensions) = truth.filmed(PEAK_RATE, PEAK_NOISE, 1000);
    let (_, found) = own(&fitter, observed.clone());
    let drawn = DrawnTension {
        times_ms: found.times_ms,
        tension_kpa: found.tension_kpa,
        band_kpa: found.band_kpa,
        true_kpa: Some(tensions),
        stimuli_ms: known_tension::STIMULI.to_vec(),
    };
    files::write(path, figure::tension(&drawn).unwrap().to_png(200.0).unwrap()).unwrap();
}
