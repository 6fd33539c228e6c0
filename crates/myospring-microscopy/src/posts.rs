//! The two flexible posts that hold an engineered heart tissue: where they are, and how they move in a film.
//!
//! A tissue between two posts pulls both toward each other with each beat. A post bends like a spring, so its displacement
//! times its stiffness is the force of the tissue.
//!
//! 1. [`find()`] searches for the two posts: the most distinct pair of similar compact objects that move toward each other and back.
//!    Or the caller states their places in one frame ([`PostPlaces`]).
//! 2. [`follow()`] matches the picture of each post, with its rim, in every frame: first on a coarse grid by normalised
//!    cross-correlation, then, to a fraction of a pixel, by Gauss-Newton steps on the zero-normalised sum of squared
//!    differences, as `motion` does for the points of a cell. Posts are rigid, so only a shift is fitted, no gradients.
//! 3. The frame in which the posts are farthest apart is at rest. Every frame is compared with it, so errors do not add up.
//!
//! Displacements are pixels, to the right and downward, as in a [`Plane`](crate::plane::Plane). The motion of the stage shifts both
//! posts alike: [`PostMotion::approach_px`] does not contain it, and [`PostMotion::without_drift_px`] removes it where both posts
//! bend by the same amount. In a frame in which a post is lost it has no displacement; its best correlation is kept.

mod blobs;
mod circle;
mod coarse;
mod error;
mod find;
mod follow;
mod motion;
mod patch;
mod post;
mod window;

pub use error::{Doubt, PostError, SMALLEST_POST_PX};
pub use find::{FoundPosts, find};
pub use follow::follow;
pub use motion::{PostMotion, PostTrack};
pub use post::{Post, PostPlaces, PostShape};
