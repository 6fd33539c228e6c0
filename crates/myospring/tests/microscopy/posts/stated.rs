//! Posts whose places are stated.

use super::made_up::Scene;
use crate::common::Sample;
use myospring::microscopy::posts::{self, PostMotion};

/// Root mean square of the error of the displacements of both posts, along each axis, pixels; all frames must be found.
pub(super) fn error(scene: &Scene, motion: &PostMotion) -> f64 {
    let truth = scene.moved();
    let (mut sum, mut count) = (0.0, 0.0);
    for (at, &frame) in motion.frames.iter().enumerate() {
        for post in 0..2 {
            let found = motion.tracks[post].displacement_px[at].unwrap();
            for k in 0..2 {
                let moved = truth[frame][post][k] - truth[motion.rest.frame][post][k];
                sum += (found[k] - moved).powi(2);
                count += 1.0;
            }
        }
    }
    f64::sqrt(sum / count)
}

/// Round and rectangular posts of about this size.
pub(super) fn scenes(diameter: f64) -> [Scene; 2] {
    [Scene::round(diameter), Scene::rectangular(0.8 * diameter, diameter)]
}

/// Follows the posts from a frame in which they are not at rest, and from places that are not quite right.
fn follow(scene: &Scene) -> PostMotion {
    let mut places = scene.places(3);
    for post in &mut places.posts {
        post.middle_px = [post.middle_px[0] + 0.6, post.middle_px[1] - 0.8];
    }
    posts::follow(&scene.film(), &places, |_| true).unwrap()
}

fn check(diameters: &[f64], noise: f64, largest: f64) {
    for &diameter in diameters {
        for contrast in [80.0, -80.0] {
            for scene in scenes(diameter) {
                let scene = Scene { contrast, noise, jitter: 0.3, ..scene };
                let motion = follow(&scene);
                let error = error(&scene, &motion);
                let stated = motion.tracks.iter().flat_map(|track| track.error_px.iter().flatten());
                let stated = stated.sum::<f64>() / (2 * motion.frames.len()) as f64;
                let what =
                    format!("{contrast} {noise} {:?}: {error}, stated {stated}", scene.shape);
                assert!(error < largest, "{what}");
                // The frame at rest has its error, too, which all others share; without noise, interpolation decides.
                assert!(noise == 0.0 || (0.4..2.5).contains(&(error / stated)), "{what}");
            }
        }
    }
}

#[test]
fn small_stated_posts_are_followed_to_a_twentieth_of_a_pixel() {
    check(&[8.0, 12.0, 20.0], 0.0, 0.05);
}

#[test]
fn noise_of_a_fifth_of_the_contrast_costs_less_than_a_fifth_of_a_pixel() {
    check(&[8.0, 12.0, 20.0], 16.0, 0.2);
}

#[test]
#[ignore = "slow"]
fn large_stated_posts_are_followed_to_a_twentieth_of_a_pixel() {
    let mut sample = Sample::one_in(5);
    for (noise, largest) in [(0.0, 0.05), (16.0, 0.2)] {
        for diameter in [80.0, 120.0, 40.0] {
            if !sample.leaves_out() {
                check(&[diameter], noise, largest);
            }
        }
    }
}

#[test]
fn a_tilted_pair_and_a_jumping_stage_are_followed() {
    let scene = Scene::rectangular(10.0, 14.0);
    let scene = Scene {
        height: 110,
        middles: [[20.2, 28.4], [75.1, 78.3]],
        jitter: 3.0,
        noise: 4.0,
        ..scene
    };
    let motion = follow(&scene);
    let error = error(&scene, &motion);
    assert!(error < 0.1, "{error}");
    // The approach does not see the stage.
    let pull = motion.approach_px()[4].unwrap();
    let truth = |frame: usize| scene.moved()[frame];
    let apart = |frame: usize| {
        let [a, b] = [0, 1].map(|post: usize| {
            [0, 1].map(|k: usize| scene.middles[post][k] + truth(frame)[post][k])
        });
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    assert!((pull - apart(motion.rest.frame) + apart(4)).abs() < 0.2, "{pull}");
    let drift = motion.drift_px()[4].unwrap();
    let without = motion.without_drift_px().map(|post| post[4].unwrap());
    for k in 0..2 {
        assert!((without[0][k] + without[1][k]).abs() < 1e-9);
        let moved = motion.tracks[0].displacement_px[4].unwrap();
        assert!((without[0][k] + drift[k] - moved[k]).abs() < 1e-9);
    }
}
