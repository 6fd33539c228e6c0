//! Confidence asks whether it is a heart cell: what is none stays below what `batch` takes, and of two outlines the better
//! one does not score less.

use crate::common::Sample;
use crate::common::{pixels_of, shared_data};
use crate::no_cell::{Object, Taken, picture, uniform_block};
use crate::synthetic_cell::Scene;
use myospring::microscopy::burned_in;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::fibres::{FibreSettings, Stain};
use myospring::microscopy::plane::Plane;
use myospring::microscopy::segment::{
    Choice, Confidence, Segmentation, SegmentationSettings, segment,
};

/// As the picture is looked at: without marks.
fn found(plane: &Plane, pixel_um: f64) -> Option<Segmentation> {
    let clean = burned_in::painted_over(plane).map(|found| found.plane);
    let clean = clean.unwrap_or_else(|| plane.clone());
    segment(&clean, pixels_of(pixel_um), &SegmentationSettings::default()).ok()
}

#[test]
#[ignore = "slow"]
fn nothing_that_is_no_whole_heart_cell_is_sure_at_any_scale_noise_contrast_and_depth() {
    let mut sample = Sample::one_in(4);
    // Pixel, um, brightness, noise, largest value.
    let ways = [
        (0.25, 150.0, 3.0, 255.0),
        (0.25, 600.0, 3.0, 255.0),
        (0.5, 150.0, 10.0, 255.0),
        (0.25, 20000.0, 300.0, 65535.0),
        (0.4, 60.0, 5.0, 255.0),
    ];
    for object in Object::ALL {
        for (pixel_um, bright, noise, largest) in ways {
            if sample.leaves_out() {
                continue;
            }
            let plane = picture(object, Taken { pixel_um, bright, noise, largest, seed: 3 });
            let Some(found) = found(&plane, pixel_um) else { continue };
            for cell in &found.cells {
                let sure = &cell.confidence;
                let way = (pixel_um, bright, noise);
                assert!(sure.is_doubtful(), "{object:?}, {way:?}: {cell:?}");
                assert!(!sure.reasons.is_empty(), "{object:?}, {way:?}: {cell:?}");
            }
        }
    }
}

#[test]
fn a_scale_bar_and_letters_are_painted_over_and_said_wherever_they_lie() {
    for (pixel_um, bright, noise, largest) in
        [(0.25, 600.0, 3.0, 255.0), (0.5, 150.0, 10.0, 255.0), (0.25, 20000.0, 300.0, 65535.0)]
    {
        let plane = picture(Object::Caption, Taken { pixel_um, bright, noise, largest, seed: 5 });
        let found = burned_in::painted_over(&plane).unwrap();
        assert!(found.note.contains("burned into the picture"), "{}", found.note);
        let left = found.plane.values().iter().filter(|&&value| value >= 0.99 * largest as f32);
        assert_eq!(left.count(), 0, "{pixel_um} um, {bright}");
        // The marks cover 1.4 % of the frame, with rims of three pixels up to 6 % of the smallest picture.
        let marked = found.marks.iter().filter(|&&mark| mark).count();
        assert!(marked < plane.values().len() / 15, "{marked}");
    }
}

#[test]
fn a_cell_that_was_sure_stays_sure_at_any_scale_noise_contrast_and_overexposure() {
    let clear = Scene::default();
    for scene in [
        clear,
        Scene { pixel_um: 0.5, ..clear },
        Scene { pixel_um: 1.3, field_um: 400.0, ..clear },
        Scene { noise: 100.0, ..clear },
        Scene { contrast: 0.05, ..clear },
        Scene { blur_um: 0.8, ..clear },
        Scene { nuclei: true, ..clear },
        Scene { half_width_um: 30.0, pixel_um: 0.4, ..clear },
    ] {
        let truth = scene.fluorescence();
        assert!(burned_in::painted_over(&truth.plane).is_none(), "{scene:?}");
        let found = found(&truth.plane, scene.pixel_um).unwrap();
        let cell = found.choose(Choice::Largest, false).unwrap();
        assert!(cell.confidence.score >= 0.75, "{scene:?}: {:?}", cell.confidence);
        if scene.pixel_um > 1.0 {
            // No lens blurs an edge over more than such a pixel: clipped stripes look drawn.
            continue;
        }
        // Overexposed by two.
        let clipped = truth.plane.map(|value| value.min((100.0 + 500.0 * scene.contrast) as f32));
        assert!(burned_in::painted_over(&clipped).is_none(), "clipped, {scene:?}");
        let scene = Scene { contrast: 0.25, noise: scene.noise.min(40.0), ..scene };
        assert!(burned_in::painted_over(&scene.brightfield().plane).is_none(), "{scene:?}");
    }
}

