//! A published film beside its fitted cell: the picture of README.
//!
//! `cargo run --release -p myospring-verification --example film_fit -- sample_2.avi docs/pictures/film-fit.png` follows the cell of
//! `sample_2.avi` of <https://github.com/Sarc-Graph/sarcgraph> (MIT License), fits it, prints how far the two are from each other,
//! and draws them.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

use myospring::experiment::fit::FitCell;
use myospring::experiment::{Experiment, Files};
use myospring::measured::TableOptions;
use myospring::output::files;
use myospring::settings::{Value, find};
use std::path::PathBuf;

/// Side of a pixel, estimated: the file does not say it; frames a second of the camera.
const PIXEL: &str = "0.18 um";
const FRAMES_PER_S: f64 = 30.0;
/// Pixels of the film per px of the picture, and pixels of the picture per inch.
const SHARP: f64 = 2.0;
const DPI: f64 = 144.0;

fn main() {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(film), Some(picture)) = (paths.next(), paths.next()) else {
        println!(
            "give the film and the picture: film_fit -- sample_2.avi docs/pictures/film-fit.png"
        );
        return;
    };
    let setting = |key: &str, value: Value| (find(key).unwrap(), value);
    let fit = FitCell {
        to: vec![film],
        settings: vec![
            setting("shape.pixel_size", Value::Text(PIXEL.to_owned())),
            setting("segmentation.allow_cut", Value::Flag(true)),
        ],
        table: TableOptions { frame_rate_per_s: Some(FRAMES_PER_S), ..TableOptions::default() },
        ..FitCell::default()
    };
    let fits = fit.run(&Files::default(), &()).unwrap();
    let shapes = fits.shapes.as_ref().unwrap();
    println!("{}", shapes.words());
    let figure = shapes.overlay(SHARP).unwrap().unwrap();
    files::write(&picture, figure.to_png(DPI).unwrap()).unwrap();
}
