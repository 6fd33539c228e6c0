//! The slowly varying background of a picture.

use crate::filter::{self, bulk, otsu, quantile, sample};
use crate::plane::Plane;
use nalgebra::{Matrix6, Vector6};

/// Number of blocks along the longer side, to which the background is fitted.
const BLOCKS: usize = 64;

/// Rounds of fitting; each lets the surface extend further from the dark blocks.
const ROUNDS: usize = 12;

/// Side of the blocks of which the darkest are used, um.
const BLOCK_UM: f64 = 4.0;

/// Part of the blocks that counts as the darkest.
const DARK: f64 = 0.05;

/// Ratio of the standard deviation of smoothed noise to that within blocks, as measured.
const WITHIN_BLOCKS: f32 = 1.5;

/// The background: a quadratic surface, and the scatter of pixels about it.
pub(super) struct Ground {
    surface: Plane,
    /// Standard deviation about the surface.
    pub(super) noise: f32,
}

impl Ground {
    /// Fits the background to the blocks without cells: first to the dark ones, then to those near
    /// the surface.
    pub(super) fn under(smooth: &Plane) -> Self {
        let factor = smooth.width().max(smooth.height()).div_ceil(BLOCKS);
        let blocks = filter::coarse(smooth, factor);
        let values = blocks.values();
        let [low, high] = blocks.range();
        let scaled: Vec<f32> = values
            .iter()
            .map(|value| (value - low) / (high - low).max(1e-30))
            .map(f32::sqrt)
            .collect();
        let cut = otsu(&scaled).map_or(f32::INFINITY, |[level, _]| level);
        let mut used: Vec<bool> = scaled.iter().map(|&value| value <= cut).collect();
        let mut surface = blocks.clone();
        for _ in 0..ROUNDS {
            surface = fitted(&blocks, &used).unwrap_or_else(|| constant(&blocks, &used));
            let off: Vec<f32> =
                values.iter().zip(surface.values()).map(|(value, fit)| value - fit).collect();
            let kept: Vec<f32> =
                off.iter().zip(&used).filter(|(_, used)| **used).map(|(off, _)| *off).collect();
            let [middle, scatter] = bulk(&kept);
            let scatter = scatter.max(1e-4 * (high - low));
            used =
                off.iter().map(|&off| (-5.0..2.5).contains(&((off - middle) / scatter))).collect();
        }
        // Under a large cell the surface is extrapolated, so it is limited to the range of the used
        // blocks.
        let seen: Vec<f32> = surface
            .values()
            .iter()
            .zip(&used)
            .filter(|(_, used)| **used)
            .map(|(v, _)| *v)
            .collect();
        if !seen.is_empty() {
            let [low, high] = [quantile(&seen, 0.0), quantile(&seen, 1.0)];
            surface = surface.map(|value| value.clamp(low, high));
        }
        let surface = filter::spread(&surface, factor, smooth.width(), smooth.height());
        let width = smooth.width();
        let scatter: Vec<f32> = smooth
            .values()
            .iter()
            .zip(surface.values())
            .enumerate()
            .filter(|(at, _)| used[at / width / factor * blocks.width() + at % width / factor])
            .map(|(_, (value, fit))| value - fit)
            .collect();
        let noise = bulk(&sample(&scatter, 200_000))[1];
        Self { surface, noise }
    }

    /// A constant background from the darkest places, for pictures that are mostly filled with
    /// cells, haze or stray light, where no surface can be fitted.
    pub(super) fn darkest(smooth: &Plane, pixel_um: f64) -> Self {
        let side = ((BLOCK_UM / pixel_um).ceil() as usize).max(4);
        let [means, squares] = [smooth.clone(), smooth.map(|value| value * value)]
            .map(|plane| filter::coarse(&plane, side));
        let dark = quantile(means.values(), DARK);
        let scatter: Vec<f32> = means
            .values()
            .iter()
            .zip(squares.values())
            .filter(|(mean, _)| **mean <= dark)
            .map(|(mean, square)| (square - mean * mean).max(0.0).sqrt())
            .collect();
        // Blocks are not much larger than the correlation length of smoothed noise, so their means
        // differ, too.
        let noise = WITHIN_BLOCKS * quantile(&scatter, 0.5);
        Self { surface: smooth.map(|_| dark), noise }
    }

    /// The plane above the background.
    pub(super) fn taken_off(&self, smooth: &Plane) -> Plane {
        let values = smooth.values().iter().zip(self.surface.values());
        let values = values.map(|(value, ground)| value - ground).collect();
        Plane::new(smooth.width(), smooth.height(), values).unwrap_or_else(|| smooth.clone())
    }

    /// A value of the background.
    pub(super) fn middle(&self) -> f32 {
        quantile(&sample(self.surface.values(), 100_000), 0.5)
    }
}

/// A constant surface: the median of the used blocks.
fn constant(blocks: &Plane, used: &[bool]) -> Plane {
    let values: Vec<f32> =
        blocks.values().iter().zip(used).filter(|(_, used)| **used).map(|(v, _)| *v).collect();
    let flat = quantile(if values.is_empty() { blocks.values() } else { &values }, 0.5);
    blocks.map(|_| flat)
}

/// Terms of a quadratic surface.
const TERMS: usize = 6;

/// The least-squares surface `a + b x + c y + d x^2 + e x y + f y^2` through the used blocks;
/// `None` if they are too few.
fn fitted(blocks: &Plane, used: &[bool]) -> Option<Plane> {
    let (width, height) = (blocks.width(), blocks.height());
    let terms = |at: usize| {
        let side = |at: usize, count: usize| 2.0 * (at as f64 + 0.5) / count as f64 - 1.0;
        let (x, y) = (side(at % width, width), side(at / width, height));
        [1.0, x, y, x * x, x * y, y * y]
    };
    let chosen: Vec<usize> = (0..used.len()).filter(|&at| used[at]).collect();
    if chosen.len() * 8 < used.len() || chosen.len() < 4 * TERMS {
        return None;
    }
    let (mut left, mut right) = (Matrix6::zeros(), Vector6::zeros());
    for &at in &chosen {
        let terms = Vector6::from(terms(at));
        right += f64::from(blocks.values()[at]) * terms;
        left += terms * terms.transpose();
    }
    // Keeps a direction that no block tells of at zero.
    left += Matrix6::from_diagonal_element(1e-6 * chosen.len() as f64);
    let weights = left.cholesky()?.solve(&right);
    let value = |at: usize| -> f64 { Vector6::from(terms(at)).dot(&weights) };
    Plane::new(width, height, (0..used.len()).map(|at| value(at) as f32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_of_second_degree_is_found_from_half_of_its_blocks() {
        let (width, height) = (40, 30);
        let surface = |at: usize| {
            let (x, y) = ((at % width) as f32 / 20.0, (at / width) as f32 / 20.0);
            7.0 + 2.0 * x - 3.0 * y + 0.5 * x * x - 1.5 * x * y + 0.8 * y * y
        };
        let used: Vec<bool> = (0..width * height).map(|at| at % 7 < 3 || at % 5 == 0).collect();
        let values = (0..width * height).map(|at| if used[at] { surface(at) } else { 1e3 });
        let blocks = Plane::new(width, height, values.collect()).unwrap();
        let fit = fitted(&blocks, &used).unwrap();
        for (at, value) in fit.values().iter().enumerate() {
            // What holds back directions that no block tells of: a millionth, against weights of a tenth.
            assert!((value - surface(at)).abs() < 1e-3, "{value} at {at}");
        }
    }
}
