//! The displacement of a gel from pictures of the beads in it.
//!
//! Beads lie at random places, so every square that holds several of them has a pattern of its own. Its motion is followed as
//! that of a cell is ([`super::follow`]), at the points of a lattice over the whole frame, without averaging neighbours: the
//! square alone decides what is resolved.
//!
//! How large a square must be follows from the picture. The squared slopes of the grey values, summed over a square, are in
//! proportion to the number of beads in it; over squares at random places that number varies as a Poisson number does, so
//! `mean^2/variance` of the sum is the number of beads. The default is the smallest square with nine of them.

use super::cell::{CellAtRest, Progress, Texture, TrackingSettings};
use super::error::MotionError;
use super::level::SMOOTHING;
use super::rest::Rest;
use crate::film::Film;
use crate::filter;
use crate::outlines::PixelFrame;
use crate::plane::Plane;
use myospring_core::analysis::order;
use myospring_core::mesh::lattice;
use myospring_core::mesh::pixel_size::PixelSize;
use std::f64::consts::PI;

/// Beads in a square, by default. The affine motion of a square has six unknowns, and a bead has two coordinates: three beads
/// determine it, three times as many average their errors.
const BEADS: f64 = 9.0;
/// Smallest side of a square that is tried, pixels, and the factor from one to the next.
const SMALLEST: f64 = 17.0;
const NEXT: f64 = 1.12;
/// Fewest points of a lattice along each axis.
const FEWEST: usize = 8;
/// Part of the window along each edge that counts as far from the cell, if nothing else says where the cell is.
const RIM: f64 = 0.1;
/// Fewest points that say how the stage moved.
const FEWEST_FAR: usize = 8;

/// How beads are followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeadSettings {
    /// Side of a pixel.
    pub pixel_size: PixelSize,
    /// Side of the squares that are matched, um; `None` takes the smallest with nine beads.
    pub subset_um: Option<f64>,
    /// Number of threads; `None` uses one per core. Results do not depend on it.
    pub threads: Option<usize>,
}

/// Why beads cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BeadError {
    /// The picture at rest has nothing to follow.
    #[error(
        "frame {frame} shows no beads: its grey values vary by {contrast:.2}, of which {noise:.2} is noise"
    )]
    NoBeads {
        /// The frame.
        frame: usize,
        /// Standard deviation of its grey values.
        contrast: f64,
        /// That of their noise.
        noise: f64,
    },
    /// The frame is too small for the squares.
    #[error(
        "a frame of {} x {} um has room for {} x {} points with squares of {subset_um:.2} um; at least {FEWEST} x {FEWEST} \
         are needed",
        frame_um[0].round(), frame_um[1].round(), points[0], points[1]
    )]
    TooSmall {
        /// Width and height of the frame, um.
        frame_um: [f64; 2],
        /// Side of a square, um.
        subset_um: f64,
        /// Columns and rows of points.
        points: [usize; 2],
    },
    /// Too few squares have enough texture.
    #[error(
        "only {textured_pct:.0} % of the squares hold enough beads to be followed: the grey values vary by {contrast:.2} and \
         the noise is {noise:.2}"
    )]
    Flat {
        /// Part of the squares with enough texture, per cent.
        textured_pct: f64,
        /// Standard deviation of the grey values.
        contrast: f64,
        /// That of their noise.
        noise: f64,
    },
    /// Too few squares are found again.
    #[error(
        "only {found_pct:.0} % of the squares are found again in the median frame (in frame {frame} {least_pct:.0} %)"
    )]
    Lost {
        /// Part that was found in the median frame, per cent.
        found_pct: f64,
        /// The frame with the fewest.
        frame: usize,
        /// Part that was found there, per cent.
        least_pct: f64,
    },
    /// A frame that cannot be read, a frame size or threads that are not possible.
    #[error(transparent)]
    Motion(MotionError),
}

