//! Times a beat along the path of equilibria against the same beat in time, and compares them.
//!
//! `cargo run --release -p myospring --no-default-features --example quasi_static [masses ...]`
#![allow(clippy::print_stdout, reason = "an example prints")]

use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::Simulation;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let outline = built_in::adult_ventricular();
    let wanted: Vec<usize> =
        std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    for masses in if wanted.is_empty() { vec![1900] } else { wanted } {
        let spacing = lattice::default_spacing(outline.area(), masses);
        let (mesh, _) = lattice::from_outline(&outline, Some(spacing))?;
        let simulation = Simulation::coelho_2021(mesh);
        let clock = Instant::now();
        let path = simulation.run_quasi_static(Tolerance::default(), |_| true)?;
        let quasi_static = clock.elapsed().as_secs_f64();
        println!("{} masses", simulation.mesh.len());
        println!(
            "  path: {quasi_static:.3} s, {} load steps, {} Newton iterations, error {:.1e} um, lag {:.3} ms",
            path.load_steps, path.newton_iterations, path.error, path.delay
        );
        let clock = Instant::now();
        let verlet = simulation.prepare()?.run(|_| true);
        let in_time = clock.elapsed().as_secs_f64();
        let pairs = || path.recording.samples.iter().zip(&verlet.recording.samples);
        let difference =
            pairs().map(|(a, b)| (a.shortening_pct - b.shortening_pct).abs()).fold(0.0, f64::max);
        let peak = pairs().map(|(_, b)| b.shortening_pct).fold(0.0, f64::max);
        println!(
            "  Verlet: {in_time:.3} s, {:.0} times longer; shortening differs by at most {:.3} % of its peak",
            in_time / quasi_static,
            100.0 * difference / peak
        );
    }
    Ok(())
}
