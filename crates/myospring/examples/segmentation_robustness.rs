//! Where segmentation breaks: Dice's coefficient with the known outline of synthetic cells, over a grid of
//! contrast and noise and for single difficulties, as the tables of `docs/your-own-cell.md`.
//!
//! ```text
//! cargo run --release -p myospring --example segmentation_robustness
//! ```
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "it prints tables of pictures of its own"
)]

#[path = "../tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::segment::{Choice, Settings, segment};
use synthetic_cell::{Scene, Truth};

/// Pictures for each entry; the worst is shown.
const SEEDS: u64 = 3;

type Draw = fn(&Scene) -> Truth;

/// The worst Dice's coefficient, and in brackets where the program itself called the outline doubtful.
fn worst(scene: Scene, draw: Draw) -> String {
    let mut worst = f64::INFINITY;
    let mut doubtful = false;
    for seed in 1..=SEEDS {
        let truth = draw(&Scene { seed, ..scene });
        let Ok(pixel) = PixelSize::new(scene.pixel_um) else {
            return "none".to_owned();
        };
        let found = segment(&truth.plane, pixel, &Settings::default());
        let Ok(found) = found else {
            return "none".to_owned();
        };
        let Ok(cell) = found.choose(Choice::Largest, true) else {
            return "none".to_owned();
        };
        doubtful |= cell.confidence.is_doubtful();
        let inside = found.numbers.iter().map(|&number| number == cell.number);
        worst = worst.min(truth.dice(inside));
    }
    if doubtful { format!("({worst:.2})") } else { format!("{worst:.2}") }
}

fn grid(title: &str, start: Scene, contrasts: &[f64], noises: &[f64], draw: Draw) {
    let header: Vec<String> = noises.iter().map(|noise| format!("{noise}")).collect();
    println!("\n{title}\n\n| contrast \\ noise | {} |", header.join(" | "));
    println!("|---|{}", "---|".repeat(noises.len()));
    for &contrast in contrasts {
        let row: Vec<String> =
            noises.iter().map(|&noise| worst(Scene { contrast, noise, ..start }, draw)).collect();
        println!("| {contrast} | {} |", row.join(" | "));
    }
}

fn list(title: &str, scenes: &[(&str, Scene)], draw: Draw) {
    println!("\n{title}\n\n| difficulty | Dice |\n|---|---|");
    for (name, scene) in scenes {
        println!("| {name} | {} |", worst(*scene, draw));
    }
}

fn main() {
    let clear = Scene::default();
    let noises = [5.0, 20.0, 50.0, 100.0, 200.0];
    grid("Fluorescence", clear, &[1.0, 0.3, 0.1, 0.05, 0.02], &noises, Scene::fluorescence);
    list(
        "Fluorescence, contrast 1, noise 10",
        &[
            ("light falls by 40 % to the corners", Scene { vignette: 0.4, ..clear }),
            ("background rises by 300 counts over the field", Scene { haze: 300.0, ..clear }),
            ("blur 0.6 um", Scene { blur_um: 0.6, ..clear }),
            ("blur 1.2 um", Scene { blur_um: 1.2, ..clear }),
            ("blur 2.5 um", Scene { blur_um: 2.5, ..clear }),
            ("pixels of 0.1 um", Scene { pixel_um: 0.1, ..clear }),
            ("pixels of 0.65 um", Scene { pixel_um: 0.65, ..clear }),
            ("pixels of 1.3 um", Scene { pixel_um: 1.3, ..clear }),
        ],
        Scene::fluorescence,
    );
    let noises = [5.0, 20.0, 40.0, 80.0, 160.0];
    grid("Brightfield", clear, &[0.4, 0.2, 0.1, 0.05], &noises, Scene::brightfield);
    let clear = Scene { contrast: 0.25, ..clear };
    list(
        "Brightfield, contrast 0.25, noise 10",
        &[
            ("light falls by 40 % to the corners", Scene { vignette: 0.4, ..clear }),
            ("10 beads per 1000 um^2", Scene { beads: 10.0, ..clear }),
            ("30 beads per 1000 um^2", Scene { beads: 30.0, ..clear }),
            ("60 beads per 1000 um^2", Scene { beads: 60.0, ..clear }),
            ("blur 1.2 um", Scene { blur_um: 1.2, ..clear }),
            ("pixels of 0.1 um", Scene { pixel_um: 0.1, ..clear }),
            ("pixels of 0.65 um", Scene { pixel_um: 0.65, ..clear }),
        ],
        Scene::brightfield,
    );
}
