//! The search for two posts in a film.

use super::blobs::{self, Blob, Blobs};
use super::error::{Doubt, PostError, STANDS_OUT};
use super::patch::{Patch, Seen};
use super::post::{Body, Post, PostPlaces, PostShape};
use crate::film::Film;
use crate::motion::Rest;
use crate::plane::Plane;
use myospring_core::analysis::order;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Largest ratio of the diameters and of the strengths of two posts: both are made alike, but seen in uneven light.
const WIDER: f64 = 1.5;
const STRONGER: f64 = 3.0;
/// Least distance of two posts, mean diameters.
const APART: f64 = 1.5;
/// Least step in brightness on the side of a post that faces the other one, as a part of its strength. The round end of a tissue
/// has no edge there, since the tissue goes on.
const FACING: f64 = 0.5;
/// Number of the strongest objects of each brightness of which pairs are made, and of pairs that are looked at in the film.
const STRONGEST: usize = 160;
const PAIRS: usize = 10;
/// Largest number of frames in which motion is sought.
const MOST_FRAMES: usize = 32;
/// Farthest that a post is sought from its place, diameters.
const FARTHEST: f64 = 0.6;
/// Least part of these in which a post is found.
const LEAST_FOUND: f64 = 0.5;
/// Least standard deviation of the approach of two posts, standard errors of a single frame; noise alone gives 1.
const MOVES: f64 = 2.0;

/// Two posts that were found, with the evidence for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundPosts {
    /// Where they are, each as a disc.
    pub places: PostPlaces,
    /// Brightness step at the edge of the weaker post over that of the strongest object elsewhere; above 1.3.
    pub stands_out: f64,
    /// Standard deviation of the approach of the posts over the frames that were looked at, pixels.
    pub approach_px: f64,
    /// Its standard error in one frame, pixels.
    pub error_px: f64,
}

