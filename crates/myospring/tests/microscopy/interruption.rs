//! Work on a picture ends soon after it is asked to, however many cells there are.

use crate::common::{self, pixels_of};
use crate::synthetic_cell::Scene;

use myospring::interruption::{Interrupted, Interruption};
use myospring::microscopy::cells::{CellError, PictureCells, PictureOptions};
use myospring::microscopy::fibres::{FibreError, FibreSettings, Stain};
use myospring::microscopy::plane::Plane;
use myospring::microscopy::segment::{SegmentError, SegmentationSettings};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const PIXEL_UM: f64 = 0.5;

/// The same cell `times` by `times`, as PNG.
fn many(plane: &Plane, times: usize) -> Vec<u8> {
    let (width, height) = (plane.width(), plane.height());
    let rows = (0..times * height).flat_map(|row| (0..times * width).map(move |x| (x, row)));
    let samples: Vec<u16> = rows.map(|(x, row)| plane.at(x % width, row % height) as u16).collect();
    common::wide_png([(times * width) as u32, (times * height) as u32], &samples)
}

/// Answers yes from the question `first` on; how many questions there were.
fn from(first: usize) -> (Interruption, Arc<AtomicUsize>) {
    let asked = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&asked);
    let answer = move || counted.fetch_add(1, Ordering::Relaxed) >= first;
    (Interruption::when(answer), asked)
}

fn find(bytes: &[u8], interruption: Interruption) -> Result<PictureCells, CellError> {
    let segmentation = SegmentationSettings { interruption, ..SegmentationSettings::default() };
    let pixel_size = Some(pixels_of(PIXEL_UM));
    PictureCells::find(
        bytes,
        &PictureOptions { pixel_size, segmentation, ..PictureOptions::default() },
    )
}

fn is_interrupted(error: &CellError) -> bool {
    matches!(
        error,
        CellError::Interrupted(Interrupted)
            | CellError::Segment(SegmentError::Interrupted(Interrupted))
    )
}

#[test]
#[ignore = "slow"]
fn segmentation_asks_at_every_cell_and_ends_at_the_first_yes() {
    if crate::common::left_to_full() {
        return;
    }
    let scene = Scene { pixel_um: PIXEL_UM, field_um: 120.0, ..Scene::default() };
    for plane in [scene.fluorescence().plane, Scene { contrast: 0.25, ..scene }.brightfield().plane]
    {
        let questions = |times: usize| {
            let bytes = many(&plane, times);
            let (never, asked) = from(usize::MAX);
            let found = find(&bytes, never).unwrap();
            assert_eq!(found.len(), times * times);
            (bytes, asked.load(Ordering::Relaxed))
        };
        let (one, (bytes, nine)) = (questions(1).1, questions(3));
        // What follows evidence, parting and judging ask at each of eight more cells.
        assert!(nine >= one + 3 * 8, "{one} questions of one cell, {nine} of nine");
        for first in (0..nine).step_by(nine / 3) {
            let (interruption, asked) = from(first);
            let error = find(&bytes, interruption).unwrap_err();
            assert!(is_interrupted(&error), "at question {first} of {nine}: {error}");
            // Whoever hears it may make sure once.
            let more = asked.load(Ordering::Relaxed) - first;
            assert!(more <= 2, "{more} questions were asked after the yes at {first}");
        }
    }
}

#[test]
fn reading_fibres_of_a_frame_asks_more_often_the_larger_it_is_and_ends() {
    let scene = Scene { pixel_um: PIXEL_UM, field_um: 120.0, ..Scene::default() };
    let plane = scene.fluorescence().plane;
    let settings = FibreSettings::of(Stain::ZDisc);
    let questions = |times: usize| {
        let mut cells = find(&many(&plane, times), Interruption::default()).unwrap();
        let (never, asked) = from(usize::MAX);
        cells.interruption = never;
        cells.fibres_of_frame(&settings).unwrap();
        (cells, asked.load(Ordering::Relaxed))
    };
    let (one, (mut cells, four)) = (questions(1).1, questions(2));
    assert!(four as f64 > 1.7 * one as f64, "{one} questions of one field, {four} of four");
    for first in [0, four / 3, four - 1] {
        cells.interruption = from(first).0;
        let error = cells.fibres_of_frame(&settings).unwrap_err();
        assert_eq!(error, FibreError::Interrupted(Interrupted), "at question {first} of {four}");
    }
}