impl From<MotionError> for BeadError {
    fn from(cause: MotionError) -> Self {
        match cause {
            MotionError::Flat { textured_pct, noise, contrast } => {
                Self::Flat { textured_pct, contrast, noise }
            }
            MotionError::Lost { found_pct, frame, least_pct } => {
                Self::Lost { found_pct, frame, least_pct }
            }
            cause => Self::Motion(cause),
        }
    }
}

/// The displacement of the surface of a gel, on a lattice of points over the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct GelMotion {
    /// Distance of neighbouring points, pixels.
    pub step: usize,
    /// Columns and rows of points.
    pub shape: [usize; 2],
    /// Column and row, in the frame, of the pixel of the upper left point.
    pub first: [usize; 2],
    /// Side of a pixel, um.
    pub pixel_um: f64,
    /// Numbers in the film of the frames that were followed, ascending. All lists by frame are in this order.
    pub frames: Vec<usize>,
    /// Number of frames that repeat the one before; they were not followed.
    pub repeated: usize,
    /// Whether `goes_on` stopped it before all frames were done.
    pub interrupted: bool,
    /// Number of the frame at rest.
    pub rest: usize,
    /// Displacement of each point from rest, um, to the right and upward, row by row from the lowest:
    /// `displacements_um[frame][axis][point]`. The motion of the stage is in it until [`GelMotion::take_drift`].
    pub displacements_um: Vec<[Vec<f64>; 2]>,
    /// Which points were interpolated from their neighbours: `interpolated[frame][point]`.
    pub interpolated: Vec<Vec<bool>>,
    /// Median zero-normalised correlation of the points that were found, by frame.
    pub correlation: Vec<Option<f64>>,
    /// Median standard error of a point's displacement, um. The residual grey values of matched squares count as noise.
    pub error_um: Option<f64>,
    /// Side of the squares that were matched, um.
    pub subset_um: f64,
    /// Mean distance of beads, um.
    pub bead_distance_um: f64,
}

impl GelMotion {
    /// Points along the side of a square, which share their errors, since they see the same beads. With two, every place of the
    /// picture lies in four squares; a motion that varies within half a square is not resolved anyway.
    pub const OVERLAP: usize = 2;

    /// Part of the points of a frame that were interpolated, by its place in the lists.
    pub fn interpolated_share(&self, at: usize) -> f64 {
        let missing = self.interpolated[at].iter().filter(|is| **is).count();
        missing as f64 / self.interpolated[at].len().max(1) as f64
    }

    /// Subtracts from each frame the median displacement of the points that are far from the cell, and returns it, um; of
    /// points that were found, while there are enough. `far` says which these are, row by row from the lowest; without it, or
    /// if they are fewer than eight, they are those along the edges of the window.
    pub fn take_drift(&mut self, far: Option<&[bool]>) -> Vec<[f64; 2]> {
        let [columns, rows] = self.shape;
        let depth = [columns, rows].map(|count| ((RIM * count as f64).round() as usize).max(1));
        let at_edge = |point: usize| {
            let [column, row] = [point % columns, point / columns];
            column < depth[0]
                || row < depth[1]
                || column + depth[0] >= columns
                || row + depth[1] >= rows
        };
        let enough = |far: &&[bool]| far.iter().filter(|is| **is).count() >= FEWEST_FAR;
        let far: Vec<bool> = match far.filter(enough) {
            Some(far) => far.to_vec(),
            None => (0..columns * rows).map(at_edge).collect(),
        };
        let mut drift = Vec::new();
        for (moved, missing) in self.displacements_um.iter_mut().zip(&self.interpolated) {
            let all = || (0..columns * rows).filter(|&point| far[point]);
            let found: Vec<usize> = all().filter(|&point| !missing[point]).collect();
            let points = if found.len() >= FEWEST_FAR { found } else { all().collect() };
            let by = moved.each_ref().map(|axis| {
                let values: Vec<f64> = points.iter().map(|&point| axis[point]).collect();
                order::median(values).unwrap_or(0.0)
            });
            for (axis, by) in moved.iter_mut().zip(by) {
                for value in axis {
                    *value -= by;
                }
            }
            drift.push(by);
        }
        drift
    }
}

