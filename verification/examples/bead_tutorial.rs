//! The files of the tutorial *Tension in kPa*: a film of beads in a gel under a made-up cell whose tension and stiffness are
//! known, its outline and a region around it, and its length before it was plated.
//!
//! `cargo run --release -p myospring-verification --example bead_tutorial -- examples/tutorial` writes them.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that writes files")]

#[path = "../../crates/myospring/tests/common/bead_film.rs"]
mod bead_film;
#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use bead_film::{BeadScene, displacement};
use myospring::mechanics::compliance::Compliance;
use myospring::mechanics::gel::{Gel, GelBed};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::Mesh;
use myospring::output::files;
use myospring::recording::{AXIAL_FORCE, Frame};
use myospring::run_file::RunFile;
use myospring::simulation::{Outcome, Simulation};
use std::io::Cursor;
use std::path::PathBuf;
use synthetic_cell::Random;
use tiff::encoder::colortype::Gray8;
use tiff::encoder::{Compression, DeflateLevel, Rational, TiffEncoder};
use tiff::tags::{ResolutionUnit, Tag};

/// The cell that is to be found: Young's modulus and peak tension, kPa.
const CELL: &str = "shape.built_in = \"hipsc_derived\"\nmaterial.young_modulus = \"40 kPa\"\nmaterial.area_modulus = \
                    \"22.7 kPa\"\nmaterial.thickness = \"5 um\"\ncell.peak_tension = \"2.7 kPa\"\nnumerics.integrator = \
                    \"quasi-static\"\nnumerics.frame_interval = \"50 ms\"";
const GEL_KPA: f64 = 10.0;
/// Gel that is seen around the cell, and how much wider than the cell the region is, um.
const AROUND_UM: [f64; 2] = [12.0, 14.0];
const WIDER_UM: f64 = 2.0;
/// Noise of a length, um, and the interval of its frames, ms.
const NOISE_UM: f64 = 0.03;
const EVERY_MS: f64 = 10.0;
/// Interval of the frames of the film, ms; also in [`CELL`] and in what the film says of itself.
const FRAME_MS: f64 = 50.0;

fn main() {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap());
    let run = RunFile::from_text(CELL).unwrap().resolve().unwrap();
    let bytes = run.shape.bytes(|path| std::fs::read(path)).unwrap();
    let shaped = run.shape.mesh(&bytes).unwrap();
    let made = run.make(shaped, |path| std::fs::read(path)).unwrap();
    let outline = made.outline.clone();
    let free = made.simulation;
    let support = SupportKind::Gel(Gel::half_space(GEL_KPA));
    let plated = Simulation { support, ..free.clone() };
    let beat = |simulation: &Simulation| simulation.build().unwrap().run(|_| true);

    let file = |name: &str| folder.join(name);
    files::write(&file("free.csv"), lengths(&beat(&free))).unwrap();
    let outcome = beat(&plated);
    let force = outcome.recording.signals.iter().find(|signal| signal.name == AXIAL_FORCE).unwrap();
    println!("axial force {:.1} nN", force.values.iter().copied().fold(0.0, f64::max));
    let mesh = &plated.mesh;
    let ([low, high], scene) = scene(mesh);
    files::write(&file("beads.tif"), film(&scene, &plated, &outcome, low)).unwrap();
    let moved = |[x, y]: [f64; 2]| [x - low[0], y - low[1]];
    let ring: Vec<[f64; 2]> = outline.exterior().iter().copied().map(moved).collect();
    files::write(&file("plated.geojson"), geojson(&ring)).unwrap();
    let middle = [0, 1].map(|axis: usize| 0.5 * (high[axis] - low[axis]));
    let extent = [0, 1].map(|axis: usize| {
        ring.iter().map(|place| (place[axis] - middle[axis]).abs()).fold(0.0, f64::max)
    });
    let wider = |place: &[f64; 2]| {
        [0, 1].map(|axis: usize| {
            middle[axis] + (place[axis] - middle[axis]) * (1.0 + WIDER_UM / extent[axis])
        })
    };
    files::write(&file("around.geojson"), geojson(&ring.iter().map(wider).collect::<Vec<_>>()))
        .unwrap();
}

/// The corners of the picture in the coordinates of the mesh, and the beads.
fn scene(mesh: &Mesh) -> ([[f64; 2]; 2], BeadScene) {
    let end = |axis: usize, sign: f64| {
        mesh.points[axis].iter().map(|place| sign * place).fold(f64::NEG_INFINITY, f64::max) * sign
    };
    let low = [0, 1].map(|axis: usize| end(axis, -1.0) - AROUND_UM[axis]);
    let high = [0, 1].map(|axis: usize| end(axis, 1.0) + AROUND_UM[axis]);
    let frame_um = [0, 1].map(|axis: usize| high[axis] - low[axis]);
    (
        [low, high],
        BeadScene { frame_um, pixel_um: 0.25, photons: 200.0, seed: 7, ..BeadScene::default() },
    )
}

/// A film of the beads, as ImageJ saves one: the frames of the beat.
fn film(scene: &BeadScene, plated: &Simulation, outcome: &Outcome, low: [f64; 2]) -> Vec<u8> {
    let bed = GelBed::new(Gel::half_space(GEL_KPA), &plated.mesh, plated.long_axis).unwrap();
    let [columns, rows] = scene.size().map(|side| side as u32);
    let mut bytes = Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Best));
    // That of the peak is recorded besides.
    let on_time = |frame: &&Frame| frame.t_ms.rem_euclid(FRAME_MS) < 1e-6;
    let frames: Vec<&Frame> = outcome.recording.frames.iter().filter(on_time).collect();
    for (number, frame) in frames.iter().enumerate() {
        let forces = frame.on_gel_nn.as_ref().unwrap();
        let attached =
            [0, 1].map(|axis: usize| bed.nodes().iter().map(|&node| forces[axis][node]).collect());
        let mut surface = bed.surface(&attached, 0.7);
        for (origin, low) in surface.origin.iter_mut().zip(low) {
            *origin -= low;
        }
        let picture = scene.picture(&|at| displacement(&surface, at), [0.0; 2], number as u64);
        let mut image = encoder.new_image::<Gray8>(columns, rows).unwrap();
        if number == 0 {
            let about = format!(
                "ImageJ=1.54f\nimages={0}\nframes={0}\nunit=micron\nfinterval=0.05\nloop=false\n",
                frames.len()
            );
            image.encoder().write_tag(Tag::ImageDescription, about.as_str()).unwrap();
        }
        let per_um = Rational { n: (1e6 / scene.pixel_um) as u32, d: 1_000_000 };
        image.resolution(ResolutionUnit::None, per_um);
        image.write_data(&picture).unwrap();
    }
    bytes.into_inner()
}

/// The length of the cell with noise, a frame each 10 ms.
fn lengths(outcome: &Outcome) -> String {
    let mut random = Random(11);
    let samples = &outcome.recording.samples;
    let mut lines = vec!["t_ms,length_um".to_owned()];
    let mut time = 0.0;
    while let Some(sample) = samples.iter().find(|sample| sample.t_ms >= time) {
        lines.push(format!("{time},{:.3}", sample.length_um + NOISE_UM * random.normal()));
        time += EVERY_MS;
    }
    lines.join("\n") + "\n"
}

fn geojson(ring: &[[f64; 2]]) -> String {
    let mut places: Vec<String> = ring.iter().map(|[x, y]| format!("[{x:.2},{y:.2}]")).collect();
    places.push(places[0].clone());
    format!("{{\"type\":\"Polygon\",\"coordinates\":[[{}]]}}\n", places.join(","))
}
