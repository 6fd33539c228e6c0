//! How well tension and stiffness of a cell in kPa are found from its shape and its force on gels of 1 to 100 kPa.
//!
//! `cargo run --release -p myospring-verification --example force_on_gel` prints the table of `docs/reference/accuracy.md`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

use myospring::fit::{FitSettings, Fitter, Loaded, Observed, Scale, Stimuli, Unknown};
use myospring::integrate::Method;
use myospring::mechanics::gel::Gel;
use myospring::mechanics::material::Stiffness;
use myospring::mechanics::support::SupportKind;
use myospring::recording::AXIAL_FORCE;
use myospring::run_file::RunFile;
use myospring::simulation::Simulation;
use myospring::study::sampling::{Distribution, Sampler, sample};
use rayon::prelude::*;

/// Young's moduli of the gels, kPa, and how much stiffer the second gel is: 10 and 35 kPa in the work of CONTRAX.
const GELS: [f64; 5] = [1.0, 3.0, 10.0, 30.0, 100.0];
const SECOND: f64 = 3.5;
/// Cells of each row.
const CELLS: u64 = 40;
/// Of the true cells, kPa; the fit starts from 308 and 50.
const MODULUS: f64 = 154.0;
const TENSION: f64 = 30.0;
/// Noise of a frame, of the largest shortening and force, and error of the scale of the force.
const NOISES: [f64; 2] = [0.01, 0.03];
const SCALE_ERROR: f64 = 0.05;
/// Interval of frames, ms, and their number.
const FRAMES: (f64, u32) = (10.0, 65);

/// What is measured.
const DESIGNS: [&str; 3] = [
    "shape and force on this gel",
    "shape of the free cell, force on this gel",
    "shape and force on this gel, force on one 3.5 times as stiff",
];

fn times() -> Vec<f64> {
    (0..FRAMES.1).map(|frame| FRAMES.0 * f64::from(frame)).collect()
}

/// The length of the true cell under a support, and its axial force.
fn truth(usual: &Simulation, support: SupportKind) -> [Vec<f64>; 2] {
    let mut simulation =
        Simulation { support, duration: 650.0, peak_tension: TENSION, ..usual.clone() };
    let Stiffness::YoungModulus(modulus) = simulation.material.stiffness else { unreachable!() };
    simulation.material.stiffness = Stiffness::YoungModulus(MODULUS);
    simulation.material.area_modulus *= MODULUS / modulus;
    simulation.numerics.method = Method::QuasiStatic;
    let recording = simulation.build().unwrap().run(|_| true).recording;
    let samples = &recording.samples;
    let force = recording.signals.iter().find(|signal| signal.name == AXIAL_FORCE);
    let places = || {
        times()
            .into_iter()
            .map(|time| samples.partition_point(|sample| sample.t_ms < time).min(samples.len() - 1))
    };
    [
        places().map(|place| samples[place].length_um).collect(),
        force.map_or_else(Vec::new, |force| places().map(|place| force.values[place]).collect()),
    ]
}

/// Normal deviates.
fn deviates(count: usize, seed: u64) -> Vec<f64> {
    let normal = Distribution::Normal { mean: 0.0, standard_deviation: 1.0 };
    let drawn = sample(&Sampler::LatinHypercube { size: count }, &[normal], seed).unwrap();
    drawn.iter().map(|row| row[0]).collect()
}

/// A curve with its noise, times a factor.
fn noisy(values: &[f64], noise: f64, by: f64, seed: u64) -> Vec<f64> {
    let [low, high] =
        values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
    let drawn = deviates(values.len(), seed);
    values.iter().zip(drawn).map(|(value, off)| by * value + noise * (high - low) * off).collect()
}

fn observed(values: Vec<f64>, scale: Scale, unit: &str) -> Observed {
    let stimuli = Stimuli::Given(vec![50.0]);
    Observed { name: unit.into(), times_ms: times(), values, scale, unit: unit.into(), stimuli }
}

/// Ends of an interval over the truth, where it has both.
type Interval = [Option<f64>; 2];

