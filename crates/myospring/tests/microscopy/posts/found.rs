//! The search for posts.

use super::made_up::Scene;
use super::stated::{error, scenes};
use crate::common::Sample;
use myospring::microscopy::posts::{self, Doubt, PostError};

/// Distance of the found middles from the true ones, and the ratio of the found diameter to the true mean side.
fn found(scene: &Scene) -> Result<[f64; 2], PostError> {
    let found = posts::find(&scene.film())?;
    let truth = scene.places(found.places.frame).posts;
    let off = [0, 1].map(|post: usize| {
        let [a, b] = [truth[post].middle_px, found.places.posts[post].middle_px];
        (a[0] - b[0]).hypot(a[1] - b[1])
    });
    let side = |post: &posts::Post| post.shape.sides_px().iter().sum::<f64>();
    Ok([off[0].max(off[1]), side(&found.places.posts[0]) / side(&truth[0])])
}

/// Finds posts of some diameters, bright and dark, with and without noise, with and without an inside of their own.
fn check(diameters: &[f64]) {
    let mut missed = Vec::new();
    for &diameter in diameters {
        // Films of large posts are large.
        let few = [(100.0, 41), (30.0, 17), (0.0, 1)];
        let few = few.into_iter().find(|(above, _)| diameter > *above);
        let mut sample = Sample::one_in(few.map_or(1, |(_, few)| few));
        for (contrast, rim_only) in [(80.0, false), (-80.0, false), (80.0, true), (-80.0, true)] {
            // A thinner rim is none after the blur of the microscope.
            if rim_only && diameter < 20.0 {
                continue;
            }
            for noise in [0.0, 16.0] {
                for scene in scenes(diameter) {
                    if sample.leaves_out() {
                        continue;
                    }
                    let scene = Scene { contrast, rim_only, noise, jitter: 0.3, ..scene };
                    let found = found(&scene);
                    let what = (contrast, rim_only, noise, scene.shape);
                    if !found.as_ref().is_ok_and(|[off, _]| *off < 0.25 * diameter) {
                        missed.push(format!("{what:?}: {found:?}"));
                    }
                }
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn small_posts_of_all_shapes_and_contrasts_are_found() {
    check(&[8.0, 12.0]);
}

#[test]
fn posts_of_all_shapes_and_contrasts_are_found() {
    check(&[20.0]);
}

#[test]
#[ignore = "slow"]
fn large_posts_of_all_shapes_and_contrasts_are_found() {
    check(&[40.0, 80.0, 120.0]);
}

#[test]
fn found_posts_are_followed() {
    let scene = Scene { jitter: 0.5, noise: 4.0, ..Scene::round(24.0) };
    let film = scene.film();
    let found = posts::find(&film).unwrap();
    let motion = posts::follow(&film, &found.places, |_| true).unwrap();
    let error = error(&scene, &motion);
    assert!(error < 0.1, "{error}");
}

/// Neither its texture nor its round ends, which beat, too, are posts.
#[test]
fn a_tissue_without_posts_has_none() {
    for (texture, seed) in [(6.0, 1), (20.0, 2), (20.0, 3)] {
        let scene = Scene { contrast: 0.0, rim_only: true, texture, seed, ..Scene::round(16.0) };
        let cause = posts::find(&scene.film()).unwrap_err();
        assert!(matches!(cause, PostError::NotFound { .. }), "{cause}");
    }
}

#[test]
fn posts_that_do_not_beat_are_named_but_not_taken() {
    let scene = Scene { pull: 0.0, noise: 4.0, ..Scene::round(24.0) };
    let cause = posts::find(&scene.film()).unwrap_err();
    assert!(matches!(cause, PostError::NotFound { doubt: Doubt::Still { .. }, .. }), "{cause}");
}
