//! The numbers of posts that were followed.

use crate::mesh::pixel_size::{PixelSize, PixelSizeError};
use crate::microscopy::film::Film;
use crate::microscopy::posts::{FoundPosts, Post, PostMotion};
use serde::Serialize;
use std::path::Path;

/// Part of the frames in which both posts must be found, so that nothing is said.
const MOST: f64 = 0.95;
/// Largest approach over its standard error, below which the posts may as well be still.
const SURE: f64 = 3.0;

/// A post at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PostReport {
    /// Column and row of its middle, pixels from the centre of the upper left one.
    pub middle_px: [f64; 2],
    /// Its lengths along the line between the posts and across it, pixels.
    pub sides_px: [f64; 2],
}

/// Every number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PostsReport {
    /// The film.
    pub film: String,
    /// Its frames, and how many were followed.
    pub frames: usize,
    /// See above.
    pub frames_followed: usize,
    /// Frames a second.
    pub frames_per_second: f64,
    /// Side of a pixel, um.
    pub pixel_size_um: f64,
    /// The frame in which the posts are farthest apart.
    pub rest_frame: usize,
    /// The posts in it.
    pub posts: [PostReport; 2],
    /// Whether they were found; otherwise their places were stated.
    pub found: bool,
    /// Of posts that were found, how much stronger the edge of the weaker one is than that of any other object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stands_out: Option<f64>,
    /// Distance of their middles at rest, um.
    pub distance_um: f64,
    /// Part of the frames in which both were found, %.
    pub found_pct: f64,
    /// The largest approach of both, um, and its frame; none if they were found in no frame.
    pub largest_approach_um: Option<f64>,
    /// See above.
    pub largest_approach_frame: Option<usize>,
    /// Median standard error of the approach in one frame, um, from the residual grey values.
    pub approach_error_um: Option<f64>,
    /// Stiffness of one post, nN/um, if it was stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_nn_per_um: Option<f64>,
    /// The force on each post at the largest approach, nN.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_force_nn: Option<f64>,
    /// Whether it was interrupted before all frames were done.
    pub interrupted: bool,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl PostsReport {
    pub(super) fn of(
        path: &Path,
        film: &Film,
        motion: &PostMotion,
        found: Option<&FoundPosts>,
    ) -> Self {
        let post =
            |post: Post| PostReport { middle_px: post.middle_px, sides_px: post.shape.sides_px() };
        Self {
            film: path.display().to_string(),
            frames: film.len(),
            frames_followed: motion.frames.len(),
            frames_per_second: f64::NAN,
            pixel_size_um: f64::NAN,
            rest_frame: motion.rest.frame,
            posts: motion.rest.posts.map(post),
            found: found.is_some(),
            stands_out: found.map(|found| found.stands_out),
            distance_um: f64::NAN,
            found_pct: 100.0 * motion.found_share(),
            largest_approach_um: None,
            largest_approach_frame: None,
            approach_error_um: None,
            stiffness_nn_per_um: None,
            largest_force_nn: None,
            interrupted: motion.interrupted,
            warnings: film.notes.clone(),
        }
    }

    /// What follows from the motion and the pixel size.
    pub(super) fn measure(&mut self, motion: &PostMotion) {
        let pixel = self.pixel_size_um;
        self.distance_um = pixel * motion.rest.distance_px();
        let approach = motion.approach_px();
        let known =
            approach.iter().zip(&motion.frames).filter_map(|(px, frame)| Some(((*px)?, *frame)));
        let largest = known.max_by(|a, b| a.0.total_cmp(&b.0));
        self.largest_approach_um = largest.map(|(px, _)| pixel * px);
        self.largest_approach_frame = largest.map(|(_, frame)| frame);
        let [one, two] = &motion.tracks;
        let errors = one.error_px.iter().zip(&two.error_px);
        let mut errors: Vec<f64> = errors.filter_map(|(a, b)| Some((*a)?.hypot((*b)?))).collect();
        errors.sort_by(f64::total_cmp);
        self.approach_error_um = errors.get(errors.len() / 2).map(|px| pixel * px);
        self.largest_force_nn = self
            .stiffness_nn_per_um
            .zip(self.largest_approach_um)
            .map(|(stiffness, approach)| 0.5 * stiffness * approach);
        if self.found_pct < 100.0 * MOST {
            self.warnings.push(format!(
                "both posts are found again in {:.0} % of the frames; the others have no row with a force",
                self.found_pct
            ));
        }
        if let (Some(approach), Some(error)) = (self.largest_approach_um, self.approach_error_um)
            && approach < SURE * error
        {
            self.warnings.push(format!(
                "the posts come nearer by {approach:.3} um at most, where a frame has an error of {error:.3} um: this may be noise"
            ));
        }
        if self.interrupted {
            self.warnings.push(format!(
                "interrupted: {} of {} frames were followed",
                self.frames_followed, self.frames
            ));
        }
    }

    pub(super) fn pixel_size(&self) -> Result<PixelSize, PixelSizeError> {
        PixelSize::new(self.pixel_size_um)
    }
}