/// Finds the two posts of a tissue: the most distinct pair of similar compact objects that move toward each other and back.
///
/// 1. The frame that is most similar to many others ([`Rest::find`]) is searched for objects. An object is a disc with the same
///    step in brightness, up or down, on at least three quarters of its edge.
/// 2. Two objects are a pair if both are brighter or both are darker than their surroundings, their diameters differ by less than
///    half, they are at least one and a half diameters apart, and each has an edge on the side that faces the other. The round end of
///    a tissue has none there.
/// 3. The distance of a pair must vary in the film, more than its error and more than the pair moves across the line between its
///    objects. The motion of the stage does not matter.
/// 4. The edges of both must be 1.3 times stronger than that of any other object, because a texture has compact objects, too.
///
/// Posts are returned from left to right, each as a disc. In a square post the disc touches the sides; of a post with a rim
/// it may be the inner or the outer edge. Of posts that are more than one and a half times as long as wide, a part may be
/// found, or a post together with the end of a tissue that is dark, too: state the places of such posts.
///
/// # Errors
/// A frame that cannot be read, or no such pair; the error says what was found instead.
///
/// # Example
/// Two dark squares on a bright ground; the right one moves.
/// ```
/// use myospring::microscopy::film::Film;
/// use myospring::microscopy::picture::Selection;
/// use myospring::microscopy::posts;
/// let mut bytes = b"YUV4MPEG2 W90 H30 F50:1 Cmono\n".to_vec();
/// for moved in [0, 0, 0, 2, 3, 2, 0, 0] {
///     bytes.extend(b"FRAME\n");
///     let is_dark = |x: usize, y: usize| {
///         (8..20).contains(&y) && ((10..22).contains(&x) || (65 - moved..77 - moved).contains(&x))
///     };
///     bytes.extend((0..2700).map(|at| if is_dark(at % 90, at / 90) { 40 } else { 200 }));
/// }
/// let film = Film::read(bytes, &Selection::default())?;
/// let [left, right] = posts::find(&film)?.places.posts;
/// assert!((left.middle_px[0] - 15.5).abs() < 1.0 && (left.middle_px[1] - 13.5).abs() < 1.0);
/// assert!((right.middle_px[0] - 70.5).abs() < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find(film: &Film) -> Result<FoundPosts, PostError> {
    let rest = Rest::find(film)?;
    let plane = film.frame(rest.frame)?;
    let objects = Blobs::of(&plane);
    let pairs = pairs(&objects);
    let blobs = &objects.all;
    let diameters_px = blobs::diameters(film.size());
    let missing = |best: Option<[Blob; 2]>, doubt: Doubt| {
        let posts = best.map(|pair| pair.map(|blob| post(&blob)));
        PostError::NotFound { frame: rest.frame, diameters_px, best: posts, doubt }
    };
    let Some(&[first, second]) = pairs.first() else {
        return Err(missing(None, Doubt::Alone));
    };
    let tracks = tracks(film, &plane, rest, blobs, &pairs)?;
    let mut doubt = None;
    for &[a, b] in &pairs {
        let pair = [blobs[a], blobs[b]];
        let stands_out = stands_out(blobs, [a, b]);
        let motion = Motion::of(&pair, [&tracks[&a], &tracks[&b]]);
        let is_moving = motion.is_some_and(|motion| motion.is_approach());
        if is_moving && stands_out >= STANDS_OUT {
            let Motion { along: approach_px, error: error_px, .. } = motion.unwrap_or_default();
            let mut posts = pair.map(|blob| post(&blob));
            let [u, v] = posts.map(|post| post.middle_px);
            if u[0] > v[0] {
                posts.swap(0, 1);
            }
            let places = PostPlaces { frame: rest.frame, posts };
            return Ok(FoundPosts { places, stands_out, approach_px, error_px });
        }
        if doubt.is_none() && stands_out >= STANDS_OUT {
            let Motion { along: approach_px, across: across_px, error: error_px } =
                motion.unwrap_or_default();
            doubt = Some(missing(Some(pair), Doubt::Still { approach_px, across_px, error_px }));
        }
    }
    let ratio = stands_out(blobs, [first, second]);
    let common = || missing(Some([blobs[first], blobs[second]]), Doubt::Common { ratio });
    Err(doubt.unwrap_or_else(common))
}

/// An object as a post.
fn post(blob: &Blob) -> Post {
    let shape = PostShape::Round { diameter_px: blob.diameter };
    Post { middle_px: blob.middle, shape }
}