#[test]
fn the_whole_of_a_cell_with_a_dim_half_is_found_and_scores_more_than_its_bright_half() {
    let mut sample = Sample::one_in(5);
    for dim_half in [0.7, 0.4, 0.2, 0.12] {
        for noise in [5.0, 20.0] {
            if sample.leaves_out() {
                continue;
            }
            let scene =
                Scene { dim_half, noise, pixel_um: 0.4, field_um: 130.0, ..Scene::default() };
            let truth = scene.fluorescence();
            let judged = |threshold| {
                let settings =
                    SegmentationSettings { threshold, ..SegmentationSettings::default() };
                let found = segment(&truth.plane, pixels_of(0.4), &settings).unwrap();
                let cell = found.choose(Choice::Largest, true).unwrap();
                let dice = truth.dice(found.numbers.iter().map(|&number| number == cell.number));
                (dice, cell.confidence.clone())
            };
            let (dice, whole) = judged(None);
            let place = format!("half at {dim_half}, noise {noise}");
            assert!(dice >= 0.94, "{place}: Dice {dice}, {whole:?}");
            assert!(!whole.is_doubtful(), "{place}: {whole:?}");
            let (dice, half) = judged(Some(500.0));
            assert!(dice < 0.7, "{place}: Dice {dice}");
            assert!(half.is_doubtful() && half.score < whole.score, "{place}: {half:?}, {whole:?}");
        }
    }
}

#[test]
#[ignore = "slow"]
fn a_uniform_block_is_never_surely_a_cell_whatever_its_size_noise_blur_and_pixel() {
    let mut sample = Sample::one_in(5);
    for (size_um, pixel_um) in [(25.0, 0.25), (60.0, 0.25), (60.0, 0.65), (110.0, 0.5)] {
        for lens_um in [0.3, 0.8] {
            for noise in [4.0, 100.0, 200.0, 400.0] {
                if sample.leaves_out() {
                    continue;
                }
                let plane = uniform_block(size_um, pixel_um, noise, lens_um);
                let Some(found) = found(&plane, pixel_um) else { continue };
                // Where noise and blur hide all texture, it may be a cell; that is said. A striped cell that is blurred as
                // much looks the same.
                let sharp = pixel_um < 0.3 && lens_um < 0.5;
                let hidden = noise / 400.0 >= if sharp { 0.5 } else { 0.25 };
                let most = if hidden { 0.61 } else { 0.01 };
                for cell in found.cells.iter().filter(|cell| cell.area_um2 > 150.0) {
                    let way = (size_um, pixel_um, lens_um, noise);
                    assert!(cell.confidence.score <= most, "{way:?}: {cell:?}");
                    assert!(!cell.confidence.reasons.is_empty(), "{way:?}: {cell:?}");
                }
            }
        }
    }
}

#[test]
fn a_dim_half_that_noise_hides_from_single_pixels_is_not_forgotten() {
    for (pixel_um, dim_half, noise) in [
        (0.25, 0.06, 50.0),
        (0.4, 0.06, 50.0),
        (0.25, 0.06, 100.0),
        (0.25, 0.03, 20.0),
        (0.25, 0.01, 5.0),
        (0.25, 0.01, 20.0),
        (0.4, 0.06, 100.0),
        (0.4, 0.01, 5.0),
        (0.8, 0.06, 5.0),
        (0.8, 0.06, 20.0),
        (0.8, 0.06, 50.0),
        (0.8, 0.03, 5.0),
        (0.8, 0.03, 20.0),
        (0.8, 0.01, 5.0),
    ] {
        let scene = Scene { dim_half, noise, pixel_um, field_um: 130.0, ..Scene::default() };
        let truth = scene.fluorescence();
        let found = found(&truth.plane, pixel_um).unwrap();
        let cell = found.choose(Choice::Largest, true).unwrap();
        let dice = truth.dice(found.numbers.iter().map(|&number| number == cell.number));
        assert!(dice < 0.8, "the half is found: this asks nothing");
        let way = (pixel_um, dim_half, noise);
        assert!(cell.confidence.score < 0.75, "{way:?}: {:?}", cell.confidence);
        let words = cell.confidence.reasons.join("; ");
        assert!(words.contains("part of something larger"), "{way:?}: {words}");
    }
}

