//! Times a beat along the path of equilibria against the same beat in time, and compares them: one line
//! of JSON per mesh.
//!
//! `cargo run --release -p myospring-verification --example quasi_static [masses ...]`
//!
//! `solve_s` is the path alone, `beat_s` all of a beat with its cell model (the best of three each).
//! `verlet_s` is the same beat in time with the default material; `verlet_equal_s` one with the slowest
//! vibration twice as fast, which takes as many steps again and comes within 0.1 % of the peak at every
//! output time. `..._off_pct` is the largest difference of shortening from the path, per cent of the peak.
#![allow(clippy::print_stdout, reason = "an example prints")]

use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::{built_in, lattice};
use myospring::recording::Recording;
use myospring::simulation::Simulation;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let wanted: Vec<usize> =
        std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    for masses in if wanted.is_empty() { vec![1900] } else { wanted } {
        println!("{}", compare(masses)?);
    }
    Ok(())
}

fn compare(masses: usize) -> Result<serde_json::Value, Failure> {
    let outline = built_in::adult_ventricular();
    let spacing = lattice::default_spacing(outline.area(), masses);
    let (mesh, _) = lattice::from_outline(&outline, Some(spacing))?;
    let mut simulation = Simulation::new(mesh);
    let peak = simulation.peak_tension;
    let (solve_s, _) = best(|| Ok(simulation.equilibria(&[peak], Tolerance::default())?))?;
    let (beat_s, path) = best(|| Ok(simulation.run_quasi_static(Tolerance::default(), |_| true)?))?;
    let in_time = |simulation: &Simulation| -> Result<(f64, f64), Failure> {
        let clock = Instant::now();
        let outcome = simulation.prepare()?.run(|_| true);
        Ok((clock.elapsed().as_secs_f64(), largest_difference(&path.recording, &outcome.recording)))
    };
    let (verlet_s, verlet_off) = in_time(&simulation)?;
    // Within 0.1 % of the peak.
    simulation.material.slowest_period = Some(1.0);
    let (verlet_equal_s, verlet_equal_off) = in_time(&simulation)?;
    Ok(serde_json::json!({
        "masses": simulation.mesh.len(),
        "solve_s": solve_s,
        "beat_s": beat_s,
        "path": path.effort,
        "verlet_s": verlet_s,
        "verlet_off_pct": verlet_off,
        "verlet_equal_s": verlet_equal_s,
        "verlet_equal_off_pct": verlet_equal_off,
        "ratio": verlet_equal_s / beat_s,
        "ratio_to_default": verlet_s / beat_s,
    }))
}

/// Shortest of three times, s, and the last result.
fn best<T>(job: impl Fn() -> Result<T, Failure>) -> Result<(f64, T), Failure> {
    let timed = || -> Result<(f64, T), Failure> {
        let clock = Instant::now();
        let result = job()?;
        Ok((clock.elapsed().as_secs_f64(), result))
    };
    let (first, second, (third, result)) = (timed()?.0, timed()?.0, timed()?);
    Ok((first.min(second).min(third), result))
}

/// Of the shortening, per cent of its peak.
fn largest_difference(path: &Recording, motion: &Recording) -> f64 {
    let pairs = path.samples.iter().zip(&motion.samples);
    let (difference, peak) = pairs.fold((0.0_f64, 0.0_f64), |(difference, peak), (a, b)| {
        (difference.max((a.shortening_pct - b.shortening_pct).abs()), peak.max(a.shortening_pct))
    });
    100.0 * difference / peak
}
