//! Hot pixels neither hide a cell nor pass unnoticed, and what is no hot pixel stays as it is.

use crate::common::pixels_of;
use crate::synthetic_cell::{Scene, Truth};
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::hot_pixels::cooled;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::segment::Choice;
use myospring::run_file::RunFile;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::Gray32Float;

fn changed(plane: &Plane, pixels: &[(usize, usize, f32)]) -> Plane {
    let mut values = plane.values().to_vec();
    for &(column, row, value) in pixels {
        values[row * plane.width() + column] = value;
    }
    Plane::new(plane.width(), plane.height(), values).unwrap()
}

fn written(plane: &Plane) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let size = [plane.width(), plane.height()].map(|side| side as u32);
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<Gray32Float>(size[0], size[1], plane.values()).unwrap();
    bytes.into_inner()
}

fn found(plane: &Plane, pixel_um: f64) -> PictureCells {
    let options =
        PictureOptions { pixel_size: Some(pixels_of(pixel_um)), ..PictureOptions::default() };
    PictureCells::find(&written(plane), &options).unwrap()
}

fn dice(truth: &Truth, cells: &PictureCells) -> f64 {
    let found = cells.segmentation().unwrap();
    let cell = found.choose(Choice::Largest, false).unwrap().number;
    truth.dice(found.numbers.iter().map(|&number| number == cell))
}

#[test]
fn a_cell_is_found_as_well_with_hot_pixels_as_without_and_they_are_counted() {
    let scene = Scene { contrast: 0.25, ..Scene::default() };
    for (kind, truth) in
        [("fluorescence", scene.fluorescence()), ("brightfield", scene.brightfield())]
    {
        let clear = found(&truth.plane, scene.pixel_um);
        assert!(clear.notes.is_empty() && clear.modality() == kind, "{:?}", clear.notes);
        for (pixels, note) in [
            (vec![(12, 30, 1e38)], "1 hot pixel, 1e38 at column 12, row 30, was replaced"),
            (vec![(0, 0, 65535.0)], "1 hot pixel, 65535 at column 0, row 0, was replaced"),
            (vec![(5, 9, -3.4e38), (6, 9, 3.4e38)], "2 hot pixels, the most extreme"),
            (
                vec![(40, 60, 1e8), (200, 100, 1e6), (300, 2, 1e5)],
                "3 hot pixels, the most extreme 1e8 at column 40, row 60, were replaced",
            ),
        ] {
            let hot = found(&changed(&truth.plane, &pixels), scene.pixel_um);
            assert!(hot.notes[0].starts_with(note), "{:?}", hot.notes);
            assert_eq!((hot.notes.len(), hot.modality()), (1, kind));
            // A pixel or four of the noise have moved, no more.
            let (without, with) = (dice(&truth, &clear), dice(&truth, &hot));
            assert!((without - with).abs() < 0.002, "{kind} {note}: {without} {with}");
            let ([low, high], [least, most]) = (clear.plane.range(), hot.plane.range());
            assert!(least >= low && most <= high, "{kind} {note}");
        }
    }
}

#[test]
fn noise_dots_lines_and_labels_are_no_hot_pixels() {
    let noise = |at: usize| (at.wrapping_mul(2_654_435_761) >> 7) as u32 % 21;
    let ground: Vec<f32> = (0..300 * 200).map(|at| 100.0 + noise(at) as f32).collect();
    let ground = Plane::new(300, 200, ground).unwrap();
    assert!(cooled(&ground).is_none());
    // Dots as sharp as a pixel, some of them fifty times as bright as the ground.
    let dots: Vec<_> = (0..60)
        .map(|dot| (7 + dot * 37 % 290, 3 + dot * 29 % 190, 300.0 + 80.0 * dot as f32))
        .collect();
    assert!(cooled(&changed(&ground, &dots)).is_none());
    // One dot is beyond the ground, but not beyond what else is bright.
    let mut cell: Vec<_> = (0..40 * 40).map(|at| (50 + at % 40, 50 + at / 40, 900.0)).collect();
    cell.push((10, 10, 3000.0));
    assert!(cooled(&changed(&ground, &cell)).is_none());
    cell.push((200, 10, 4000.0));
    assert!(cooled(&changed(&ground, &cell)).is_some());
    let line: Vec<_> = (0..30).map(|step| (20 + step, 40 + step, 60_000.0)).collect();
    assert!(cooled(&changed(&ground, &line)).is_none());

    // A label of one pixel is a label.
    let mask = Plane::new(60, 40, vec![0.0; 60 * 40]).unwrap();
    let mut labels: Vec<_> = (0..20 * 20).map(|at| (5 + at % 20, 5 + at / 20, 1.0)).collect();
    labels.push((50, 30, 5000.0));
    let cells = found(&changed(&mask, &labels), 1.0);
    assert_eq!((cells.modality(), cells.len()), ("mask", 2));
    assert!(cells.notes.is_empty(), "{:?}", cells.notes);
}

#[test]
fn a_corner_of_hot_pixels_alone_has_no_neighbour_to_take_a_value_from() {
    let dark = Plane::new(8, 6, (0..48).map(|at| (at % 7) as f32).collect()).unwrap();
    let corner = [(0, 0, 1e30), (1, 0, 1e30), (0, 1, -1e30), (1, 1, -1e30)];
    assert!(cooled(&changed(&dark, &corner[..1])).is_some());
    assert!(cooled(&changed(&dark, &corner)).is_none());
}

#[test]
fn a_hot_pixel_in_a_picture_of_the_myofibrils_is_told_and_does_not_take_all_the_tension() {
    let scene = Scene::default();
    let truth = scene.fluorescence();
    let (width, height) = (truth.plane.width(), truth.plane.height());
    let text = "[shape]\npicture = \"cell.tif\"\npixel_size = \"0.25 um\"\n\
                [mechanics]\nmyofibril_content = \"content.tif\"\n";
    let run = RunFile::from_text(text).unwrap().resolve().unwrap();
    let content = |plane: &Plane| {
        let files = [("cell.tif", written(&truth.plane)), ("content.tif", written(plane))];
        let read = |file: &str| {
            let named = files.iter().find(|(name, _)| *name == file);
            named.map(|(_, bytes)| bytes.clone()).ok_or(std::io::ErrorKind::NotFound.into())
        };
        let shaped = run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap();
        let made = run.make(shaped, read).unwrap();
        (made.simulation.myofibril_content.unwrap(), made.report.warnings)
    };
    let (clear, _) = content(&truth.plane);
    let (hot, warnings) = content(&changed(&truth.plane, &[(width / 2, height / 2, 1e8)]));
    assert!(warnings.iter().any(|said| said.starts_with("`content.tif`: 1 hot pixel")));
    // A pixel of the stripes has become the median of its neighbours.
    let most = clear.iter().zip(&hot).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 0.15, "{most}");
}
