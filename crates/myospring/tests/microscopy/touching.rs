//! Cells that touch are parted or doubted; single cells stay whole, whatever their form.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

use crate::common::Sample;
use crate::common::{pixels_of, shared_data};
use crate::synthetic_cell::Scene;
use crate::touching_cells::{Body, Form, Look, Touching, one, singles, two};

use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use myospring::microscopy::segment::{Modality, Segmentation, SegmentationSettings, segment};

fn fluorescence(plane: &Plane, pixel_um: f64) -> Segmentation {
    let settings = SegmentationSettings {
        modality: Modality::Fluorescence,
        ..SegmentationSettings::default()
    };
    segment(plane, pixels_of(pixel_um), &settings).unwrap()
}

fn scene(pixel_um: f64, turn_deg: f64, noise: f64) -> Scene {
    Scene { pixel_um, turn_deg, noise, field_um: 225.0, ..Scene::default() }
}

fn found(look: &Look, scene: &Scene, bodies: &[Body]) -> (Touching, Segmentation) {
    let truth = look.fluorescence(scene, bodies);
    let found = fluorescence(&truth.plane, scene.pixel_um);
    (truth, found)
}

#[test]
#[ignore = "slow"]
fn single_cells_of_any_form_stay_whole() {
    let mut sample = Sample::one_in(11);
    for (name, form, look) in singles() {
        for (pixel_um, turn_deg, noise) in
            [(0.25, 20.0, 10.0), (0.5, 65.0, 100.0), (0.65, 0.0, 300.0), (1.0, 35.0, 100.0)]
        {
            if sample.leaves_out() {
                continue;
            }
            let scene = scene(pixel_um, turn_deg, noise);
            let (truth, found) = found(&look, &scene, &one(form));
            assert_eq!(found.cells.len(), 1, "{name}, {scene:?}");
            let dice = truth.worst_dice(&found.numbers);
            // Noise of a third of the signal and pixels of 1 um fray thin arms.
            assert!(dice > 0.9, "{name}: Dice {dice}, {scene:?}");
        }
    }
}

#[test]
#[ignore = "slow"]
fn pairs_of_rods_with_a_dark_line_between_them_are_parted() {
    let mut sample = Sample::one_in(11);
    let unstriped = Look { stripes: false, ..Look::default() };
    let mut other_width = two([100.0, 0.0], 0.0);
    other_width[1].form = Form::Rod { length: 100.0, width: 15.0 };
    for (name, bodies) in [
        ("side by side", two([8.0, 24.0], 0.0)),
        ("side by side, one further on", two([40.0, 24.0], 0.0)),
        ("end to end", two([100.0, 0.0], 0.0)),
        ("end to end, of other widths", other_width),
        ("in an L", two([38.0, 62.0], 90.0)),
        ("in a T", two([0.0, 62.0], 90.0)),
    ] {
        for (pixel_um, turn_deg, look) in [
            (0.25, 20.0, Look::default()),
            (0.25, 90.0, unstriped),
            (0.5, 65.0, Look::default()),
            (0.65, 0.0, Look::default()),
        ] {
            if sample.leaves_out() {
                continue;
            }
            let scene = scene(pixel_um, turn_deg, 20.0);
            let (truth, found) = found(&look, &scene, &bodies);
            assert_eq!(found.cells.len(), 2, "{name}, {scene:?}");
            let dice = truth.worst_dice(&found.numbers);
            assert!(dice >= 0.9, "{name}: Dice {dice}, {scene:?}");
        }
    }
}

#[test]
fn branches_with_stripes_of_their_own_and_necks_are_parted_without_a_line() {
    if crate::common::left_to_full() {
        return;
    }
    let look = Look { membrane: 0.0, ..Look::default() };
    for (name, bodies) in [
        ("in an L", two([38.0, 62.0], 90.0)),
        ("in a T", two([0.0, 62.0], 90.0)),
        ("end to end, aside", two([100.0, 15.0], 0.0)),
        ("discs", {
            let disc = |x| Body { at: [x, 0.0], ..one(Form::Disc { radius: 20.0 })[0] };
            vec![disc(-19.9), disc(19.9)]
        }),
    ] {
        for turn_deg in [0.0, 20.0, 65.0] {
            let scene = scene(0.25, turn_deg, 20.0);
            let (truth, found) = found(&look, &scene, &bodies);
            assert_eq!(found.cells.len(), 2, "{name}, {scene:?}");
            let dice = truth.worst_dice(&found.numbers);
            assert!(dice >= 0.9, "{name}: Dice {dice}, {scene:?}");
        }
    }
}