#[test]
#[ignore = "slow"]
fn a_blurred_cell_is_neither_sure_nor_hopeless_and_the_blur_is_said() {
    let mut sample = Sample::one_in(7);
    for pixel_um in [0.1, 0.25, 0.5] {
        for (blur_um, contrast, noise) in [
            (0.8, 0.3, 100.0),
            (0.8, 1.0, 100.0),
            (1.2, 1.0, 10.0),
            (1.2, 0.1, 10.0),
            (1.2, 0.3, 50.0),
            (2.0, 1.0, 10.0),
        ] {
            if sample.leaves_out() {
                continue;
            }
            let scene = Scene { pixel_um, contrast, noise, blur_um, ..Scene::default() };
            let truth = scene.fluorescence();
            let found = found(&truth.plane, pixel_um).unwrap();
            let cell = found.choose(Choice::Largest, true).unwrap();
            let way = (pixel_um, blur_um, contrast, noise);
            let dice = truth.dice(found.numbers.iter().map(|&number| number == cell.number));
            assert!(dice > 0.9, "{way:?}: Dice {dice}");
            let Confidence { score, reasons, .. } = &cell.confidence;
            assert!(*score >= 0.4, "{way:?}: {:?}", cell.confidence);
            if blur_um > 1.0 {
                assert!(*score <= 0.61, "{way:?}: {:?}", cell.confidence);
                let words = reasons.join("; ");
                assert!(words.contains("blur"), "{way:?}: {words}");
            }
        }
    }
}

#[test]
fn a_cell_on_a_page_is_doubtful_and_the_page_is_named() {
    let truth = Scene { noise: 20.0, ..Scene::default() }.fluorescence();
    let width = truth.plane.width();
    let page = |paper: f32, border: usize| {
        let side = width + 2 * border;
        let value = |at: usize| {
            let (column, row) = (at % side, at / side);
            let inside = |place: usize| (border..border + width).contains(&place);
            if inside(column) && inside(row) {
                truth.plane.at(column - border, row - border)
            } else {
                paper
            }
        };
        Plane::new(side, side, (0..side * side).map(value).collect()).unwrap()
    };
    let [_, high] = truth.plane.range();
    for paper in [high, 0.8 * high] {
        let Some(found) = found(&page(paper, 60), 0.25) else { continue };
        assert!(
            found.notes.join("; ").contains("looks like a figure or a page"),
            "{:?}",
            found.notes
        );
        assert!(found.cells.iter().all(|cell| cell.confidence.is_doubtful()), "{:?}", found.cells);
    }
    let own = found(&truth.plane, 0.25).unwrap();
    assert!(own.notes.is_empty() && own.cells[0].confidence.score > 0.95);
}

/// The cells of a real picture.
fn real(file: &str, pixel_um: Option<f64>) -> Option<PictureCells> {
    let bytes = std::fs::read(shared_data(&format!("images/{file}"))?).unwrap();
    let options =
        PictureOptions { pixel_size: pixel_um.map(pixels_of), ..PictureOptions::default() };
    Some(PictureCells::find(&bytes, &options).unwrap())
}

