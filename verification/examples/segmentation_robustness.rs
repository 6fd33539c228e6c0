//! Where segmentation breaks: Dice's coefficient with the known outline of synthetic cells, over a grid of
//! contrast and noise and for single difficulties, as the tables of `docs/reference/accuracy.md`.
//!
//! ```text
//! cargo run --release -p myospring-verification --example segmentation_robustness
//! ```
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "it prints tables of pictures of its own"
)]

#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::segment::{Choice, SegmentationSettings, segment};
use std::sync::Mutex;
use synthetic_cell::{Scene, Truth};

/// Pictures for each entry; the worst is shown.
const SEEDS: u64 = 3;

/// Larger frames are left out.
const MOST_COLUMNS: f64 = 2400.0;

type Draw = fn(&Scene) -> Truth;

/// Confidence and Dice's coefficient of every cell that was found.
static JUDGED: Mutex<Vec<[f64; 2]>> = Mutex::new(Vec::new());

/// The worst Dice's coefficient, and in brackets where the program itself called the outline doubtful.
fn worst(scene: Scene, draw: Draw) -> String {
    let mut worst = f64::INFINITY;
    let mut doubtful = false;
    for seed in 1..=SEEDS {
        let truth = draw(&Scene { seed, ..scene });
        let Ok(pixel) = PixelSize::new(scene.pixel_um) else {
            return "none".to_owned();
        };
        let found = segment(&truth.plane, pixel, &SegmentationSettings::default());
        let Ok(found) = found else {
            return "none".to_owned();
        };
        let Ok(cell) = found.choose(Choice::Largest, true) else {
            return "none".to_owned();
        };
        doubtful |= cell.confidence.is_doubtful();
        let inside = found.numbers.iter().map(|&number| number == cell.number);
        let dice = truth.dice(inside);
        JUDGED.lock().unwrap().push([cell.confidence.score, dice]);
        worst = worst.min(dice);
    }
    if doubtful { format!("({worst:.2})") } else { format!("{worst:.2}") }
}

/// How far confidence may be trusted.
fn reliability() {
    let judged = JUDGED.lock().unwrap();
    println!("\nReliability\n\n| confidence | outlines | Dice, median | worst | at least 0.9 |");
    println!("|---|---|---|---|---|");
    for [low, high] in [[0.0, 0.25], [0.25, 0.5], [0.5, 0.75], [0.75, 0.95], [0.95, 1.01]] {
        let within = judged.iter().filter(|[sure, _]| (low..high).contains(sure));
        let mut dice: Vec<f64> = within.map(|[_, dice]| *dice).collect();
        dice.sort_by(f64::total_cmp);
        let (Some(worst), count) = (dice.first(), dice.len()) else { continue };
        let good = dice.iter().filter(|&&dice| dice >= 0.9).count();
        println!(
            "| {low} to {:.2} | {count} | {:.2} | {worst:.2} | {:.0} % |",
            high.min(1.0),
            dice[count / 2],
            100.0 * good as f64 / count as f64
        );
    }
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

/// A cell in frames of any size: how much of the frame it covers, and pixels.
fn coverage(title: &str, start: Scene, draw: Draw) {
    let pixels = [0.1, 0.25, 0.65, 1.3];
    let header: Vec<String> = pixels.iter().map(|pixel| format!("{pixel} um")).collect();
    println!("\n{title}\n\n| part of the frame \\ pixel | {} |", header.join(" | "));
    println!("|---|{}", "---|".repeat(pixels.len()));
    for (part, field_um, half_width_um, taper) in [
        ("0.02 %", 3080.0, 12.0, 0.6),
        ("0.1 %", 1380.0, 12.0, 0.6),
        ("1 %", 436.0, 12.0, 0.6),
        ("8 %", 160.0, 12.0, 0.6),
        ("33 %", 120.0, 30.0, 0.6),
        ("80 %", 101.5, 47.0, 0.3),
    ] {
        let turn_deg = if half_width_um > 12.0 { 0.0 } else { start.turn_deg };
        let row: Vec<String> = pixels
            .iter()
            .map(|&pixel_um| {
                let scene = Scene { pixel_um, field_um, half_width_um, taper, turn_deg, ..start };
                if field_um / pixel_um > MOST_COLUMNS { String::new() } else { worst(scene, draw) }
            })
            .collect();
        println!("| {part} | {} |", row.join(" | "));
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
    for contrast in [1.0, 0.1] {
        let title = format!("Fluorescence, contrast {contrast}, noise 10");
        coverage(&title, Scene { contrast, ..clear }, Scene::fluorescence);
    }
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
    for contrast in [0.25, 0.1] {
        let title = format!("Brightfield, contrast {contrast}, noise 10");
        coverage(&title, Scene { contrast, ..clear }, Scene::brightfield);
    }
    let noises = [20.0, 80.0];
    for beads in [20.0, 40.0, 80.0] {
        let title = format!("Brightfield, {beads} beads per 1000 um^2");
        grid(&title, Scene { beads, ..clear }, &[0.25, 0.1], &noises, Scene::brightfield);
    }
    for blur_um in [1.2, 2.5, 4.0] {
        let title = format!("Fluorescence, blur {blur_um} um");
        let start = Scene { blur_um, ..Scene::default() };
        grid(&title, start, &[1.0, 0.1], &noises, Scene::fluorescence);
        let title = format!("Brightfield, blur {blur_um} um");
        grid(&title, Scene { blur_um, ..clear }, &[0.25, 0.1], &noises, Scene::brightfield);
    }
    reliability();
}