#[test]
fn what_may_be_two_cells_and_is_not_parted_says_where_and_what_to_do() {
    let plain = Look { membrane: 0.0, stripes: false, columns: 0.0, ..Look::default() };
    let mut brighter = two([8.0, 24.0], 0.0);
    brighter[1].bright = 0.6;
    for (name, look, bodies) in [
        ("in a T without stripes", plain, two([0.0, 62.0], 90.0)),
        ("an X", Look::default(), two([0.0, 0.0], 90.0)),
        ("an X, brighter where both are", Look { sums: true, ..plain }, two([0.0, 0.0], 90.0)),
        ("side by side, one brighter", plain, brighter),
    ] {
        let scene = scene(0.25, 20.0, 20.0);
        let (_, found) = found(&look, &scene, &bodies);
        assert_eq!(found.cells.len(), 1, "{name}");
        let confidence = &found.cells[0].confidence;
        assert!(confidence.score < 0.8, "{name}: {confidence:?}");
        let reasons = confidence.reasons.join("; ");
        assert!(reasons.contains("cells"), "{name}: {reasons}");
    }
    let scene = scene(0.25, 20.0, 20.0);
    let (_, found) = found(&plain, &scene, &two([0.0, 62.0], 90.0));
    let reasons = &found.cells[0].confidence.reasons;
    let where_and_what = |reason: &&String| {
        reason.contains("column ") && reason.contains("row ") && reason.contains("outline")
    };
    assert_eq!(reasons.iter().filter(where_and_what).count(), 1, "{reasons:?}");
}

#[test]
fn masks_are_never_parted() {
    let scene = scene(0.5, 20.0, 0.0);
    let bodies = two([100.0, 15.0], 0.0);
    let truth = Look::default().fluorescence(&scene, &bodies);
    let (width, height) = (truth.plane.width(), truth.plane.height());
    let values = (0..width * height).map(|at| truth.cells.iter().any(|cell| cell[at]));
    let mask = Plane::new(width, height, values.map(|is| f32::from(u8::from(is))).collect());
    let found = segment(&mask.unwrap(), pixels_of(0.5), &SegmentationSettings::default()).unwrap();
    assert_eq!((found.modality, found.cells.len()), (Modality::Mask, 1));
    assert!(found.cells[0].confidence.reasons.is_empty(), "{:?}", found.cells[0].confidence);
}

#[test]
#[ignore = "slow"]
fn real_whole_cells_stay_whole_at_any_pixel_size() {
    if crate::common::left_to_full() {
        return;
    }
    for (picture, mask, pixel_um) in [
        ("images/sarcgraph_e5_fluorescence.png", "images/sarcgraph_e5_mask.png", 0.27),
        ("images/sarcgraph_e2_rest.png", "images/sarcgraph_e2_mask.png", 0.18),
        ("images/morphoscript_test3.tif", "images/morphoscript_test3_mask.png", 0.09),
    ] {
        let (Some(picture_file), Some(mask)) = (shared_data(picture), shared_data(mask)) else {
            return;
        };
        let read = |file: std::path::PathBuf| {
            read_picture(&std::fs::read(file).unwrap(), &Selection::default()).unwrap().plane
        };
        let (plane, mask) = (read(picture_file), read(mask));
        // The cell alone: which region is found is another question.
        let alone = plane.values().iter().zip(mask.values()).enumerate();
        let alone =
            alone.map(
                |(at, (&value, &inside))| {
                    if inside > 0.0 { value.max(25.0) } else { (at * 7919 % 13) as f32 / 4.0 }
                },
            );
        let alone = Plane::new(plane.width(), plane.height(), alone.collect()).unwrap();
        for factor in [0.6, 1.0, 2.0] {
            let found = fluorescence(&alone, factor * pixel_um);
            assert_eq!(found.cells.len(), 1, "{picture} at {factor} times its pixel size");
            let reasons = &found.cells[0].confidence.reasons;
            assert!(!reasons.iter().any(|reason| reason.contains("two cells")), "{reasons:?}");
        }
    }
}

#[test]
fn touching_neonatal_cells_are_parted_at_their_necks() {
    let Some(picture) = shared_data("images/biif_neonatal.png") else { return };
    let plane =
        read_picture(&std::fs::read(picture).unwrap(), &Selection::default()).unwrap().plane;
    let found = fluorescence(&plane, 1.0);
    let at = |column: usize, row: usize| found.numbers[row * found.width + column];
    // Bodies of cells that touch by an arm or a corner, as the eye sees them.
    for (what, one, other) in [
        ("the flat cell at the top and the one below it", (120, 40), (115, 92)),
        ("the cell with the bright edge and the one below it", (225, 85), (240, 140)),
        ("the star in the middle and its neighbour", (182, 140), (215, 205)),
        ("the broad cell and the round one", (75, 155), (115, 145)),
        ("the long cell and the star below it", (112, 198), (140, 240)),
    ] {
        let [one_cell, other_cell] = [one, other].map(|(column, row)| at(column, row));
        assert!(one_cell != 0 && other_cell != 0, "{what}: {one_cell}, {other_cell}");
        assert_ne!(one_cell, other_cell, "{what}");
    }
}