/// Follows the beads of a film from the frame at rest. `goes_on` is called after each frame; if it returns false, the
/// motion has the frames done so far.
///
/// # Errors
/// A frame that cannot be read, without beads, or too small; beads that are not found again.
pub fn follow_beads(
    film: &Film,
    rest: Rest,
    settings: BeadSettings,
    goes_on: impl FnMut(Progress) -> bool + Send,
) -> Result<GelMotion, BeadError> {
    let pixel_um = settings.pixel_size.um();
    let plane = film.frame(rest.frame).map_err(MotionError::from)?;
    let [width, height] = film.size();
    let Some(crowd) = Crowd::of(&plane, rest.noise) else {
        let Rest { frame, noise, contrast } = rest;
        return Err(BeadError::NoBeads { frame, contrast, noise });
    };
    let texture = Texture::Beads { distance_um: crowd.distance * pixel_um };
    let tracking = TrackingSettings {
        subset_um: settings.subset_um.unwrap_or(crowd.side * pixel_um),
        threads: settings.threads,
        texture,
        ..TrackingSettings::at(1.0)
    };
    let half = super::follower::half(tracking.subset_um, pixel_um, texture);
    let side = 2 * half + 1;
    let step = (side / GelMotion::OVERLAP).max(1);
    // Every square lies within the frame.
    let count = |length: usize| length.checked_sub(side).map_or(0, |room| room / step + 1);
    let shape = [count(width), count(height)];
    if shape.iter().any(|count| *count < FEWEST) {
        let frame_um = [width, height].map(|side| side as f64 * pixel_um);
        let subset_um = side as f64 * pixel_um;
        return Err(BeadError::TooSmall { frame_um, subset_um, points: shape });
    }
    let first = [(width, shape[0]), (height, shape[1])]
        .map(|(length, count)| half + (length - side - (count - 1) * step) / 2);
    let wrong_size = |_| MotionError::Mask { width, height };
    let frame = PixelFrame::new(width, height, settings.pixel_size).map_err(wrong_size)?;
    let spacing = step as f64 * pixel_um;
    let mesh = lattice::rectangle(shape[0] - 1, shape[1] - 1, spacing);
    let mut mesh = mesh.map_err(|_| MotionError::Mask { width, height })?;
    let lowest = first[1] + (shape[1] - 1) * step;
    let corner = frame.to_um([first[0], lowest].map(|pixel| pixel as f64 + 0.5));
    for (axis, corner) in mesh.points.iter_mut().zip(corner) {
        for place in axis {
            *place += corner;
        }
    }
    let everywhere = vec![true; width * height];
    let window = CellAtRest {
        mesh: &mesh,
        inside: &everywhere,
        any_cell: &everywhere,
        pixel_size: settings.pixel_size,
        fibres: None,
    };
    let motion = super::follow(film, rest, &window, tracking, goes_on)?;
    // The mean of all points counts as motion of the stage where there is no background.
    let displacements = motion.displacements_um.iter().zip(&motion.stage_um);
    let displacements = displacements.map(|(moved, stage)| {
        [0, 1].map(|axis: usize| moved[axis].iter().map(|value| value + stage[axis]).collect())
    });
    // Noise of a pixel, from the residual of matched squares: bright beads are noisier than the ground.
    let others = (0..motion.frames.len()).filter(|&at| motion.frames[at] != motion.rest);
    let matched =
        order::median(others.filter_map(|at| motion.correlation[at]).collect::<Vec<f64>>());
    let noise = matched.map(|matched| ((1.0 - matched).max(0.0) * crowd.variance).sqrt());
    let error_um = motion.error_um.map(|error| {
        let pixels = 2.0 * PI.sqrt() * SMOOTHING;
        noise.map_or(error, |noise| error * pixels * noise / rest.noise)
    });
    Ok(GelMotion {
        step,
        shape,
        first,
        pixel_um,
        repeated: motion.repeated.len(),
        interrupted: motion.interrupted,
        rest: motion.rest,
        displacements_um: displacements.collect(),
        correlation: motion.correlation,
        error_um,
        subset_um: motion.subset_um,
        bead_distance_um: crowd.distance * pixel_um,
        frames: motion.frames,
        interpolated: motion.interpolated,
    })
}

