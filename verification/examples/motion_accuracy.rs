//! How well a known motion is found, over scale, noise, depth of grey and frame rate; and how fast.
//!
//! `cargo run --release -p myospring-verification --example motion_accuracy` prints the table of `docs/reference/accuracy.md`;
//! `-- speed` times 500 frames of 512 x 512 pixels with about 2000 points; `-- film FILE.y4m` writes a film to try
//! `myospring track` on.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;
#[path = "../../crates/myospring/tests/common/synthetic_film.rs"]
mod synthetic_film;

use myospring::mesh::lattice;
use myospring::microscopy::film::Film;
use myospring::microscopy::motion::{self, CellAtRest, CellMotion, Rest, TrackingSettings};
use myospring::microscopy::picture::Selection;
use std::time::Instant;
use synthetic_film::{FilmScene, SARCOMERE_UM, quantile};

fn follow(scene: &FilmScene, film: &Film, spacing: Option<f64>) -> CellMotion {
    let mask = scene.mask();
    let (mesh, _) = lattice::from_mask(&mask, spacing).unwrap();
    let inside = mask.inside();
    let pixel_size = mask.pixel_size();
    let cell =
        CellAtRest { mesh: &mesh, inside: &inside, any_cell: &inside, pixel_size, fibres: None };
    motion::follow(film, Rest::at(film, 0).unwrap(), &cell, TrackingSettings::at(50.0), |_| true)
        .unwrap()
}

fn row(scene: &FilmScene) {
    let motion = follow(scene, &scene.film(), Some(2.0));
    let errors = scene.errors(&motion);
    let wrong = 0.5 * SARCOMERE_UM / scene.pixel_um;
    let wrong = errors.iter().filter(|error| **error > wrong).count() as f64 / errors.len() as f64;
    let interpolated: f64 = (0..motion.len()).map(|frame| motion.interpolated_share(frame)).sum();
    println!(
        "| {:.0} | {} | {:.0} | {:.0} | {} | {:.3} | {:.2} | {:.2} | {:.1} | {:.3} |",
        SARCOMERE_UM / scene.pixel_um,
        scene.noise,
        100.0 * scene.shortening,
        scene.cell_um[0],
        scene.beat,
        quantile(&errors, 0.5),
        quantile(&errors, 0.95),
        100.0 * wrong,
        100.0 * interpolated / motion.len() as f64,
        scene.shortening_error(&motion)
    );
}

fn grid() {
    println!(
        "| px a sarcomere | noise | shortening, % | length, um | frames a beat | median error, px | 95 % | wrong stripe, % | \
         interpolated, % | error of shortening, points |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let usual = FilmScene { bits: 8, ..FilmScene::default() };
    for pixels in [6.0, 9.0, 12.0, 20.0] {
        for noise in [0.0, 0.155, 0.4] {
            let scale = if pixels > 15.0 { 50.0 } else { 80.0 };
            let pixel_um = SARCOMERE_UM / pixels;
            row(&FilmScene { pixel_um, noise, cell_um: [scale, 16.0], ..usual });
        }
    }
    for beat in [5, 8, 12, 25] {
        let cell_um = [120.0, 16.0];
        let frames = beat + 4;
        row(&FilmScene { cell_um, shortening: 0.12, beat, frames, noise: 0.155, ..usual });
    }
}

/// A film of 20 beats, 500 frames, and its bytes.
fn long_film() -> (FilmScene, Vec<u8>) {
    let scene = FilmScene {
        cell_um: [86.0, 80.0],
        frames: 25,
        beat: 20,
        noise: 0.1,
        bits: 8,
        ..FilmScene::default()
    };
    let bytes = scene.bytes();
    let [width, height] = scene.size();
    let head = bytes.len() - scene.frames * (6 + width * height);
    let mut film = bytes[..head].to_vec();
    for _ in 0..20 {
        film.extend(&bytes[head..]);
    }
    (scene, film)
}

fn speed() {
    let (scene, film) = long_film();
    let [width, height] = scene.size();
    let film = Film::read(film, &Selection::default()).unwrap();
    let start = Instant::now();
    let motion = follow(&scene, &film, None);
    let seconds = start.elapsed().as_secs_f64();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "{} frames of {width} x {height} pixels, {} points: {seconds:.1} s on {threads} threads",
        motion.len(),
        motion.mesh.len()
    );
}

/// A film of a beat to try things on, pixels of 0.2 um, 50 frames a second.
fn example(file: &str) {
    let scene = FilmScene {
        cell_um: [100.0, 22.0],
        frames: 60,
        beat: 36,
        shortening: 0.1,
        noise: 0.15,
        vignette: 0.3,
        bits: 8,
        stage_um: 0.5,
        beads: true,
        ..FilmScene::default()
    };
    std::fs::write(file, scene.bytes()).unwrap();
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["speed"] => speed(),
        ["film", file] => example(file),
        ["long-film", file] => std::fs::write(file, long_film().1).unwrap(),
        _ => grid(),
    }
}
