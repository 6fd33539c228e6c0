//! Both posts through all frames of a film.

use super::error::{PostError, SMALLEST_POST_PX};
use super::motion::{PostMotion, PostTrack};
use super::patch::{Patch, Seen};
use super::post::{Body, Post, PostPlaces};
use crate::film::Film;
use crate::motion::Rest;
use crate::plane::Plane;
use myospring_core::analysis::order;

/// Least part of the frames in which each post must be found.
const LEAST_FOUND: f64 = 0.5;
/// Largest change of place from a frame to the next: in sides of the post, and in distances of the posts, so that one is not
/// taken for the other.
const FARTHEST: [f64; 2] = [1.0, 0.4];
/// Frames in which the posts are less than this number of standard errors nearer than in any other are at rest, too.
const AT_REST: f64 = 2.0;

/// What was seen of a post in a frame, and the best correlation.
type Look = (Option<Seen>, Option<f64>);

/// Follows two posts through a film. `places` are the posts in one frame; an error of a quarter of a post in place or size does
/// not matter, because the picture around each place is followed. `goes_on` gets the number of frames that are done and the number
/// of all that there are to do; if it returns false, the motion has the frames done so far.
///
/// The film is followed twice. The first pass, from the given frame, finds the frame in which the posts are farthest apart. This is
/// the frame at rest. The second pass compares all frames with it, and displacements count from it. If noise leaves several
/// frames to choose from, the one with the median distance is taken.
///
/// # Errors
/// A frame that cannot be read, a post that is not in the frame, too small, or without anything to follow, posts that
/// overlap, or a post that is found again in less than half of the frames.
///
/// # Example
/// Two dark squares on a bright ground; the right one moves to the left by one pixel.
/// ```
/// use myospring::microscopy::film::Film;
/// use myospring::microscopy::picture::Selection;
/// use myospring::microscopy::posts::{self, Post, PostPlaces, PostShape};
/// let mut bytes = b"YUV4MPEG2 W60 H20 F50:1 Cmono\n".to_vec();
/// for moved in [0, 1, 1] {
///     bytes.extend(b"FRAME\n");
///     let is_dark = |x: usize, y: usize| {
///         (6..14).contains(&y) && ((10..18).contains(&x) || (42 - moved..50 - moved).contains(&x))
///     };
///     bytes.extend((0..1200).map(|at| if is_dark(at % 60, at / 60) { 40 } else { 200 }));
/// }
/// let film = Film::read(bytes, &Selection::default())?;
/// let shape = PostShape::Rectangle { along_px: 8.0, across_px: 8.0 };
/// let post = |column| Post { middle_px: [column, 9.5], shape };
/// let places = PostPlaces { frame: 0, posts: [post(13.5), post(45.5)] };
/// let motion = posts::follow(&film, &places, |_| true)?;
/// assert_eq!(motion.rest.frame, 0);
/// assert!((motion.approach_px()[2].unwrap() - 1.0).abs() < 0.05);
/// assert!(motion.inward_px()[0][2].unwrap().abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn follow(
    film: &Film,
    places: &PostPlaces,
    mut goes_on: impl FnMut((usize, usize)) -> bool + Send,
) -> Result<PostMotion, PostError> {
    check(film, places)?;
    let all = 2 * film.len();
    let first = pass(film, places, |done| goes_on((done, all)))?;
    if first.interrupted {
        return Ok(first);
    }
    require_found(&first)?;
    let rest = at_rest(&first);
    if first.frames[rest] == places.frame {
        goes_on((all, all));
        return Ok(first);
    }
    let mut posts = places.posts;
    for (post, track) in posts.iter_mut().zip(&first.tracks) {
        if let Some(moved) = track.displacement_px[rest] {
            post.middle_px = [0, 1].map(|k: usize| post.middle_px[k] + moved[k]);
        }
    }
    let places = PostPlaces { frame: first.frames[rest], posts };
    let second = pass(film, &places, |done| goes_on((film.len() + done, all)))?;
    if !second.interrupted {
        require_found(&second)?;
    }
    Ok(second)
}

/// Checks the places that were given.
fn check(film: &Film, places: &PostPlaces) -> Result<(), PostError> {
    let frame_px = film.size();
    for (at, Post { middle_px, shape }) in places.posts.into_iter().enumerate() {
        let largest = frame_px[0].max(frame_px[1]) as f64;
        let is_fit = |side: &f64| (SMALLEST_POST_PX..=largest).contains(side);
        if let Some(side_px) = shape.sides_px().into_iter().find(|side| !is_fit(side)) {
            return Err(PostError::Size { post: at, side_px, frame_px });
        }
        let is_within = |k: usize| (0.0..=frame_px[k] as f64 - 1.0).contains(&middle_px[k]);
        if !(is_within(0) && is_within(1)) {
            return Err(PostError::Outside { post: at, middle_px, frame_px });
        }
    }
    let sides = places.posts.map(|post| post.shape.sides_px()[0]);
    let (distance_px, side_px) = (places.distance_px(), f64::midpoint(sides[0], sides[1]));
    if distance_px < side_px {
        return Err(PostError::Overlap { distance_px, side_px });
    }
    Ok(())
}