/// How close beads are.
struct Crowd {
    /// Mean distance of beads, pixels: a square of this side has one.
    distance: f64,
    /// Side of the smallest square with enough beads, pixels.
    side: f64,
    /// Variance of the smoothed grey values.
    variance: f64,
}

impl Crowd {
    /// `None` where the slopes are those of noise. If no square that fits often enough holds enough beads, the side is that of
    /// the largest one.
    fn of(plane: &Plane, noise: f64) -> Option<Self> {
        let (width, height) = (plane.width(), plane.height());
        let sums = Sums::of(plane, noise);
        let largest = width.min(height) as f64 / 4.0;
        let (mut side, mut last) = (SMALLEST, None);
        while side <= largest {
            let beads = sums.beads(side.round() as usize)?;
            last = Some(Self { distance: side / beads.sqrt(), side, variance: sums.variance });
            if beads >= BEADS {
                break;
            }
            side *= NEXT;
        }
        last.or_else(|| {
            let beads = sums.beads((largest.round() as usize).max(2))?;
            Some(Self { distance: largest / beads.sqrt(), side: SMALLEST, variance: sums.variance })
        })
    }
}

/// Sums of squared slopes over rectangles from the upper left corner.
struct Sums {
    width: usize,
    height: usize,
    /// One column and one row more than the picture.
    upto: Vec<f64>,
    /// Variance of the smoothed grey values.
    variance: f64,
}

impl Sums {
    /// Without what noise of this standard deviation adds.
    fn of(plane: &Plane, noise: f64) -> Self {
        let (width, height) = (plane.width(), plane.height());
        let smooth = filter::gaussian(plane, SMOOTHING);
        // Of a Gaussian of standard deviation s, white noise keeps the variance 1/(4 pi s^2), and values two pixels apart
        // the correlation exp(-1/s^2). A slope is half of the difference of two such values.
        let square = SMOOTHING * SMOOTHING;
        let kept = noise * noise / (4.0 * PI * square);
        let of_noise = 2.0 * kept * (1.0 - (-1.0 / square).exp()) / 2.0;
        let at = |column: usize, row: usize| f64::from(smooth.at(column, row));
        let mut upto = vec![0.0; (width + 1) * (height + 1)];
        for row in 0..height {
            let mut along = 0.0;
            for column in 0..width {
                let slope = |low: f64, high: f64| 0.5 * (high - low);
                let x =
                    slope(at(column.saturating_sub(1), row), at((column + 1).min(width - 1), row));
                let y =
                    slope(at(column, row.saturating_sub(1)), at(column, (row + 1).min(height - 1)));
                along += x * x + y * y - of_noise;
                upto[(row + 1) * (width + 1) + column + 1] =
                    upto[row * (width + 1) + column + 1] + along;
            }
        }
        let count = (width * height) as f64;
        let grey = || smooth.values().iter().map(|value| f64::from(*value));
        let mean = grey().sum::<f64>() / count;
        let variance = grey().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        Self { width, height, upto, variance }
    }

    /// Number of beads in a square of this side, from the variation over squares that overlap by half; `None` if there are
    /// no slopes.
    fn beads(&self, side: usize) -> Option<f64> {
        let at = |column: usize, row: usize| self.upto[row * (self.width + 1) + column];
        let step = (side / 2).max(1);
        let mut found = Vec::new();
        for row in (0..=self.height.checked_sub(side)?).step_by(step) {
            for column in (0..=self.width.checked_sub(side)?).step_by(step) {
                let (right, low) = (column + side, row + side);
                found.push(at(right, low) - at(column, low) - at(right, row) + at(column, row));
            }
        }
        let count = found.len() as f64;
        let mean = found.iter().sum::<f64>() / count;
        let variance = found.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / count;
        (mean > 0.0 && variance > 0.0).then(|| mean * mean / variance)
    }
}
