//! Three pictures of made-up cells to try the program with, pixels of 0.25 um; one has nuclei.
//!
//! ```text
//! cargo run --release -p myospring --example synthetic_pictures pictures
//! ```
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "it says what it wrote; pictures of its own"
)]

#[path = "../tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use std::fs::File;
use std::path::PathBuf;

use synthetic_cell::{Scene, Truth};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "pictures".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let scene = Scene { vignette: 0.2, beads: 4.0, ..Scene::default() };
    let fluorescence = Scene { haze: 60.0, contrast: 0.5, noise: 15.0, ..scene }.fluorescence();
    let nuclei = Scene { nuclei: true, ..Scene::default() }.fluorescence();
    let brightfield = Scene { contrast: 0.25, noise: 20.0, ..scene }.brightfield();
    for (name, Truth { plane, .. }) in [
        ("fluorescence.png", fluorescence),
        ("nuclei.png", nuclei),
        ("brightfield.png", brightfield),
    ] {
        let (width, height) = (plane.width() as u32, plane.height() as u32);
        let pixels = plane.values().iter().flat_map(|&value| (value as u16).to_be_bytes());
        let file = folder.join(name);
        let mut encoder = png::Encoder::new(File::create(&file)?, width, height);
        encoder.set_depth(png::BitDepth::Sixteen);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header()?.write_image_data(&pixels.collect::<Vec<u8>>())?;
        println!("{}", file.display());
    }
    Ok(())
}