fn main() {
    let run = RunFile::from_text("[shape]\nspacing = \"5 um\"").unwrap().resolve().unwrap();
    let fitter = Fitter::of(&run, |path| std::fs::read(path)).unwrap();
    let usual = fitter.simulation();
    let settings = FitSettings {
        free: Some(vec![Unknown::TensionOverStiffness, Unknown::YoungModulus]),
        starts: 2,
        ..FitSettings::default()
    };
    let gel = |modulus: f64| SupportKind::Gel(Gel::half_space(modulus));
    println!(
        "| measured | gel, kPa | tension, median interval | tension: true value inside, % | stiffness, median interval | stiffness: true \
         value inside, % |\n|---|---|---|---|---|---|"
    );
    for (design, words) in DESIGNS.into_iter().enumerate() {
        for modulus in GELS {
            let on = gel(modulus);
            let stiffer = gel(SECOND * modulus);
            let of_shape = if design == 1 { SupportKind::MassCentre } else { on };
            let [length, _] = truth(usual, of_shape);
            let forces: Vec<(SupportKind, Vec<f64>)> = [Some(on), (design == 2).then_some(stiffer)]
                .into_iter()
                .flatten()
                .map(|support| {
                    let [_, force] = truth(usual, support);
                    (support, force)
                })
                .collect();
            let cell = |seed: u64| -> [Interval; 2] {
                let values = noisy(&length, NOISES[0], 1.0, 7 * seed);
                let mut curves =
                    vec![Loaded::exact(of_shape, observed(values, Scale::Length, "um"))];
                let scales = deviates(64, 900_000 + seed);
                for (number, (support, force)) in forces.iter().enumerate() {
                    let by =
                        (SCALE_ERROR * scales[(number as u64 * 31 + seed) as usize % 64]).exp();
                    let values = noisy(force, NOISES[1], by, 7 * seed + 1 + number as u64);
                    let observed = observed(values, Scale::Load(AXIAL_FORCE), "nN");
                    curves.push(Loaded { support: *support, observed, scale_error: SCALE_ERROR });
                }
                let fit = fitter.fit_loaded(&curves, &settings, &|_| true).unwrap().unwrap();
                let interval = |name: &str, truth: f64| {
                    fit.estimate(name).unwrap().interval.map(|end| end.map(|end| end / truth))
                };
                [interval("peak_tension", TENSION), interval("young_modulus", MODULUS)]
            };
            // The tables of equilibria are solved once.
            let mut found = vec![cell(1)];
            found.par_extend((2..=CELLS).into_par_iter().map(cell));
            let of = |which: usize| {
                let ends = |end: usize| {
                    let open = if end == 0 { 0.0 } else { f64::INFINITY };
                    let mut ends: Vec<f64> =
                        found.iter().map(|cell| cell[which][end].unwrap_or(open)).collect();
                    ends.sort_by(f64::total_cmp);
                    ends
                };
                let [low, high] = [ends(0), ends(1)];
                let inside = found.iter().filter(|cell| {
                    cell[which][0].is_none_or(|low| low <= 1.0)
                        && cell[which][1].is_none_or(|high| high >= 1.0)
                });
                let inside = 100.0 * inside.count() as f64 / found.len() as f64;
                let middle = [low, high].map(|ends| ends[ends.len() / 2]);
                let interval = match middle {
                    [low, high] if low > 0.0 && high.is_finite() => {
                        format!("{:+.0} to {:+.0} %", 100.0 * (low - 1.0), 100.0 * (high - 1.0))
                    }
                    [low, _] if low > 0.0 => format!("from {:+.0} %, open", 100.0 * (low - 1.0)),
                    [_, high] if high.is_finite() => {
                        format!("open, to {:+.0} %", 100.0 * (high - 1.0))
                    }
                    _ => "open".to_owned(),
                };
                format!("{interval} | {inside:.0}")
            };
            println!("| {words} | {modulus} | {} | {} |", of(0), of(1));
        }
    }
}
