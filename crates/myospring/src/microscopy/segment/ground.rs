//! The slowly varying background of a picture.

use crate::microscopy::filter::{self, bulk, otsu, quantile, sample};
use crate::microscopy::plane::Plane;

/// Blocks along the longer side to which the background is fitted.
const BLOCKS: usize = 64;

/// Rounds of fitting: each lets the surface reach further from where it began.
const ROUNDS: usize = 12;

/// The background: a surface of second degree, and how much pixels scatter about it.
pub(super) struct Ground {
    surface: Plane,
    /// Standard deviation about the surface.
    pub(super) noise: f32,
}

impl Ground {
    /// Fitted to those blocks of the picture that no cell covers: first the dark ones, then those that lie
    /// near the surface.
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
        // Under a large cell the surface is a guess: it stays within what was seen of it.
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

/// The median of the used blocks everywhere.
fn constant(blocks: &Plane, used: &[bool]) -> Plane {
    let values: Vec<f32> =
        blocks.values().iter().zip(used).filter(|(_, used)| **used).map(|(v, _)| *v).collect();
    let flat = quantile(if values.is_empty() { blocks.values() } else { &values }, 0.5);
    blocks.map(|_| flat)
}

/// The surface `a + b x + c y + d x^2 + e x y + f y^2` of least squares through the used blocks; `None` where
/// they are few.
fn fitted(blocks: &Plane, used: &[bool]) -> Option<Plane> {
    const TERMS: usize = 6;
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
    let mut left = faer::Mat::<f64>::zeros(TERMS, TERMS);
    let mut right = faer::Mat::<f64>::zeros(TERMS, 1);
    for &at in &chosen {
        let terms = terms(at);
        for (i, a) in terms.iter().enumerate() {
            right[(i, 0)] += a * f64::from(blocks.values()[at]);
            for (j, b) in terms.iter().enumerate() {
                left[(i, j)] += a * b;
            }
        }
    }
    for term in 0..TERMS {
        // Keeps a direction that no block tells of at zero.
        left[(term, term)] += 1e-6 * chosen.len() as f64;
    }
    let factor = left.llt(faer::Side::Lower).ok()?;
    let weights = faer::linalg::solvers::Solve::solve(&factor, &right);
    let value = |at: usize| -> f64 {
        terms(at).iter().enumerate().map(|(i, term)| term * weights[(i, 0)]).sum()
    };
    Plane::new(width, height, (0..used.len()).map(|at| value(at) as f32).collect())
}
