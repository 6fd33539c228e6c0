//! How well a known force comes back from pictures of beads: over density of beads, light, size of pixels and force.
//!
//! `cargo run --release -p myospring-verification --example bead_tractions` prints the table of `docs/reference/accuracy.md`;
//! `-- subsets` compares sides of the squares that are matched.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

#[path = "../../crates/myospring/tests/common/bead_film.rs"]
mod bead_film;
#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use bead_film::BeadScene;
use myospring::experiment::Experiment;
use myospring::experiment::traction::{FoundTractions, Source};
use myospring::mechanics::gel::Gel;

/// Arrangements of beads, each on its own.
const SEEDS: u64 = 5;

fn found(scene: &BeadScene, subset_um: Option<f64>) -> FoundTractions {
    let mut experiment = scene.with_reference();
    if let Source::Beads(beads) = &mut experiment.source {
        beads.subset_um = subset_um;
    }
    experiment.run(&scene.files(&[1.0], 1), &()).unwrap()
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> String {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    format!("{mean:+.1} \u{b1} {:.1}", square.sqrt())
}

fn row(name: &str, scene: &BeadScene, subset_um: Option<f64>) {
    let mut errors: [Vec<f64>; 4] = Default::default();
    let mut last = None;
    for seed in 1..=SEEDS {
        let scene = BeadScene { seed, ..*scene };
        let truth = scene.truth();
        let found = found(&scene, subset_um);
        let frame = found.frames[0];
        let parts = [
            frame.axial_force_nn / truth.axial_force_nn,
            frame.contractile_moment_fj / truth.moment_fj,
            frame.force_nn / truth.force_nn,
        ];
        for (errors, part) in errors.iter_mut().zip(parts) {
            errors.push(100.0 * (part - 1.0));
        }
        errors[3].push(100.0 * frame.axial_noise_floor_nn / truth.axial_force_nn);
        last = Some((truth.axial_force_nn, found));
    }
    let (axial, found) = last.unwrap();
    let followed = found.followed().unwrap();
    println!(
        "| {name} | {axial:.0} | {:.1} | {:.2} | {} | {} | {} | {:.1} | {:.4} | {:.1} |",
        followed.subset_um,
        followed.bead_distance_um,
        spread(&errors[0]),
        spread(&errors[1]),
        spread(&errors[2]),
        errors[3].iter().sum::<f64>() / SEEDS as f64,
        found.tractions[0].noise_um,
        followed.interpolated_pct_most
    );
}

fn head() {
    println!(
        "| pictures | axial force, nN | square, um | bead distance, um | error of axial force, % | of moment, % | of force, all \
         directions, % | noise floor of axial force, % | noise of displacements, um | interpolated, % |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
}

fn main() {
    let usual = BeadScene::default();
    head();
    if std::env::args().any(|argument| argument == "subsets") {
        for subset in [3.0, 4.0, 5.0, 6.0, 8.0, 10.0] {
            row(&format!("{subset} um"), &usual, Some(subset));
        }
        return;
    }
    row("usual", &usual, None);
    for density in [0.1, 0.2, 1.0, 2.0] {
        row(&format!("{density} beads per um^2"), &BeadScene { density, ..usual }, None);
    }
    for photons in [10.0, 30.0, 1000.0] {
        row(&format!("{photons} photons"), &BeadScene { photons, ..usual }, None);
    }
    for pixel_um in [0.1, 0.3] {
        row(&format!("pixels of {pixel_um} um"), &BeadScene { pixel_um, ..usual }, None);
    }
    row("stage off by 3.1, -2.3 um", &BeadScene { drift_um: [3.1, -2.3], ..usual }, None);
    for shortening in [0.005, 0.05] {
        row(
            &format!("force times {}", shortening / 0.02),
            &BeadScene { shortening, ..usual },
            None,
        );
    }
    let gel = Gel { thickness: Some(20.0), ..Gel::half_space(10.0) };
    row("10 kPa, 20 um thick", &BeadScene { gel, ..usual }, None);
}
