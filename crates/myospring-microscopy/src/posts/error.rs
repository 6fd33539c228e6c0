//! Why posts are not found or cannot be followed.

use super::post::Post;
use crate::film::FilmError;

/// Smallest side of a post, pixels: with its rim it then has about eight pixels of independent brightness.
pub const SMALLEST_POST_PX: f64 = 5.0;

/// How much stronger the weaker post is than the strongest object beside the posts, at least. By a rough estimate, not a
/// measurement, chance reaches this factor between the second and third strongest of hundreds of objects with normally distributed
/// strengths in less than one of a thousand pictures. Real films have 1.37 to 1.88 with posts, and 1.04 to 1.14 without.
pub(super) const STANDS_OUT: f64 = 1.3;

/// Why posts are not found or cannot be followed. Posts count from 1 in messages.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PostError {
    /// A frame cannot be read.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A side of a post that is too small or too large.
    #[error(
        "post {} has a side of {side_px} pixels; it must have at least {SMALLEST_POST_PX} and fit into the frame of {} x {} pixels",
        post + 1, frame_px[0], frame_px[1]
    )]
    Size {
        /// 0 or 1.
        post: usize,
        /// The side.
        side_px: f64,
        /// Columns and rows of the film.
        frame_px: [usize; 2],
    },
    /// The middle of a post is not in the frame.
    #[error(
        "the middle of post {} is at column {}, row {}, but the frame has {} x {} pixels, from 0; state places in pixels, not in um",
        post + 1, middle_px[0], middle_px[1], frame_px[0], frame_px[1]
    )]
    Outside {
        /// 0 or 1.
        post: usize,
        /// Column and row.
        middle_px: [f64; 2],
        /// Columns and rows of the film.
        frame_px: [usize; 2],
    },
    /// Both posts are at the same place.
    #[error(
        "the posts are {distance_px:.1} pixels apart and {side_px:.1} pixels wide, so they overlap; state the place of each post, \
         and sizes in pixels"
    )]
    Overlap {
        /// Distance of the middles.
        distance_px: f64,
        /// Mean side along the line between them.
        side_px: f64,
    },
    /// Nothing at the place of a post can be followed.
    #[error(
        "nothing can be followed at post {} (column {:.0}, row {:.0}): the grey values there vary by {contrast:.2} and the noise \
         is {noise:.2}; state a place and a size with an edge or a structure that moves with the post",
        post + 1, middle_px[0], middle_px[1]
    )]
    Flat {
        /// 0 or 1.
        post: usize,
        /// Column and row.
        middle_px: [f64; 2],
        /// Standard deviation of the grey values of the post and its rim.
        contrast: f64,
        /// That of the noise.
        noise: f64,
    },
    /// A post is seen in too few frames.
    #[error(
        "post {} (column {:.0}, row {:.0}) is found again in only {found_pct:.0} % of the frames: is this the place of a post, or is \
         it covered or out of focus? State its place and size in frame {frame}",
        post + 1, middle_px[0], middle_px[1]
    )]
    Lost {
        /// 0 or 1.
        post: usize,
        /// Column and row at the start.
        middle_px: [f64; 2],
        /// Part of the frames in which it is found, per cent.
        found_pct: f64,
        /// The frame in which it was sought first.
        frame: usize,
    },
    /// No two posts were found.
    #[error(
        "no two posts were found. Frame {frame} was searched for two compact objects of similar size ({:.0} to {:.0} pixels wide), \
         both brighter or both darker than their surroundings, that move toward each other and back in the film. {} State the \
         places and sizes of the posts, in pixels",
        diameters_px[0], diameters_px[1], found(best.as_ref(), doubt)
    )]
    NotFound {
        /// The frame in which objects were sought.
        frame: usize,
        /// Range of diameters.
        diameters_px: [f64; 2],
        /// The most distinct pair.
        best: Option<[Post; 2]>,
        /// Why it was not taken.
        doubt: Doubt,
    },
}

/// Why two objects were not taken for posts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// No two objects are similar.
    Alone,
    /// Other objects are about as distinct.
    Common {
        /// Strength of the edge of the weaker one over that of the strongest other object.
        ratio: f64,
    },
    /// They do not move toward each other.
    Still {
        /// Standard deviation of their relative motion along the line between them, pixels; 0 if they were lost.
        approach_px: f64,
        /// The same across that line, pixels.
        across_px: f64,
        /// Standard error of both in one frame, pixels.
        error_px: f64,
    },
}

/// What was found instead of posts.
fn found(best: Option<&[Post; 2]>, doubt: &Doubt) -> String {
    let Some(posts) = best else { return "No two such objects are similar.".to_owned() };
    let [first, second] = posts.map(|Post { middle_px: [column, row], shape }| {
        let [side, _] = shape.sides_px();
        format!("column {column:.0}, row {row:.0} ({side:.0} pixels wide)")
    });
    let objects = format!("The most distinct are at {first} and {second}");
    match doubt {
        Doubt::Alone => format!("{objects}."),
        Doubt::Common { ratio } => format!(
            "{objects}, but other places are nearly as distinct: the weaker edge of the two is {ratio:.2} times as strong as the \
             strongest elsewhere, and {STANDS_OUT} times is needed."
        ),
        Doubt::Still { approach_px, .. } if *approach_px == 0.0 => {
            format!("{objects}, but they are not found again in the other frames.")
        }
        Doubt::Still { approach_px, across_px, error_px } => format!(
            "{objects}, but they do not beat: their distance varies by {approach_px:.2} pixels (standard deviation), they move \
             {across_px:.2} pixels across the line between them, and the error is {error_px:.2} pixels."
        ),
    }
}
