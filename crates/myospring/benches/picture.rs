//! From the bytes of a picture to a mesh, on one core: `cargo bench -p myospring --bench picture`.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark of a picture of its own")]

#[path = "../tests/common/synthetic_cell.rs"]
mod synthetic_cell;

use std::hint::black_box;
use std::io::Cursor;

use criterion::{Criterion, criterion_group, criterion_main};
use myospring::mesh::lattice;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::segment::Choice;
use synthetic_cell::{Scene, Truth};
use tiff::encoder::{TiffEncoder, colortype::Gray16};

/// Pixels along a side.
const SIDE: usize = 2048;

/// 2048 x 2048 pixels of 16 bits, as a camera gives them: the scene, over and over.
fn tiff(truth: &Truth) -> Vec<u8> {
    let tile = truth.plane.width();
    let at = |pixel: usize| truth.plane.at(pixel % SIDE % tile, pixel / SIDE % tile) as u16;
    let pixels: Vec<u16> = (0..SIDE * SIDE).map(at).collect();
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<Gray16>(SIDE as u32, SIDE as u32, &pixels).unwrap();
    bytes.into_inner()
}

fn picture_to_mesh(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("picture of 2048 x 2048, 16 bit, to mesh");
    group.sample_size(10);
    // Contrasts that the two kinds of picture have.
    let fluorescence = (1.0, Scene::fluorescence as fn(&Scene) -> Truth);
    let brightfield = (0.25, Scene::brightfield as fn(&Scene) -> Truth);
    for (name, pixel_um, cells_along_a_side, (contrast, draw)) in [
        ("fluorescence, pixels of 0.1 um", 0.1, 1, fluorescence),
        ("fluorescence, pixels of 0.27 um", 0.27, 1, fluorescence),
        ("fluorescence, pixels of 0.27 um, 16 cells", 0.27, 4, fluorescence),
        ("brightfield, pixels of 0.1 um", 0.1, 1, brightfield),
        ("brightfield, pixels of 0.27 um", 0.27, 1, brightfield),
        ("brightfield, pixels of 0.27 um, 16 cells", 0.27, 4, brightfield),
    ] {
        let field_um = (SIDE / cells_along_a_side) as f64 * pixel_um;
        let scene = Scene { pixel_um, field_um, contrast, beads: 2.0, ..Scene::default() };
        let bytes = tiff(&draw(&scene));
        let options = PictureOptions {
            pixel_size: Some(PixelSize::new(pixel_um).unwrap()),
            ..PictureOptions::default()
        };
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let cells = PictureCells::find(black_box(&bytes), &options).unwrap();
                let cell = cells.cell(Choice::Largest, true).unwrap();
                lattice::from_mask(&cell.mask, None).unwrap()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, picture_to_mesh);
criterion_main!(benches);
