//! Places that cannot be followed, and frames without posts.

use super::made_up::Scene;
use myospring::microscopy::posts::{self, Post, PostError, PostPlaces, PostShape};

fn refused(change: impl Fn(&mut PostPlaces)) -> PostError {
    let scene = Scene { frames: 3, texture: 0.0, ..Scene::round(16.0) };
    let mut places = scene.places(0);
    change(&mut places);
    posts::follow(&scene.film(), &places, |_| true).unwrap_err()
}

#[test]
fn wrong_places_are_refused_with_a_reason() {
    let outside = refused(|places| places.posts[1].middle_px = [300.0, 20.0]);
    assert!(matches!(outside, PostError::Outside { post: 1, .. }), "{outside}");
    let small = refused(|places| places.posts[0].shape = PostShape::Round { diameter_px: 2.0 });
    assert!(matches!(small, PostError::Size { post: 0, .. }), "{small}");
    let same = refused(|places| places.posts[1] = places.posts[0]);
    assert!(matches!(same, PostError::Overlap { .. }), "{same}");
    let late = refused(|places| places.frame = 7);
    assert!(matches!(late, PostError::Film(_)), "{late}");
    // In the middle of a tissue without texture.
    let flat = refused(|places| {
        let shape = PostShape::Round { diameter_px: 8.0 };
        places.posts[0] = Post { middle_px: [56.0, 32.0], shape };
    });
    assert!(matches!(flat, PostError::Flat { post: 0, .. }), "{flat}");
    let words = flat.to_string();
    assert!(words.contains("post 1") && words.contains("column 56"), "{words}");
}

#[test]
fn frames_without_posts_have_no_displacement_and_the_others_have_theirs() {
    let scene = Scene { frames: 12, noise: 4.0, blank: 3, ..Scene::round(16.0) };
    let film = scene.film();
    let motion = posts::follow(&film, &scene.places(1), |_| true).unwrap();
    for (at, &frame) in motion.frames.iter().enumerate() {
        for track in &motion.tracks {
            let found = track.displacement_px[at].is_some();
            assert_eq!(found, frame % 4 != 3, "frame {frame}: {:?}", track.correlation[at]);
            assert_eq!(track.error_px[at].is_some(), found);
            assert!(found || track.correlation[at].is_none_or(|value| value < 0.8));
        }
        assert_eq!(motion.approach_px()[at].is_some(), frame % 4 != 3);
    }
    assert_eq!(motion.found_share(), 0.75);
}

#[test]
fn posts_that_are_hardly_ever_seen_are_refused() {
    let scene = Scene { frames: 8, noise: 4.0, blank: 1, ..Scene::round(16.0) };
    let places = PostPlaces { frame: 0, ..scene.places(0) };
    let cause = posts::follow(&scene.film(), &places, |_| true).unwrap_err();
    assert!(matches!(cause, PostError::Lost { post: 0, frame: 0, .. }), "{cause}");
}

#[test]
fn following_can_be_stopped() {
    let scene = Scene { frames: 6, ..Scene::round(12.0) };
    let motion = posts::follow(&scene.film(), &scene.places(2), |(done, all)| {
        assert_eq!(all, 12);
        done < 3
    });
    let motion = motion.unwrap();
    assert!(motion.interrupted);
    assert_eq!(motion.frames, [2, 3, 4]);
}
