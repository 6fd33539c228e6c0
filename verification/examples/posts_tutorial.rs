//! The film of the tutorial *From a film of a tissue on posts to its force*: a made-up strip whose force is known.
//!
//! `cargo run --release -p myospring-verification --example posts_tutorial -- examples/tutorial` writes it.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that writes files")]

#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use myospring::mechanics::post::Post;
use myospring::output::files;
use myospring::recording::{END_FORCE, Sample};
use myospring::run_file::RunFile;
use std::io::Cursor;
use std::path::PathBuf;
use synthetic_cell::Random;
use tiff::encoder::colortype::Gray8;
use tiff::encoder::{Compression, DeflateLevel, Rational, TiffEncoder};
use tiff::tags::{ResolutionUnit, Tag};

/// The strip of `examples/tissue_on_posts.toml`, weaker and faster.
const TISSUE: &str = "cell.model = \"bueno_orovio_2008_epi\"\ncell.peak_tension = \"3.5 kPa\"\n\
    tissue.conduction_velocity = \"30 cm/s\"\nshape.built_in = \"tissue_strip\"\nshape.spacing = \"250 um\"\n\
    material.young_modulus = \"15 kPa\"\nmaterial.area_modulus = \"8.5 kPa\"\nmaterial.thickness = \"300 um\"\n\
    mechanics.support = \"posts\"\nmechanics.post_length = \"6 mm\"\nmechanics.post_width = \"1 mm\"\n\
    mechanics.post_modulus = \"1.6 MPa\"\nstimulus.beats = 2\nstimulus.cycle_length = \"1 s\"\nrun.duration = \"2 s\"";
const POST: Post =
    Post { length: 6000.0, load_height: None, width: 1000.0, thickness: None, modulus: 1600.0 };
const PIXEL_UM: f64 = 40.0;
const FRAMES_PER_SECOND: f64 = 30.0;
/// Of the tissue and what is seen around it, um.
const AROUND_UM: [f64; 2] = [600.0, 700.0];
/// Grey values of the ground, the tissue, its texture, and a post; and their noise.
const GREY: [f64; 4] = [190.0, 140.0, 12.0, 60.0];
const NOISE: f64 = 1.5;
/// How far the middle of a post is from the end of the tissue, um.
const INSIDE_UM: f64 = 500.0;
/// Width of the blur of an edge, um.
const BLUR_UM: f64 = 40.0;

fn main() {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap());
    let run = RunFile::from_text(TISSUE).unwrap().resolve().unwrap();
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let shaped = run.shape.mesh(&run.shape.bytes(none).unwrap()).unwrap();
    let outcome = run.make(shaped, none).unwrap().simulation.build().unwrap().run(|_| true);
    let recording = &outcome.recording;
    let force = recording.signals.iter().find(|signal| signal.name == END_FORCE).unwrap();
    println!("force {:.1} uN", 1e-3 * force.values.iter().copied().fold(0.0, f64::max));
    let rest = recording.samples[0];
    let size = [rest.length_um, rest.width_um].into_iter().zip(AROUND_UM);
    let [columns, rows] = [0, 1]
        .map(|axis: usize| size.clone().nth(axis).map_or(0.0, |(own, around)| own + 2.0 * around))
        .map(|side| (side / PIXEL_UM).ceil() as u32);
    let mut bytes = Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Best));
    let frames = (2.0 * FRAMES_PER_SECOND) as usize;
    let mut random = Random(5);
    for number in 0..frames {
        let time = 1000.0 * number as f64 / FRAMES_PER_SECOND;
        let at = recording.samples.iter().position(|sample| sample.t_ms >= time).unwrap();
        let pull = force.values[at] / POST.stiffness();
        let picture = picture([columns, rows], &rest, &recording.samples[at], pull, &mut random);
        let mut image = encoder.new_image::<Gray8>(columns, rows).unwrap();
        if number == 0 {
            let interval = 1.0 / FRAMES_PER_SECOND;
            let about = format!(
                "ImageJ=1.54f\nimages={frames}\nframes={frames}\nunit=micron\nfinterval={interval}\nloop=false\n"
            );
            image.encoder().write_tag(Tag::ImageDescription, about.as_str()).unwrap();
        }
        let per_um = Rational { n: (1e6 / PIXEL_UM) as u32, d: 1_000_000 };
        image.resolution(ResolutionUnit::None, per_um);
        image.write_data(&picture).unwrap();
    }
    files::write(&folder.join("strip.tif"), bytes.into_inner()).unwrap();
}

/// One frame: the tissue as long and wide as it is then, and two posts that are so much nearer to each other.
fn picture(
    [columns, rows]: [u32; 2],
    rest: &Sample,
    now: &Sample,
    pull: f64,
    random: &mut Random,
) -> Vec<u8> {
    let [ground, tissue, texture, post] = GREY;
    let edge = |inside: f64| 1.0 / (1.0 + (-inside / BLUR_UM).exp());
    let [longer, wider] = [now.length_um / rest.length_um, now.width_um / rest.width_um];
    let pixel = |number: u32| {
        let place = [number % columns, number / columns].map(f64::from);
        let [x, y] = [(place[0], columns), (place[1], rows)]
            .map(|(at, of)| PIXEL_UM * (at - 0.5 * (f64::from(of) - 1.0)));
        let inside = edge(0.5 * now.length_um - x.abs()) * edge(0.5 * now.width_um - y.abs());
        let [u, v] = [x / longer / 150.0, y / wider / 110.0];
        let pattern = (u + 1.7 * (0.6 * v).sin()).sin() * (v - 1.3 * (0.5 * u).cos()).sin();
        let body = tissue + texture * pattern;
        let seen = ground + inside * (body - ground);
        let middle = 0.5 * rest.length_um - INSIDE_UM - pull;
        let away = (x.abs() - middle).hypot(y);
        let on_post = edge(0.5 * POST.width - away);
        (seen + on_post * (post - seen) + NOISE * random.normal()).round().clamp(0.0, 255.0) as u8
    };
    (0..columns * rows).map(pixel).collect()
}