#[test]
#[ignore = "slow"]
fn of_real_sheets_tissues_and_captions_no_cell_is_sure() {
    if crate::common::left_to_full() {
        return;
    }
    for (file, pixel_um, words) in [
        ("sh_mp1_f0.png", 0.483, ["burned into", "looks like a sheet"]),
        ("aics97A.png", 0.156, ["burned into", "looks like a sheet"]),
        ("sg4_crop.png", 0.1195, ["looks like a sheet", "--whole-frame"]),
        ("microbundle_0.tif", 0.25, ["looks like a sheet", "--whole-frame"]),
        ("mob3_wga.png", 0.13, ["", ""]),
    ] {
        let Some(cells) = real(file, Some(pixel_um)) else { return };
        for cell in &cells.segmentation().unwrap().cells {
            assert!(cell.confidence.is_doubtful(), "{file}: {cell:?}");
            let warning = cell.confidence.warning().unwrap();
            assert!(
                warning.contains("--outline") && warning.contains("--whole-frame"),
                "{warning}"
            );
        }
        let notes = cells.notes.join("; ");
        assert!(words.iter().all(|word| notes.contains(word)), "{file}: {notes}");
    }
}

#[test]
fn real_cells_are_as_sure_as_before() {
    for (file, pixel_um, least) in [
        ("contrax_brightfield.tif", Some(0.27), 0.70),
        ("sarcgraph_e5_fluorescence.png", Some(0.27), 0.90),
        ("sarcgraph_e2_rest.png", Some(0.18), 0.50),
        ("morphoscript_test3.tif", None, 0.95),
    ] {
        let Some(cells) = real(file, pixel_um) else { return };
        let cell = cells.cell(Choice::Largest, true).unwrap();
        // Two digits are what is printed.
        assert!(cell.confidence.score >= least - 0.005, "{file}: {:?}", cell.confidence);
    }
    let Some(cells) = real("biif_neonatal.png", Some(1.0)) else { return };
    let found = &cells.segmentation().unwrap().cells;
    let sure = found.iter().filter(|cell| cell.confidence.score >= 0.75).count();
    assert!(sure >= 5, "{sure} of {}", found.len());
}

#[test]
fn the_sarcomeres_of_a_sheet_are_read_without_an_outline_and_not_from_its_marks() {
    let taken = Taken { pixel_um: 0.25, bright: 150.0, noise: 3.0, largest: 255.0, seed: 3 };
    let fibres = |object| {
        let plane = picture(object, taken);
        let side = plane.width() as u32;
        let samples: Vec<u8> = plane.values().iter().map(|&value| value as u8).collect();
        let bytes = crate::common::png([side, side], 1, &samples);
        let options =
            PictureOptions { pixel_size: Some(pixels_of(0.25)), ..PictureOptions::default() };
        let cells = PictureCells::unsegmented(&bytes, &options).unwrap();
        cells.fibres_of_frame(&FibreSettings::of(Stain::ZDisc)).unwrap().summary()
    };
    let sheet = fibres(Object::Sheet);
    assert!(sheet.share_from_picture > 0.8, "{sheet:?}");
    // The stripes are 1.9 um apart along x, less where they are slanted by up to 13 degrees.
    assert!((sheet.median_sarcomere_um.unwrap() - 1.88).abs() < 0.05, "{sheet:?}");
    assert_eq!(fibres(Object::Post).share_from_picture, 0.0);
}

#[test]
fn stripes_of_a_cell_are_no_marks_however_crisp() {
    // An ellipse with stripes 1.9 um apart, without blur and with few grey values: edges as sharp as those of letters.
    for pixel_um in [0.2, 0.35, 0.5, 0.7] {
        let value = |at: usize| {
            let (x, y) = ((at % 240) as f64, (at / 240) as f64);
            let (u, v) = ((x - 120.0) / 80.0, (y - 60.0) / 24.0);
            let stripes = 0.6 + 0.4 * (x * pixel_um * std::f64::consts::TAU / 1.9).cos();
            let light = if u * u + v * v < 1.0 { 200.0 * stripes } else { 0.0 };
            ((20.0 + light) as u8 + ((at % 240 * 7 + at / 240 * 13) % 5) as u8).into()
        };
        let plane = Plane::new(240, 120, (0..240 * 120).map(value).collect()).unwrap();
        assert!(burned_in::painted_over(&plane).is_none(), "pixels of {pixel_um} um");
    }
}
