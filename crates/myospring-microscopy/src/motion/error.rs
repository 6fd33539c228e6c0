//! Reasons why a cell cannot be followed.

use crate::film::FilmError;

/// Smallest and largest frame rate, frames a second: one frame an hour, and more than the fastest
/// cameras.
pub(crate) const RATES: [f64; 2] = [1.0 / 3600.0, 1e6];

/// Reasons why a cell cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// A frame cannot be read.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A frame rate that is out of range.
    #[error(
        "the frame rate is {rate} frames a second; it must be above 0 and between {:.4} and {}",
        RATES[0], RATES[1]
    )]
    Rate {
        /// Frames a second.
        rate: f64,
    },
    /// The mask has another size than the film.
    #[error("the mask of the cell does not have the {width} x {height} pixels of the film")]
    Mask {
        /// Columns of the film.
        width: usize,
        /// Rows of the film.
        height: usize,
    },
    /// The cell has too little texture to be followed.
    #[error(
        "only {textured_pct:.0} % of the cell has enough texture to be followed: its grey values vary by {contrast:.1} and \
         the noise is {noise:.1}; give a larger --subset, or a film with more light or a stain that shows structure"
    )]
    Flat {
        /// Part of the points with enough texture, per cent.
        textured_pct: f64,
        /// Standard deviation of the noise, grey levels.
        noise: f64,
        /// Standard deviation of the frame at rest, grey levels.
        contrast: f64,
    },
    /// Too few points are found again.
    #[error(
        "only {found_pct:.0} % of the points are found again in the median frame (in frame {frame} \
         {least_pct:.0} %): the film shows noise, another cell, or a motion too fast for its frame rate; choose the \
         frame at rest with --frame, or give a larger --subset"
    )]
    Lost {
        /// Part of the points that were found in the median frame, per cent.
        found_pct: f64,
        /// The frame with the fewest.
        frame: usize,
        /// Part that was found there, per cent.
        least_pct: f64,
    },
    /// The system cannot start threads.
    #[error("threads cannot be started: {cause}")]
    Threads {
        /// What the system says.
        cause: String,
    },
}