/// Pairs of objects that may be two posts, by the strength of the weaker one; of those at about the same places the first only.
fn pairs(objects: &Blobs) -> Vec<[usize; 2]> {
    let blobs = &objects.all;
    let has_edge = |a: &Blob, b: &Blob| objects.facing(a, b.middle) >= FACING * a.strength;
    let is_pair = |[a, b]: [usize; 2]| {
        let [a, b] = [blobs[a], blobs[b]];
        let wider = a.diameter.max(b.diameter) / a.diameter.min(b.diameter);
        wider <= WIDER
            && a.strength <= STRONGER * b.strength
            && a.distance(&b) >= APART * f64::midpoint(a.diameter, b.diameter)
            && has_edge(&a, &b)
            && has_edge(&b, &a)
    };
    let mut all = Vec::new();
    for bright in [false, true] {
        let alike = (0..blobs.len()).filter(|&at| blobs[at].bright == bright);
        let alike: Vec<usize> = alike.take(STRONGEST).collect();
        // Blobs are sorted, so the second is the weaker one.
        let made = (0..alike.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        all.extend(made.map(|pair| pair.map(|at| alike[at])).filter(|&pair| is_pair(pair)));
    }
    all.sort_by_key(|&[a, b]| (b, a));
    let mut kept: Vec<[usize; 2]> = Vec::new();
    for pair in all {
        let is_near = |a: usize, b: usize| {
            let [a, b] = [blobs[a], blobs[b]];
            a.distance(&b) < 0.5 * a.diameter.max(b.diameter)
        };
        let is_old = |old: &[usize; 2]| {
            (is_near(pair[0], old[0]) && is_near(pair[1], old[1]))
                || (is_near(pair[0], old[1]) && is_near(pair[1], old[0]))
        };
        if !kept.iter().any(is_old) {
            kept.push(pair);
            if kept.len() == PAIRS {
                break;
            }
        }
    }
    kept
}

/// Strength of the weaker object over that of the strongest other one, alike in brightness, that does not overlap either.
fn stands_out(blobs: &[Blob], pair: [usize; 2]) -> f64 {
    let own = pair.map(|at| blobs[at]);
    let is_other = |blob: &&Blob| {
        let apart = |one: &Blob| blob.distance(one) > 0.5 * (blob.diameter + one.diameter);
        blob.bright == own[0].bright && own.iter().all(apart)
    };
    let weaker = own[0].strength.min(own[1].strength);
    let other = blobs.iter().filter(is_other).map(|blob| blob.strength).fold(0.0, f64::max);
    if other > 0.0 { weaker / other } else { f64::INFINITY }
}

/// The objects of the pairs in some frames of the film, by their numbers; empty for those that cannot be followed.
fn tracks(
    film: &Film,
    plane: &Plane,
    rest: Rest,
    blobs: &[Blob],
    pairs: &[[usize; 2]],
) -> Result<BTreeMap<usize, Vec<Option<Seen>>>, PostError> {
    let patch = |at: &usize| {
        let Blob { diameter, middle, .. } = blobs[*at];
        let body = Body::of(PostShape::Round { diameter_px: diameter }, [1.0, 0.0]);
        Patch::new(plane, middle, body, FARTHEST * diameter, rest.noise).ok()
    };
    let wanted: BTreeSet<usize> = pairs.iter().flatten().copied().collect();
    let patches: Vec<Option<Patch>> = wanted.iter().map(patch).collect();
    let mut tracks = vec![Vec::new(); patches.len()];
    let every = film.len().div_ceil(MOST_FRAMES);
    for index in (0..film.len()).step_by(every) {
        let now = film.frame(index)?;
        tracks.par_iter_mut().zip(&patches).for_each(|(track, patch)| {
            if let Some(patch) = patch {
                track.push(patch.find(&now, [0.0; 2]).0);
            }
        });
    }
    Ok(wanted.into_iter().zip(tracks).collect())
}

/// How two objects move relative to each other.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    /// Standard deviation of their relative motion along the line between them and across it, pixels.
    along: f64,
    across: f64,
    /// Standard error of one frame, pixels.
    error: f64,
}

impl Motion {
    /// `None` if they are found together in too few frames.
    fn of(pair: &[Blob; 2], tracks: [&Vec<Option<Seen>>; 2]) -> Option<Self> {
        let axis = PostPlaces { frame: 0, posts: pair.map(|blob| post(&blob)) }.axis();
        let both = || tracks[0].iter().zip(tracks[1]).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let frames = tracks[0].len().max(1) as f64;
        if (both().count() as f64) < LEAST_FOUND * frames {
            return None;
        }
        let relative = |(a, b): (Seen, Seen)| [0, 1].map(|k: usize| b.shift[k] - a.shift[k]);
        let along = both().map(relative).map(|[x, y]| x * axis[0] + y * axis[1]);
        let across = both().map(relative).map(|[x, y]| y * axis[0] - x * axis[1]);
        let errors: Vec<f64> = both().map(|(a, b)| a.error.hypot(b.error)).collect();
        let error = order::median(errors)?;
        Some(Self { along: deviation(along), across: deviation(across), error })
    }

    fn is_approach(&self) -> bool {
        self.along > MOVES * self.error && self.along > self.across
    }
}

fn deviation(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
