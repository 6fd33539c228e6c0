//! How displacements were found in pictures of beads.

use serde::Serialize;

/// How displacements were found in pictures of beads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Followed {
    /// The film.
    pub film: String,
    /// What displacements are relative to.
    pub reference: String,
    /// Whether that is a frame of the film, so that the cell's tension at rest is not seen.
    pub relative_to_rest: bool,
    /// Side of a pixel of the pictures, um.
    pub film_pixel_size_um: f64,
    /// Columns and rows of the displacements.
    pub places: [usize; 2],
    /// Column and row, in the pictures, of the pixel of the upper left displacement.
    pub first_place_px: [usize; 2],
    /// Distance of displacements, pixels of the pictures.
    pub spacing_px: usize,
    /// Side of the squares that were matched, um.
    pub subset_um: f64,
    /// Mean distance of beads, um.
    pub bead_distance_um: f64,
    /// Standard error of a displacement, um, from the residual grey values of matched squares.
    pub displacement_error_um: Option<f64>,
    /// Median correlation of the squares that were found, over frames.
    pub correlation: Option<f64>,
    /// Places that were interpolated from their neighbours, %, on average and in the frame with the most.
    pub interpolated_pct_mean: f64,
    /// See above.
    pub interpolated_pct_most: f64,
    /// How the motion of the stage was determined.
    pub stage: &'static str,
    /// Its largest size, um.
    pub stage_largest_um: f64,
    /// Its course, um, to the right and upward, by frame.
    #[serde(skip)]
    pub stage_um: Vec<[f64; 2]>,
    /// Places that were interpolated, %, by frame.
    #[serde(skip)]
    pub interpolated_pct: Vec<f64>,
    /// Frames that repeat the one before and were left out.
    pub repeated_frames: usize,
    /// Whether it was interrupted before all frames were done.
    pub interrupted: bool,
}
