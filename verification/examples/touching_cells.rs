//! How often cells that touch are parted, and single cells kept whole, over pixel sizes and turns, as the tables of
//! `docs/reference/accuracy.md`.
//!
//! ```text
//! cargo run --release -p myospring-verification --example touching_cells
//! ```
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "it prints tables of pictures of its own"
)]

#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;
#[path = "../../crates/myospring/tests/common/touching_cells.rs"]
mod touching_cells;

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::segment::{Modality, Segmentation, SegmentationSettings, segment};
use synthetic_cell::Scene;
use touching_cells::{Body, Look, brightfield, one, pairs, singles};

const PIXELS_UM: [f64; 5] = [0.15, 0.25, 0.5, 0.65, 1.0];
const TURNS_DEG: [f64; 3] = [0.0, 20.0, 65.0];

/// Whether something is said about the number of cells.
fn doubts(found: &Segmentation) -> bool {
    let mut reasons = found.cells.iter().flat_map(|cell| &cell.confidence.reasons);
    reasons.any(|reason| reason.contains("two cells") || reason.contains("one cell"))
}

/// Per cent of pictures in which each cell is found with Dice of at least 0.9, and no other; and of the rest, how
/// many say that there may be another number of cells.
fn shares(modality: Modality, start: Scene, bodies: &[Body], look: &Look) -> String {
    let (mut all, mut right, mut said) = (0, 0, 0);
    for pixel_um in PIXELS_UM {
        for turn_deg in TURNS_DEG {
            let scene = Scene { pixel_um, turn_deg, field_um: 225.0, ..start };
            let truth = match modality {
                Modality::Brightfield => brightfield(&scene, bodies),
                _ => look.fluorescence(&scene, bodies),
            };
            let settings = SegmentationSettings { modality, ..SegmentationSettings::default() };
            let found = segment(&truth.plane, PixelSize::new(pixel_um).unwrap(), &settings);
            all += 1;
            let Ok(found) = found else { continue };
            if found.cells.len() == bodies.len() && truth.worst_dice(&found.numbers) >= 0.9 {
                right += 1;
            } else {
                said += u32::from(doubts(&found));
            }
        }
    }
    match all - right {
        0 => "100 %".to_owned(),
        wrong => format!("{} %, {said} of {wrong}", 100 * right / all),
    }
}

fn table(title: &str, modality: Modality, contrast: f64, noises: [f64; 2]) {
    println!("\n{title}\n\n| cells | noise {} | noise {} |\n|---|---|---|", noises[0], noises[1]);
    let alone = singles().into_iter().map(|(name, form, look)| (name, one(form), look));
    let mut shown = Vec::new();
    for (name, bodies, look) in pairs().into_iter().chain(alone) {
        // How a cell looks inside makes no difference in brightfield.
        let places: Vec<_> =
            bodies.iter().map(|body| (body.form, body.at, body.turn_deg)).collect();
        if modality == Modality::Brightfield && shown.contains(&places) {
            continue;
        }
        shown.push(places);
        let row = noises.map(|noise| {
            let start = Scene { contrast, noise, ..Scene::default() };
            shares(modality, start, &bodies, &look)
        });
        println!("| {name} | {} |", row.join(" | "));
    }
}

fn main() {
    table("Fluorescence, contrast 1", Modality::Fluorescence, 1.0, [10.0, 100.0]);
    table("Brightfield, contrast 0.25", Modality::Brightfield, 0.25, [10.0, 40.0]);
}
