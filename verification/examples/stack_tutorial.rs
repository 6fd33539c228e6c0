//! The file of the tutorial *From a stack to a thick cell*: a made-up dome with z-discs whose fibres turn through its thickness.
//!
//! `cargo run --release -p myospring-verification --example stack_tutorial -- examples/tutorial` writes it and says the truth.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that writes a file")]

#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use myospring::output::files;
use std::f64::consts::TAU;
use std::io::Cursor;
use std::path::PathBuf;
use synthetic_cell::Random;
use tiff::encoder::colortype::Gray8;
use tiff::encoder::{Compression, DeflateLevel, Rational, TiffEncoder};
use tiff::tags::{ResolutionUnit, Tag};

const PIXEL_UM: f64 = 0.3;
const STEP_UM: f64 = 1.0;
/// Columns, rows and slices.
const SIZE: [u32; 3] = [380, 110, 13];
/// Half the length and half the width of the cell, um, and its height above its lower face at 1.5 um.
const HALF_UM: [f64; 2] = [50.0, 12.0];
const LOWEST_UM: f64 = 1.5;
const HEIGHT_UM: f64 = 9.0;
const SARCOMERE_UM: f64 = 1.85;
/// Angle by which the fibres turn from the lower face to the height of the cell, degrees.
const TURN_DEG: f64 = 30.0;
/// Width of the edges that the microscope blurs, um: in the plane and in depth.
const BLUR_UM: [f64; 2] = [0.25, 0.6];

fn main() {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap());
    files::write(&folder.join("stack.tif"), stack()).unwrap();
    let fine = 0.1;
    let columns = (2.0 * HALF_UM[0] / fine) as usize;
    let rows = (2.0 * HALF_UM[1] / fine) as usize;
    let volume: f64 = (0..columns * rows)
        .map(|at| {
            let x = fine * ((at % columns) as f64 + 0.5) - HALF_UM[0];
            let y = fine * ((at / columns) as f64 + 0.5) - HALF_UM[1];
            height(x, y) * fine * fine
        })
        .sum();
    println!("volume {volume:.0} um^3, height {HEIGHT_UM} um, fibres turn by {TURN_DEG} degrees");
}

/// Height of the upper above the lower face, um.
fn height(x: f64, y: f64) -> f64 {
    let square = (x / HALF_UM[0]).powi(4) + (y / HALF_UM[1]).powi(2);
    HEIGHT_UM * (1.0 - square).max(0.0).sqrt()
}

/// The stack, as ImageJ saves one.
fn stack() -> Vec<u8> {
    let [columns, rows, slices] = SIZE;
    let mut random = Random(5);
    let mut bytes = Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Best));
    for slice in 0..slices {
        let z = STEP_UM * (f64::from(slice) + 0.5) - LOWEST_UM;
        let grey = |at: u32, random: &mut Random| {
            let x = PIXEL_UM * (f64::from(at % columns) + 0.5 - 0.5 * f64::from(columns));
            let y = PIXEL_UM * (0.5 * f64::from(rows) - f64::from(at / columns) - 0.5);
            // How far inside, um, in depth and in the plane.
            let square = (x / HALF_UM[0]).powi(4) + (y / HALF_UM[1]).powi(2);
            let in_plane = (1.0 - square) * 0.5 * HALF_UM[1] / BLUR_UM[0];
            let in_depth = z.min(height(x, y) - z) / BLUR_UM[1];
            let inside = 1.0 / (1.0 + (-1.7 * in_depth.min(in_plane)).exp());
            let turned = TURN_DEG * (z / HEIGHT_UM).clamp(0.0, 1.0) - 0.5 * TURN_DEG;
            let (sine, cosine) = turned.to_radians().sin_cos();
            let wave = (TAU * (cosine * x + sine * y) / SARCOMERE_UM).cos();
            let bright = 6.0 + inside * (110.0 + 60.0 * wave);
            (bright + 0.35 * bright.sqrt() * random.normal()).clamp(0.0, 255.0) as u8
        };
        let pixels: Vec<u8> = (0..columns * rows).map(|at| grey(at, &mut random)).collect();
        let mut image = encoder.new_image::<Gray8>(columns, rows).unwrap();
        if slice == 0 {
            let about = format!(
                "ImageJ=1.54f\nimages={slices}\nslices={slices}\nunit=micron\nspacing={STEP_UM}\nloop=false\n"
            );
            image.encoder().write_tag(Tag::ImageDescription, about.as_str()).unwrap();
        }
        let per_um = Rational { n: (1e6 / PIXEL_UM) as u32, d: 1_000_000 };
        image.resolution(ResolutionUnit::None, per_um);
        image.write_data(&pixels).unwrap();
    }
    bytes.into_inner()
}
