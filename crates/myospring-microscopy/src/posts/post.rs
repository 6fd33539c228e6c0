//! Where a post is, and which pixels belong to it.

/// Outline of a post as the microscope sees it, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PostShape {
    /// A round post.
    Round {
        /// Diameter.
        diameter_px: f64,
    },
    /// A rectangular post, two sides of which are along the line between the posts.
    Rectangle {
        /// Side along the line between the posts.
        along_px: f64,
        /// Side across that line.
        across_px: f64,
    },
}

impl PostShape {
    /// Lengths along the line between the posts and across it, pixels.
    pub fn sides_px(self) -> [f64; 2] {
        match self {
            Self::Round { diameter_px } => [diameter_px; 2],
            Self::Rectangle { along_px, across_px } => [along_px, across_px],
        }
    }
}

/// A post in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Post {
    /// Column and row of its middle, pixels: the centre of the upper left pixel is `[0.0, 0.0]`, rows run downward.
    pub middle_px: [f64; 2],
    /// Its outline.
    pub shape: PostShape,
}

/// Two posts in one frame of a film.
///
/// # Example
/// ```
/// use myospring::microscopy::posts::{Post, PostPlaces, PostShape};
/// let shape = PostShape::Round { diameter_px: 20.0 };
/// let post = |column| Post { middle_px: [column, 30.0], shape };
/// let places = PostPlaces { frame: 0, posts: [post(25.0), post(90.0)] };
/// assert_eq!(places.distance_px(), 65.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PostPlaces {
    /// Number of the frame in which the posts are at these places, from 0.
    pub frame: usize,
    /// The posts.
    pub posts: [Post; 2],
}

impl PostPlaces {
    /// Distance of the two middles, pixels.
    pub fn distance_px(&self) -> f64 {
        let [a, b] = self.posts.map(|post| post.middle_px);
        (b[0] - a[0]).hypot(b[1] - a[1])
    }

    /// Unit vector from the first post to the second, to the right and downward; `[1.0, 0.0]` if both are at one place.
    pub fn axis(&self) -> [f64; 2] {
        let [a, b] = self.posts.map(|post| post.middle_px);
        let distance = self.distance_px();
        if distance > 0.0 { [0, 1].map(|k: usize| (b[k] - a[k]) / distance) } else { [1.0, 0.0] }
    }
}

/// The pixels of a post and of its rim.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    /// Half of its lengths along and across the axis with the rim, pixels.
    half: [f32; 2],
    axis: [f32; 2],
    round: bool,
}

/// Width of the rim as a part of the smaller side, and at least, pixels: it holds the edge of the post, which shows where a post
/// without structure is, and little of the tissue, which moves differently.
const RIM: f64 = 0.1;
const LEAST_RIM: f64 = 2.0;

impl Body {
    /// The body of a post on a line with this direction.
    pub(super) fn of(shape: PostShape, axis: [f64; 2]) -> Self {
        let sides = shape.sides_px();
        let rim = (RIM * sides[0].min(sides[1])).max(LEAST_RIM);
        Self {
            half: sides.map(|side| (0.5 * side + rim) as f32),
            axis: axis.map(|part| part as f32),
            round: matches!(shape, PostShape::Round { .. }),
        }
    }

    /// Whether a pixel at this distance from the middle belongs to it.
    pub(super) fn has(&self, [x, y]: [f32; 2]) -> bool {
        let [ax, ay] = self.axis;
        let along = (x * ax + y * ay) / self.half[0];
        let across = (y * ax - x * ay) / self.half[1];
        if self.round {
            along * along + across * across <= 1.0
        } else {
            along.abs().max(across.abs()) <= 1.0
        }
    }

    /// Largest distance of its pixels from the middle along a row or a column, whole pixels.
    pub(super) fn reach(&self) -> usize {
        let [ax, ay] = self.axis.map(f32::abs);
        let reach = if self.round {
            self.half[0]
        } else {
            (self.half[0] * ax + self.half[1] * ay).max(self.half[0] * ay + self.half[1] * ax)
        };
        // The middle may be half a pixel from a pixel's centre.
        (reach + 0.5).ceil() as usize
    }
}
