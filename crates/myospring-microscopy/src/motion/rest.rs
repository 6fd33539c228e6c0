//! The frame at rest, and the noise of a film.

use crate::film::{Film, FilmError};
use crate::filter;
use crate::picture::Samples;
use crate::plane::Plane;
use myospring_core::analysis::order;
use rayon::prelude::*;

/// Largest number of frames that are compared with each other, and of values of each.
const MOST_FRAMES: usize = 300;
const MOST_VALUES: usize = 10_000;
/// Least part of a film during which a cell rests.
const RESTING: f64 = 0.25;
/// Number of frames before and after the frame at rest from which the noise is measured.
const BESIDE: usize = 3;
/// A frame whose difference from the frame at rest is below this part of the usual one is a repeat.
const REPEATED: f64 = 0.25;
/// Standard deviation of the error of rounding to whole numbers.
const ROUNDING: f64 = 0.288_675;
/// Standard deviation of a normal distribution over its median absolute value.
const FROM_MEDIAN: f64 = 1.4826;

/// The frame at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Its number in the film, from 0.
    pub frame: usize,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// Standard deviation of the grey values of the frame.
    pub contrast: f64,
}

impl Rest {
    /// Finds the frame that is most similar to a quarter of the film: a cell rests for long and
    /// returns to rest, while no other phase of a beat repeats as exactly. The result does not
    /// depend on brightness and contrast of the whole frame, so a stain may bleach.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn find(film: &Film) -> Result<Self, FilmError> {
        let every = film.len().div_ceil(MOST_FRAMES);
        let frames: Vec<usize> = (0..film.len()).step_by(every).collect();
        let small: Vec<Vec<f32>> = frames
            .par_iter()
            .map(|&frame| Ok(normalised(&film.frame(frame)?)))
            .collect::<Result<_, FilmError>>()?;
        let count = ((frames.len() as f64 * RESTING).ceil() as usize).max(1);
        let strangeness = |one: &Vec<f32>| {
            let mut unlike: Vec<f32> = small.iter().map(|other| unlike(one, other)).collect();
            // The smallest difference is that of the frame to itself.
            let last = count.min(unlike.len() - 1);
            unlike.select_nth_unstable_by(last, f32::total_cmp);
            unlike[..=last].iter().sum::<f32>()
        };
        let strangeness: Vec<f32> = small.par_iter().map(strangeness).collect();
        let least = (0..frames.len()).min_by(|&a, &b| strangeness[a].total_cmp(&strangeness[b]));
        Self::at(film, frames[least.unwrap_or(0)])
    }

    /// Uses a given frame as the one at rest.
    ///
    /// # Errors
    /// A frame that does not exist or cannot be read.
    pub fn at(film: &Film, frame: usize) -> Result<Self, FilmError> {
        let rest = film.frame(frame)?;
        let beside = frame.saturating_sub(BESIDE)..(frame + BESIDE + 1).min(film.len());
        let mut found = Vec::new();
        for other in beside.filter(|&other| other != frame) {
            let other = film.frame(other)?;
            let pairs = rest.values().iter().zip(other.values());
            let sum: f64 = pairs.map(|(a, b)| f64::from((a - b).abs())).sum();
            // For a normal distribution, the mean absolute difference of two values is 2 / sqrt(pi)
            // standard deviations.
            found.push(sum / rest.values().len() as f64 * std::f64::consts::PI.sqrt() / 2.0);
        }
        found.sort_by(f64::total_cmp);
        // A repeat has no noise of its own, or almost none in a compressed film.
        let repeated = REPEATED * found.get(found.len() / 2).copied().unwrap_or(0.0);
        let noise = found.into_iter().find(|noise| *noise > repeated).unwrap_or(f64::INFINITY);
        let least = least_noise(film, &rest);
        let noise = if noise.is_finite() { noise.max(least) } else { least };
        Ok(Self { frame, noise, contrast: deviation(rest.values()) })
    }

    /// Uses a frame that belongs to no film, such as a picture of the relaxed gel: its noise is that of the differences of
    /// neighbouring pixels.
    ///
    /// # Errors
    /// A frame that does not exist or cannot be read.
    pub fn alone(film: &Film, frame: usize) -> Result<Self, FilmError> {
        let rest = film.frame(frame)?;
        let noise = noise_of(&rest).max(least_noise(film, &rest));
        Ok(Self { frame, noise, contrast: deviation(rest.values()) })
    }
}

/// Noise that a film has at least, grey levels.
fn least_noise(film: &Film, plane: &Plane) -> f64 {
    let [low, high] = plane.range();
    match film.samples {
        Samples::Integer { .. } => ROUNDING,
        Samples::Float { .. } => 1e-4 * f64::from(high - low),
    }
}

/// Standard deviation of the noise of one picture, from its second differences along both axes at once, which slopes and
/// curvature of one axis leave at 0 (`immerkaer_1996`); their median, since the picture has edges in some places only.
fn noise_of(plane: &Plane) -> f64 {
    let (width, height) = (plane.width(), plane.height());
    let rows = 1..height.saturating_sub(1);
    let inner = rows.flat_map(|row| (1..width.saturating_sub(1)).map(move |column| (column, row)));
    let mixed = |(column, row): (usize, usize)| {
        let along = |row: usize| {
            plane.at(column - 1, row) - 2.0 * plane.at(column, row) + plane.at(column + 1, row)
        };
        (along(row - 1) - 2.0 * along(row) + along(row + 1)).abs()
    };
    let sizes: Vec<f32> = inner.map(mixed).collect();
    // The sum of the squares of the kernel is 36.
    order::median(sizes).map_or(0.0, |median| FROM_MEDIAN * f64::from(median) / 6.0)
}

fn deviation(values: &[f32]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
    (values.iter().map(|&value| (f64::from(value) - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Values of a frame at regular positions, scaled to mean 0 and norm 1.
fn normalised(plane: &Plane) -> Vec<f32> {
    // Means of 2 x 2 pixels halve the noise and keep stripes.
    let plane = filter::coarse(plane, 2);
    let step = (plane.values().len() as f64 / MOST_VALUES as f64).sqrt().ceil().max(1.0) as usize;
    let rows = plane.values().chunks_exact(plane.width()).step_by(step);
    let mut values: Vec<f32> = rows.flat_map(|row| row.iter().step_by(step)).copied().collect();
    let mean = values.iter().sum::<f32>() / values.len() as f32;
    for value in &mut values {
        *value -= mean;
    }
    let norm = values.iter().map(|value| value * value).sum::<f32>().sqrt();
    if norm > 0.0 {
        for value in &mut values {
            *value /= norm;
        }
    }
    values
}

fn unlike(one: &[f32], other: &[f32]) -> f32 {
    let (a, b) = (one.as_chunks::<8>(), other.as_chunks::<8>());
    let mut sums = [0.0_f32; 8];
    for (a, b) in a.0.iter().zip(b.0) {
        for at in 0..8 {
            sums[at] += (a[at] - b[at]).powi(2);
        }
    }
    sums.iter().sum()
}