/// The posts in the frame in which they are known.
fn patches(film: &Film, places: &PostPlaces) -> Result<[Patch; 2], PostError> {
    let Rest { noise, .. } = Rest::at(film, places.frame)?;
    let plane = film.frame(places.frame)?;
    let one = |at: usize| {
        let Post { middle_px, shape } = places.posts[at];
        let [along, across] = shape.sides_px();
        let far = (FARTHEST[0] * along.max(across)).min(FARTHEST[1] * places.distance_px());
        let body = Body::of(shape, places.axis());
        let flat = |contrast| PostError::Flat { post: at, middle_px, contrast, noise };
        Patch::new(&plane, middle_px, body, far, noise).map_err(flat)
    };
    Ok([one(0)?, one(1)?])
}

/// Follows both posts from the frame in which they are known, forward and then backward.
fn pass(
    film: &Film,
    places: &PostPlaces,
    mut goes_on: impl FnMut(usize) -> bool + Send,
) -> Result<PostMotion, PostError> {
    let patches = patches(film, places)?;
    let mut seen: Vec<Option<[Look; 2]>> = vec![None; film.len()];
    let ways: [Vec<usize>; 2] =
        [(places.frame..film.len()).collect(), (0..places.frame).rev().collect()];
    let mut done = 0;
    'ways: for way in &ways {
        let mut near = [[0.0; 2]; 2];
        let mut next = way.first().map(|&first| film.frame(first)).transpose()?;
        for (at, &index) in way.iter().enumerate() {
            let Some(plane) = next.take() else { break };
            // The next frame is decoded meanwhile.
            let following = way.get(at + 1).copied();
            let decode = || following.map(|index| film.frame(index)).transpose();
            let (looks, decoded) = rayon::join(|| look(&patches, &plane, near), decode);
            next = decoded?;
            for (near, look) in near.iter_mut().zip(&looks) {
                *near = look.0.map_or(*near, |seen| seen.shift);
            }
            seen[index] = Some(looks);
            done += 1;
            if !goes_on(done) {
                break 'ways;
            }
        }
    }
    let frames: Vec<usize> = (0..film.len()).filter(|&at| seen[at].is_some()).collect();
    let looks: Vec<[Look; 2]> = seen.into_iter().flatten().collect();
    let track = |post: usize| PostTrack {
        displacement_px: looks.iter().map(|look| look[post].0.map(|seen| seen.shift)).collect(),
        correlation: looks.iter().map(|look| look[post].1).collect(),
        error_px: looks.iter().map(|look| look[post].0.map(|seen| seen.error)).collect(),
    };
    let interrupted = frames.len() < film.len();
    Ok(PostMotion { rest: *places, frames, interrupted, tracks: [track(0), track(1)] })
}

/// Both posts in a frame.
fn look(patches: &[Patch; 2], plane: &Plane, near: [[f64; 2]; 2]) -> [Look; 2] {
    let of = |post: usize| patches[post].find(plane, near[post]);
    let (first, second) = rayon::join(|| of(0), || of(1));
    [first, second]
}

/// # Errors
/// A post that was found in too few frames.
fn require_found(motion: &PostMotion) -> Result<(), PostError> {
    for (post, track) in motion.tracks.iter().enumerate() {
        let found = track.displacement_px.iter().flatten().count();
        let share = found as f64 / motion.frames.len().max(1) as f64;
        if share < LEAST_FOUND {
            let PostPlaces { frame, posts } = motion.rest;
            let middle_px = posts[post].middle_px;
            return Err(PostError::Lost { post, middle_px, found_pct: 100.0 * share, frame });
        }
    }
    Ok(())
}

/// Place in the lists of the frame at rest: the posts are farthest apart there, or as far as noise can tell.
fn at_rest(motion: &PostMotion) -> usize {
    let approach = motion.approach_px();
    let error = |at: usize| {
        let [a, b] = [0, 1].map(|post: usize| motion.tracks[post].error_px[at].unwrap_or(0.0));
        a.hypot(b)
    };
    let errors: Vec<f64> =
        (0..approach.len()).filter(|&at| approach[at].is_some()).map(error).collect();
    let usual = order::median(errors).unwrap_or(0.0);
    let found = || approach.iter().enumerate().filter_map(|(at, near)| Some((at, (*near)?)));
    let least = found().map(|(_, near)| near).fold(f64::INFINITY, f64::min);
    let mut resting: Vec<(usize, f64)> =
        found().filter(|(_, near)| *near <= least + AT_REST * usual).collect();
    resting.sort_by(|a, b| a.1.total_cmp(&b.1));
    resting.get(resting.len() / 2).map_or(0, |(at, _)| *at)
}
