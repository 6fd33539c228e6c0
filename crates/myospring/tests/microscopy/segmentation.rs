//! The cells of pictures: synthetic ones with known outlines, real ones with masks by hand, bad ones.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

use crate::common::Sample;
use crate::common::{self, pixels_of};
use crate::synthetic_cell;

use common::shared_data;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use myospring::microscopy::segment::{
    Choice, Modality, SegmentError, Segmentation, SegmentationSettings, segment,
};
use synthetic_cell::{Scene, Truth};

fn with(modality: Modality) -> SegmentationSettings {
    SegmentationSettings { modality, ..SegmentationSettings::default() }
}

fn dice(truth: &Truth, found: &Segmentation) -> f64 {
    dice_of(truth, found, false)
}

/// Of the largest cell, also if the frame cuts it where that is allowed.
fn dice_of(truth: &Truth, found: &Segmentation, allow_cut: bool) -> f64 {
    let cell = found.choose(Choice::Largest, allow_cut).unwrap().number;
    truth.dice(found.numbers.iter().map(|&number| number == cell))
}

/// Dice of a real picture's largest whole cell with its mask; without a pixel size that of the file.
fn real(picture: &str, mask: &str, pixel_um: Option<f64>) -> Option<(f64, PictureCells)> {
    let (picture, mask) = (shared_data(picture)?, shared_data(mask)?);
    let options =
        PictureOptions { pixel_size: pixel_um.map(pixels_of), ..PictureOptions::default() };
    let cells = PictureCells::find(&std::fs::read(picture).unwrap(), &options).unwrap();
    let mask = read_picture(&std::fs::read(mask).unwrap(), &Selection::default()).unwrap().plane;
    let inside = mask.values().iter().map(|&value| value > 0.0).collect();
    let truth = Truth { plane: mask, inside };
    let dice = dice(&truth, cells.segmentation().unwrap());
    Some((dice, cells))
}

#[test]
fn the_fluorescent_cell_is_found_without_any_option_but_the_pixel_size() {
    let picture = "images/sarcgraph_e5_fluorescence.png";
    let Some((dice, cells)) = real(picture, "images/sarcgraph_e5_mask.png", Some(0.27)) else {
        return;
    };
    assert_eq!(cells.modality(), "fluorescence");
    // The bar; the mask was drawn with a low threshold, which no method knows.
    assert!(dice >= 0.98, "Dice {dice}");
    let cell = cells.cell(Choice::Largest, false).unwrap();
    assert!(!cell.confidence.is_doubtful(), "{:?}", cell.confidence);
    // The blurred spot is out of focus, the cell in the corner and light at the rim are cut by the frame.
    let found = cells.segmentation().unwrap();
    for other in &found.cells[1..] {
        assert!(other.pixels_on_the_frame > 0 || other.confidence.is_doubtful(), "{other:?}");
    }
    let spot = found.choose(Choice::At([20.0, 185.0]), true).unwrap();
    assert!(spot.confidence.is_doubtful(), "{spot:?}");
}

#[test]
fn the_brightfield_cell_is_found_with_defaults() {
    let picture = "images/contrax_brightfield.tif";
    let Some((dice, cells)) = real(picture, "images/contrax_brightfield_mask.png", Some(0.27))
    else {
        return;
    };
    assert_eq!(cells.modality(), "brightfield");
    assert!(dice >= 0.90, "Dice {dice}");
}

#[test]
fn a_cell_among_neighbours_in_haze_that_fills_its_frame_is_found_with_defaults() {
    for (picture, mask, pixel_um) in [
        ("images/sarcgraph_e2_rest.png", "images/sarcgraph_e2_mask.png", Some(0.18)),
        ("images/morphoscript_test3.tif", "images/morphoscript_test3_mask.png", None),
    ] {
        let (Some(picture), Some(mask)) = (shared_data(picture), shared_data(mask)) else { return };
        let options =
            PictureOptions { pixel_size: pixel_um.map(pixels_of), ..PictureOptions::default() };
        let cells = PictureCells::find(&std::fs::read(&picture).unwrap(), &options).unwrap();
        assert_eq!(cells.modality(), "fluorescence");
        let found = cells.segmentation().unwrap();
        // Stripes of the first reach the frame.
        let mask = read_picture(&std::fs::read(mask).unwrap(), &Selection::default()).unwrap();
        let inside = mask.plane.values().iter().map(|&value| value > 0.0).collect();
        let dice = dice_of(&Truth { plane: mask.plane, inside }, found, true);
        assert!(dice >= 0.88, "Dice {dice} of {}", picture.display());
    }
}

/// From the place and value of a pixel to its new value.
type Change<'a> = &'a dyn Fn(usize, f32) -> f32;

