//! What segmentation and fibres make of real pictures with defaults, as a table of `docs/reference/accuracy.md`.
//!
//! ```text
//! MYOSPRING_SHARED_DATA=folder cargo run --release -p myospring-verification --example real_pictures
//! ```
//!
//! The folder has `images/`, with the pictures and masks that the table names; where they are from stands in
//! `docs/reference/accuracy.md`. A picture that is not there is left out, and said.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::unwrap_used,
    reason = "it prints a table"
)]

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::fibres::{FibreSettings, Stain};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use myospring::microscopy::segment::{Choice, Segmentation};
use std::fs;
use std::path::Path;
use std::time::Instant;

/// Picture, mask by others or by hand, and pixel, um, where the picture does not say it.
const PICTURES: [(&str, Option<&str>, Option<f64>); 8] = [
    ("contrax_brightfield.tif", Some("contrax_brightfield_mask.png"), Some(0.27)),
    ("sarcgraph_e5_fluorescence.png", Some("sarcgraph_e5_mask.png"), Some(0.27)),
    ("sarcgraph_e2_rest.png", Some("sarcgraph_e2_mask.png"), Some(0.18)),
    ("morphoscript_test3.tif", Some("morphoscript_test3_mask.png"), None),
    ("biif_neonatal.png", Some("biif_neonatal_mask.png"), Some(1.0)),
    ("microbundle_0.tif", Some("microbundle_0_mask.png"), Some(0.25)),
    ("sarcgraph_e1_rest.png", None, Some(0.18)),
    ("sarcgraph_sample_5.png", None, Some(0.18)),
];

/// Dice's coefficient of the cells for which `is` says so with a mask.
fn dice(found: &Segmentation, mask: &Plane, is: impl Fn(u32) -> bool) -> f64 {
    let (mut both, mut all) = (0_u32, 0_u32);
    for (&number, &truth) in found.numbers.iter().zip(mask.values()) {
        both += u32::from(is(number) && truth > 0.0);
        all += u32::from(is(number)) + u32::from(truth > 0.0);
    }
    2.0 * f64::from(both) / f64::from(all)
}

/// Largest memory since the last call, MB, where the system tells it.
fn peak_megabytes() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    fs::write("/proc/self/clear_refs", "5").ok()?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn row(folder: &Path, (picture, mask, pixel): (&str, Option<&str>, Option<f64>)) -> Option<String> {
    let bytes = fs::read(folder.join(picture)).ok()?;
    let pixel_size = pixel.map(|pixel| PixelSize::new(pixel).unwrap());
    peak_megabytes();
    let start = Instant::now();
    let cells =
        PictureCells::find(&bytes, &PictureOptions { pixel_size, ..PictureOptions::default() });
    let seconds = start.elapsed().as_secs_f64();
    let memory = peak_megabytes().map_or(String::new(), |memory| format!("{memory:.0}"));
    let cells = match cells {
        Ok(cells) => cells,
        Err(error) => return Some(format!("| {picture} | {error} |")),
    };
    let found = cells.segmentation()?;
    let cell = cells.cell(Choice::Largest, true).ok()?;
    let dice = mask.map_or(String::new(), |mask| {
        let mask = fs::read(folder.join(mask)).unwrap();
        let mask = read_picture(&mask, &Selection::default()).unwrap().plane;
        let (one, all) = (
            dice(found, &mask, |number| number == cell.number),
            dice(found, &mask, |number| number > 0),
        );
        format!("{one:.3} ({all:.3})")
    });
    let start = Instant::now();
    let (y, x) = cell.shape.dimensions.long_axis_deg.to_radians().sin_cos();
    let fibres = cells.fibres(&cell, [x, y], &FibreSettings::of(Stain::ZDisc));
    let fibre_seconds = start.elapsed().as_secs_f64();
    let fibres = fibres.map_or(String::new(), |field| {
        let summary = field.summary();
        let length = summary.median_sarcomere_um;
        let length = length.map_or(String::new(), |length| format!("{length:.2}"));
        format!("{:.0} % | {length} | {fibre_seconds:.2}", 100.0 * summary.share_from_picture)
    });
    Some(format!(
        "| {picture} | {} | {} | {dice} | {:.0}{} | {:.2} | {seconds:.2} | {memory} | {fibres} |",
        cells.modality(),
        found.cells.len(),
        cell.shape.area_um2,
        if cell.shape.pixels_on_frame > 0 { ", cut" } else { "" },
        cell.confidence.score,
    ))
}

fn main() {
    let Some(folder) = std::env::var_os("MYOSPRING_SHARED_DATA") else {
        eprintln!("set MYOSPRING_SHARED_DATA to the folder that has images/");
        std::process::exit(2);
    };
    println!(
        "| picture | kind | cells | Dice of the largest (of all) | area, um^2 | confidence | s | MB | read | \
         sarcomeres, um | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for picture in PICTURES {
        match row(&Path::new(&folder).join("images"), picture) {
            Some(row) => println!("{row}"),
            None => eprintln!("{} is not there", picture.0),
        }
    }
}
