//! Real films.

use crate::common::shared_data;
use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;
use myospring::microscopy::posts::{self, Doubt, Post, PostError, PostPlaces, PostShape};

fn film(file: &str) -> Option<Film> {
    let bytes = std::fs::read(shared_data(file)?).unwrap();
    Some(Film::read(bytes, &Selection::default()).unwrap())
}

#[test]
fn a_tissue_whose_posts_are_out_of_the_frame_has_none() {
    let Some(film) = film("films/mbpt_crop.tif") else { return };
    let cause = posts::find(&film).unwrap_err();
    assert!(matches!(cause, PostError::NotFound { doubt: Doubt::Common { .. }, .. }), "{cause}");
    assert!(cause.to_string().contains("State the places"), "{cause}");
}

#[test]
fn a_single_cell_has_no_posts() {
    let Some(film) = film("images/contrax_brightfield.tif") else { return };
    let cause = posts::find(&film).unwrap_err();
    assert!(matches!(cause, PostError::NotFound { .. }), "{cause}");
}

/// Two places of a real tissue, stated as posts: they beat as the tissue does, some pixels, and come back.
#[test]
fn places_in_a_real_tissue_are_followed_through_its_beats() {
    let Some(film) = film("films/mbpt_crop.tif") else { return };
    let shape = PostShape::Round { diameter_px: 30.0 };
    let post = |column| Post { middle_px: [column, 70.0], shape };
    let places = PostPlaces { frame: 0, posts: [post(30.0), post(200.0)] };
    let motion = posts::follow(&film, &places, |_| true).unwrap();
    assert_eq!(motion.found_share(), 1.0);
    let approach: Vec<f64> = motion.approach_px().into_iter().flatten().collect();
    let largest = approach.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sorted = approach.clone();
    sorted.sort_by(f64::total_cmp);
    println!("{largest} {} {:?}", sorted[22], motion.rest);
    // A quarter of the frames is at rest; noise and focus leave some hundredths of a pixel there.
    assert!(largest > 0.5 && sorted[22] - sorted[0] < 0.15 * largest, "{largest} {sorted:?}");
}