#[test]
fn a_real_cell_is_found_however_its_picture_is_turned_scaled_lit_or_blurred_by_noise() {
    if crate::common::left_to_full() {
        return;
    }
    for (picture, mask, least) in [
        ("images/sarcgraph_e5_fluorescence.png", "images/sarcgraph_e5_mask.png", 0.96),
        ("images/contrax_brightfield.tif", "images/contrax_brightfield_mask.png", 0.90),
    ] {
        let (Some(picture), Some(mask)) = (shared_data(picture), shared_data(mask)) else { return };
        let read = |file: std::path::PathBuf| {
            read_picture(&std::fs::read(file).unwrap(), &Selection::default()).unwrap().plane
        };
        let (picture, mask) = (read(picture), read(mask));
        let (width, height) = (picture.width(), picture.height());
        // From -1 at the left to 1 at the right.
        let across = |at: usize| 2.0 * (at % width) as f32 / width as f32 - 1.0;
        // About normal, of standard deviation 10 grey values; SplitMix64 (Steele, Lea and Flood 2014).
        let uniform = |at: usize| {
            let mut z = (at as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32 - 0.5
        };
        let noise = |at: usize| 10.0 * (1..=12).map(|k| uniform(12 * at + k)).sum::<f32>();
        let changed: [(&str, Change<'_>); 4] = [
            ("as 16 bits above an offset", &|_, value| 257.0 * value + 500.0),
            ("at half the contrast", &|_, value| 60.0 + 0.5 * value),
            ("lit from one side", &|at, value| value * (1.0 + 0.4 * across(at))),
            ("under noise", &|at, value| value + noise(at)),
        ];
        let mut ways: Vec<(&str, Plane, Plane)> = Vec::new();
        for (name, change) in changed {
            let values = picture.values().iter().enumerate();
            let values = values.map(|(at, &value)| change(at, value)).collect();
            ways.push((name, Plane::new(width, height, values).unwrap(), mask.clone()));
        }
        let turned = |plane: &Plane| {
            let at = |at: usize| plane.at(at / height, at % height);
            Plane::new(height, width, (0..width * height).map(at).collect()).unwrap()
        };
        let mirrored = |plane: &Plane| {
            let at = |at: usize| plane.at(width - 1 - at % width, at / width);
            Plane::new(width, height, (0..width * height).map(at).collect()).unwrap()
        };
        ways.push(("transposed", turned(&picture), turned(&mask)));
        ways.push(("mirrored", mirrored(&picture), mirrored(&mask)));
        for (name, plane, mask) in ways {
            let found = segment(&plane, pixels_of(0.27), &SegmentationSettings::default()).unwrap();
            let inside = mask.values().iter().map(|&value| value > 0.0).collect();
            let dice = dice(&Truth { plane: mask, inside }, &found);
            assert!(dice >= least, "{name}: Dice {dice}");
        }
    }
}

#[test]
fn a_known_cell_is_found_at_any_turn_magnification_and_unevenness() {
    let clear = Scene::default();
    for scene in [
        clear,
        Scene { turn_deg: 90.0, ..clear },
        Scene { pixel_um: 0.1, field_um: 120.0, ..clear },
        Scene { pixel_um: 0.5, ..clear },
        Scene { vignette: 0.4, haze: 150.0, ..clear },
        Scene { contrast: 0.1, ..clear },
        Scene { noise: 100.0, ..clear },
        Scene { blur_um: 0.8, ..clear },
    ] {
        let truth = scene.fluorescence();
        let found =
            segment(&truth.plane, pixels_of(scene.pixel_um), &SegmentationSettings::default())
                .unwrap();
        assert_eq!(found.modality, Modality::Fluorescence, "{scene:?}");
        let dice = dice(&truth, &found);
        // A quarter of a um all round a cell of 24 um width is Dice 0.97; light that spreads over the
        // outline by the blur counts as cell.
        assert!(dice >= 0.94, "Dice {dice} of fluorescence, {scene:?}");
    }
    let clear = Scene { contrast: 0.25, ..clear };
    for scene in [
        clear,
        Scene { turn_deg: 75.0, ..clear },
        Scene { pixel_um: 0.15, ..clear },
        Scene { pixel_um: 0.4, ..clear },
        Scene { vignette: 0.3, ..clear },
        Scene { noise: 40.0, ..clear },
        Scene { beads: 20.0, ..clear },
    ] {
        let truth = scene.brightfield();
        let found =
            segment(&truth.plane, pixels_of(scene.pixel_um), &SegmentationSettings::default())
                .unwrap();
        assert_eq!(found.modality, Modality::Brightfield, "{scene:?}");
        let dice = dice(&truth, &found);
        assert!(dice >= 0.93, "Dice {dice} of brightfield, {scene:?}");
    }
}

#[test]
#[ignore = "slow"]
fn the_kind_of_a_picture_does_not_hang_on_how_much_of_the_frame_the_cell_covers() {
    let mut sample = Sample::one_in(5);
    // Side of the frame, um, pixel, um, and half the cell's width: 0.1 % of the frame to 80 %.
    for (field_um, pixel_um, half_width_um, taper) in [
        (1330.0, 1.3, 12.0, 0.6),
        (660.0, 0.65, 12.0, 0.6),
        (220.0, 0.4, 12.0, 0.6),
        (120.0, 0.25, 30.0, 0.6),
        (101.5, 0.25, 47.0, 0.3),
    ] {
        let wide = half_width_um > 12.0;
        let turn_deg = if wide { 0.0 } else { 20.0 };
        for contrast in [1.0, 0.1] {
            if sample.leaves_out() {
                continue;
            }
            let scene = Scene {
                pixel_um,
                field_um,
                contrast,
                half_width_um,
                taper,
                turn_deg,
                ..Scene::default()
            };
            let truth = scene.fluorescence();
            let found =
                segment(&truth.plane, pixels_of(pixel_um), &SegmentationSettings::default())
                    .unwrap();
            assert_eq!(found.modality, Modality::Fluorescence, "{scene:?}");
            // Less than a um from the frame a cell may seem to be cut by it.
            let dice = dice_of(&truth, &found, true);
            assert!(dice >= 0.95, "Dice {dice} of fluorescence, {scene:?}");
            let scene = Scene { contrast: 0.25 * contrast.sqrt(), ..scene };
            let truth = scene.brightfield();
            let found =
                segment(&truth.plane, pixels_of(pixel_um), &SegmentationSettings::default())
                    .unwrap();
            assert_eq!(found.modality, Modality::Brightfield, "{scene:?}");
            let dice = dice_of(&truth, &found, true);
            // Where the cell's own grains are all that there is to measure noise by, its rim does not stand out.
            let doubtful = found.choose(Choice::Largest, true).unwrap().confidence.is_doubtful();
            let fills = half_width_um > 40.0;
            let well = dice >= 0.88 || fills && doubtful;
            assert!(well, "Dice {dice} of brightfield, {scene:?}");
        }
    }
}

#[test]
fn cells_of_a_label_mask_stay_apart_although_they_touch() {
    let label = |at: usize| match at % 60 {
        5..30 if at / 60 > 3 && at / 60 < 40 => 7.0,
        30..50 if at / 60 > 3 && at / 60 < 40 => 3.0,
        _ => 0.0,
    };
    let plane = Plane::new(60, 50, (0..3000).map(label).collect()).unwrap();
    let found = segment(&plane, pixels_of(0.5), &SegmentationSettings::default()).unwrap();
    assert_eq!(found.modality, Modality::Mask);
    let labels: Vec<Option<u32>> = found.cells.iter().map(|cell| cell.label).collect();
    assert_eq!(labels, [Some(7), Some(3)], "largest first");
    assert_eq!(found.choose(Choice::Label(3), false).unwrap().pixels, 20 * 36);
    assert_eq!(found.choose(Choice::At([40.0, 10.0]), false).unwrap().label, Some(3));
    let error = found.choose(Choice::Label(4), false).unwrap_err();
    assert_eq!(
        error.to_string(),
        "label 4 is not in the picture, which holds 3, 7; 0 is the background"
    );
    let error = found.choose(Choice::Number(3), false).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cell 3 was asked for, but the picture has 2 cells; 1 is the largest"
    );
    let error = found.choose(Choice::At([1.0, 1.0]), false).unwrap_err();
    assert!(error.to_string().contains("the nearest is cell 1 at 5, 4"), "{error}");
}

#[test]
fn a_cell_that_the_frame_cuts_is_refused_unless_allowed() {
    let label = |at: usize| if at % 60 < 30 && at / 60 > 3 { 1.0 } else { 0.0 };
    let plane = Plane::new(60, 50, (0..3000).map(label).collect()).unwrap();
    let found = segment(&plane, pixels_of(0.5), &SegmentationSettings::default()).unwrap();
    let error = found.choose(Choice::Largest, false).unwrap_err();
    assert!(matches!(&error, SegmentError::Cut { name, .. } if name == "1"), "{error}");
    assert!(error.to_string().contains("--allow-cut"));
    assert_eq!(found.choose(Choice::Largest, true).unwrap().number, 1);
}

#[test]
fn of_cut_and_whole_cells_the_largest_whole_one_is_taken() {
    let label = |at: usize| match (at % 60, at / 60) {
        (0..30, 4..) => 1.0,
        (40..55, 10..30) => 2.0,
        _ => 0.0,
    };
    let plane = Plane::new(60, 50, (0..3000).map(label).collect()).unwrap();
    let found = segment(&plane, pixels_of(0.5), &SegmentationSettings::default()).unwrap();
    assert_eq!(found.choose(Choice::Largest, false).unwrap().label, Some(2));
    assert_eq!(found.choose(Choice::Largest, true).unwrap().label, Some(1));
}

#[test]
fn a_threshold_that_is_given_is_used_and_a_lower_one_takes_in_more() {
    let truth = Scene { blur_um: 1.0, ..Scene::default() }.fluorescence();
    let at = |threshold| {
        let settings =
            SegmentationSettings { threshold: Some(threshold), ..SegmentationSettings::default() };
        let found = segment(&truth.plane, pixels_of(0.25), &settings).unwrap();
        assert_eq!(found.threshold, threshold);
        found.cells[0].pixels
    };
    assert!(at(150.0) > at(250.0) && at(250.0) > at(350.0));
}

#[test]
fn pictures_without_a_cell_say_so() {
    let noise = Scene { contrast: 0.0, noise: 30.0, ..Scene::default() };
    for (name, truth) in [("dark", noise.fluorescence()), ("bright", noise.brightfield())] {
        for modality in [Modality::Auto, Modality::Fluorescence, Modality::Brightfield] {
            match segment(&truth.plane, pixels_of(0.25), &with(modality)) {
                Err(SegmentError::NoCell { .. } | SegmentError::NothingStandsOut { .. }) => {}
                Err(error) => panic!("{name}, {modality:?}: {error}"),
                Ok(found) => {
                    let sure = found.cells.iter().find(|cell| !cell.confidence.is_doubtful());
                    assert!(sure.is_none(), "{name}, {modality:?}: {sure:?}");
                }
            }
        }
    }
}

#[test]
fn blank_and_broken_planes_are_refused_with_the_place() {
    let black = Plane::new(64, 64, vec![0.0; 64 * 64]).unwrap();
    let error = segment(&black, pixels_of(0.25), &SegmentationSettings::default()).unwrap_err();
    assert!(matches!(error, SegmentError::Blank { width: 64, height: 64, value: 0.0 }), "{error}");
    let mut values = vec![1.0; 64 * 64];
    values[64 * 3 + 5] = f32::NAN;
    let broken = Plane::new(64, 64, values).unwrap();
    let error = segment(&broken, pixels_of(0.25), &SegmentationSettings::default()).unwrap_err();
    assert_eq!(error.to_string(), "the pixel in column 5, row 3 is NaN; pixels must be finite");
    let error = segment(
        &black,
        pixels_of(0.25),
        &SegmentationSettings { smooth_um: Some(-1.0), ..SegmentationSettings::default() },
    );
    assert!(error.unwrap_err().to_string().contains("the scale of smoothing is -1 um"));
}

#[test]
fn planes_of_any_small_size_are_no_fault() {
    for width in 1..12 {
        for height in 1..12 {
            let values: Vec<f32> =
                (0..width * height).map(|at| ((at * 7919) % 251) as f32).collect();
            let plane = Plane::new(width, height, values).unwrap();
            for modality in
                [Modality::Auto, Modality::Fluorescence, Modality::Brightfield, Modality::Mask]
            {
                for pixel in [0.01, 0.3, 40.0] {
                    segment(&plane, pixels_of(pixel), &with(modality)).ok();
                }
            }
        }
    }
}

#[test]
fn given_outlines_are_chosen_as_cells_are() {
    let grey: Vec<u8> = (0..60 * 40).map(|at: u32| (at % 60 + at / 60) as u8).collect();
    let png = common::png([60, 40], 1, &grey);
    // One line an outline, pixels, y downward.
    let outlines = b"5,5,15,5,15,15,5,15\n20,10,50,10,50,30,20,30\n";
    let options = PictureOptions { pixel_size: Some(pixels_of(0.5)), ..PictureOptions::default() };
    let cells = PictureCells::with_outlines(&png, outlines, "cells.txt", &options).unwrap();
    let area = |choice| cells.cell(choice, false).map(|cell| cell.shape.area_um2);
    assert_eq!(area(Choice::Largest).unwrap(), 150.0);
    assert_eq!(area(Choice::Number(2)).unwrap(), 25.0);
    assert_eq!(area(Choice::Label(1)).unwrap(), 25.0);
    assert_eq!(area(Choice::At([6.0, 6.0])).unwrap(), 25.0);
    let refused = |choice| area(choice).unwrap_err().to_string();
    assert!(refused(Choice::Number(3)).contains("the picture has 2 cells"));
    assert!(
        refused(Choice::Label(9)).contains("which holds `2`, `1`"),
        "{}",
        refused(Choice::Label(9))
    );
    let beside = refused(Choice::At([52.0, 20.0]));
    assert!(beside.contains("no cell was found at 52, 20") && beside.ends_with("`2`"), "{beside}");
}
