//! Smoothing, coarsening and the slowly varying part of a plane.

use super::plane::Plane;
use myospring_core::analysis::order;

/// Smooths with a Gaussian of standard deviation `sigma` pixels, cut off at two standard
/// deviations; the values at the rim continue outward.
///
/// Below 0.3 pixels the plane is returned unchanged.
///
/// # Example
/// ```
/// use myospring::microscopy::{filter, plane::Plane};
/// let flat = Plane::new(9, 7, vec![4.0; 63]).unwrap();
/// let smooth = filter::gaussian(&flat, 2.0);
/// assert!(smooth.values().iter().all(|value| (value - 4.0).abs() < 1e-5));
/// ```
#[must_use]
pub fn gaussian(plane: &Plane, sigma: f64) -> Plane {
    if sigma < 0.3 {
        return plane.clone();
    }
    let (width, height) = (plane.width(), plane.height());
    let weights = gaussian_weights(sigma as f32);
    let reach = weights.len() / 2;
    let mut continued = vec![0.0; width + 2 * reach];
    // Ring buffer of smoothed rows, as many as one row of the result needs; row r is stored at r
    // modulo their number.
    let mut along = vec![0.0; width * weights.len()];
    let mut next = 0;
    let mut values = vec![0.0; width * height];
    for (row, sums) in values.chunks_exact_mut(width).enumerate() {
        while next < height && next <= row + reach {
            let from = &plane.values()[next * width..][..width];
            continued[..reach].fill(from[0]);
            continued[reach..][..width].copy_from_slice(from);
            continued[reach + width..].fill(from[width - 1]);
            let sums = &mut along[next % weights.len() * width..][..width];
            sums.fill(0.0);
            for (shift, &weight) in weights.iter().enumerate() {
                add(sums, weight, &continued[shift..]);
            }
            next += 1;
        }
        for (shift, &weight) in weights.iter().enumerate() {
            let from = (row + shift).saturating_sub(reach).min(height - 1);
            add(sums, weight, &along[from % weights.len() * width..]);
        }
    }
    Plane::new(width, height, values).unwrap_or_else(|| plane.clone())
}

/// As [`gaussian`], but along columns alone.
pub(super) fn gaussian_down(plane: &Plane, sigma: f64) -> Plane {
    if sigma < 0.3 {
        return plane.clone();
    }
    let (width, height) = (plane.width(), plane.height());
    let weights = gaussian_weights(sigma as f32);
    let reach = weights.len() / 2;
    let mut values = vec![0.0; width * height];
    for (row, sums) in values.chunks_exact_mut(width).enumerate() {
        for (shift, &weight) in weights.iter().enumerate() {
            let from = (row + shift).saturating_sub(reach).min(height - 1);
            add(sums, weight, &plane.values()[from * width..]);
        }
    }
    Plane::new(width, height, values).unwrap_or_else(|| plane.clone())
}

/// Reach to each side of a Gaussian of standard deviation `sigma` pixels, pixels.
pub(super) fn reach(sigma: f64) -> usize {
    (2.0 * sigma).ceil() as usize
}

/// Adds `weight` times each value to each sum.
fn add(sums: &mut [f32], weight: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value * weight;
    }
}

/// A Gaussian at whole pixels up to two standard deviations to both sides; the weights sum to 1.
fn gaussian_weights(sigma: f32) -> Vec<f32> {
    let reach = (2.0 * sigma).ceil() as i32;
    let height = (sigma * (2.0 * std::f32::consts::PI).sqrt()).recip();
    let mut weights: Vec<f32> = (-reach..=reach)
        .map(|at| height * (-(at as f32).powi(2) / (2.0 * sigma.powi(2))).exp())
        .collect();
    let sum: f32 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}

/// Means over blocks of `factor` x `factor` pixels; blocks at the right and lower rim may be smaller.
///
/// # Example
/// ```
/// use myospring::microscopy::{filter, plane::Plane};
/// let plane = Plane::new(3, 1, vec![1.0, 3.0, 7.0]).unwrap();
/// assert_eq!(filter::coarse(&plane, 2).values(), [2.0, 7.0]);
/// ```
#[must_use]
pub fn coarse(plane: &Plane, factor: usize) -> Plane {
    let factor = factor.max(1);
    if factor == 1 {
        return plane.clone();
    }
    let (width, height) = (plane.width().div_ceil(factor), plane.height().div_ceil(factor));
    let mut sums = vec![0.0_f32; width * height];
    for (row, values) in plane.values().chunks_exact(plane.width()).enumerate() {
        let sums = &mut sums[row / factor * width..][..width];
        for (sum, block) in sums.iter_mut().zip(values.chunks(factor)) {
            *sum += block.iter().sum::<f32>();
        }
    }
    let side = |at: usize, whole: usize| factor.min(whole - at * factor);
    for (at, sum) in sums.iter_mut().enumerate() {
        *sum /= (side(at % width, plane.width()) * side(at / width, plane.height())) as f32;
    }
    Plane::new(width, height, sums).unwrap_or_else(|| plane.clone())
}

/// The slowly varying brightness of a plane: a Gaussian of `sigma` pixels, computed on a coarse grid.
#[must_use]
pub fn slow_part(plane: &Plane, sigma: f64) -> Plane {
    // Blocks of a quarter of the Gaussian's width: linear interpolation is then accurate to 1 %.
    let factor = ((sigma / 4.0) as usize).max(1);
    let blocks = gaussian(&coarse(plane, factor), sigma / factor as f64);
    spread(&blocks, factor, plane.width(), plane.height())
}

/// Interpolates coarse values linearly between block centres onto a fine grid.
pub(super) fn spread(blocks: &Plane, factor: usize, width: usize, height: usize) -> Plane {
    let places = |count: usize, blocks: usize| -> Vec<(usize, usize, f32)> {
        let last = blocks - 1;
        let place = |at: usize| {
            let x = ((at as f32 + 0.5) / factor as f32 - 0.5).clamp(0.0, last as f32);
            (x as usize, (x as usize + 1).min(last), x.fract())
        };
        (0..count).map(place).collect()
    };
    let (columns, rows) = (places(width, blocks.width()), places(height, blocks.height()));
    let mut values = Vec::with_capacity(width * height);
    for &(low, high, part) in &rows {
        let row = |at: usize| &blocks.values()[at * blocks.width()..][..blocks.width()];
        let mixed: Vec<f32> =
            row(low).iter().zip(row(high)).map(|(a, b)| a + part * (b - a)).collect();
        values.extend(columns.iter().map(|&(a, b, part)| mixed[a] + part * (mixed[b] - mixed[a])));
    }
    Plane::new(width, height, values).unwrap_or_else(|| blocks.clone())
}

/// The largest value within a square of `reach` pixels to each side.
pub(super) fn largest_nearby(plane: &Plane, reach: usize) -> Plane {
    let (width, height) = (plane.width(), plane.height());
    let mut along = Vec::with_capacity(width * height);
    for row in plane.values().chunks_exact(width) {
        along.extend((0..width).map(|at| {
            let window = &row[at.saturating_sub(reach)..(at + reach + 1).min(width)];
            window.iter().copied().fold(f32::NEG_INFINITY, f32::max)
        }));
    }
    let mut values = vec![f32::NEG_INFINITY; width * height];
    for row in 0..height {
        let most = &mut values[row * width..][..width];
        for other in row.saturating_sub(reach)..(row + reach + 1).min(height) {
            for (most, &value) in most.iter_mut().zip(&along[other * width..][..width]) {
                *most = most.max(value);
            }
        }
    }
    Plane::new(width, height, values).unwrap_or_else(|| plane.clone())
}

/// The smallest value within a square of `reach` pixels to each side.
pub(super) fn smallest_nearby(plane: &Plane, reach: usize) -> Plane {
    largest_nearby(&plane.map(|value| -value), reach).map(|value| -value)
}

/// Grey-value closing: dark gaps of up to `2 reach` pixels become as bright as both sides.
pub(super) fn closed(plane: &Plane, reach: usize) -> Plane {
    smallest_nearby(&largest_nearby(plane, reach), reach)
}

/// Slopes along rows and down columns, per pixel, by central differences.
pub(super) fn slopes(plane: &Plane) -> [Vec<f32>; 2] {
    let (width, height) = (plane.width(), plane.height());
    let values = plane.values();
    let (mut along, mut down) = (vec![0.0; values.len()], vec![0.0; values.len()]);
    for row in 0..height {
        let (above, below) = (row.saturating_sub(1), (row + 1).min(height - 1));
        for column in 0..width {
            let (left, right) = (column.saturating_sub(1), (column + 1).min(width - 1));
            let at = row * width + column;
            along[at] = (values[row * width + right] - values[row * width + left]) / 2.0;
            down[at] = (values[below * width + column] - values[above * width + column]) / 2.0;
        }
    }
    [along, down]
}

/// The value below which lies the part `share` (0 to 1) of all values; 0 of no values.
///
/// # Example
/// ```
/// assert_eq!(myospring::microscopy::filter::quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
/// ```
#[must_use]
pub fn quantile(values: &[f32], share: f64) -> f32 {
    order::quantile(values.iter().copied(), share).unwrap_or(0.0)
}

/// At most about `most` values, at regular positions, for statistics of a large plane.
pub(super) fn sample(values: &[f32], most: usize) -> Vec<f32> {
    // An odd stride does not sample the same columns in every row of even width.
    let stride = (values.len() / most.max(1)).max(1) | 1;
    values.iter().copied().step_by(stride).collect()
}

/// Median and robust standard deviation, from the median absolute deviation.
pub(super) fn bulk(values: &[f32]) -> [f32; 2] {
    let middle = quantile(values, 0.5);
    let off: Vec<f32> = values.iter().map(|value| (value - middle).abs()).collect();
    // Of a normal distribution, half the values lie within 0.6745 standard deviations.
    [middle, quantile(&off, 0.5) / 0.6745]
}

/// Number of levels between the smallest and the largest value, of which one is the threshold.
const LEVELS: usize = 256;

/// The threshold that divides values into two classes with the largest variance between them (Otsu
/// 1979), and the part of the total variance that lies between the classes, 0 to 1.
pub(super) fn otsu(values: &[f32]) -> Option<[f32; 2]> {
    let mut low = f32::INFINITY;
    let mut high = f32::NEG_INFINITY;
    for &value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    if low.is_nan() || high <= low {
        return None;
    }
    let scale = (LEVELS - 1) as f32 / (high - low);
    let mut histogram = [0.0; LEVELS];
    for &value in values {
        histogram[((value - low) * scale).round() as usize] += 1.0;
    }
    let level = otsu_level(&histogram);
    let (mut sums, mut counts) = ([0.0_f64; 2], [0.0_f64; 2]);
    let mut squares = 0.0;
    for (at, number) in histogram.iter().enumerate() {
        let class = usize::from(at > level);
        sums[class] += at as f64 * number;
        counts[class] += number;
        squares += (at as f64).powi(2) * number;
    }
    let count = counts[0] + counts[1];
    let mean = (sums[0] + sums[1]) / count;
    let whole = squares / count - mean * mean;
    let between: f64 = (0..2)
        .filter(|&class| counts[class] > 0.0)
        .map(|class| counts[class] / count * (sums[class] / counts[class] - mean).powi(2))
        .sum();
    // Between this level and the next.
    Some([low + (level as f32 + 0.5) / scale, (between / whole.max(1e-12)) as f32])
}

/// The last level of the lower class at which the variance between the two classes is largest (Otsu
/// 1979, Eq. 14); the first of several.
fn otsu_level(histogram: &[f64; LEVELS]) -> usize {
    let sum = |levels: &[f64]| {
        levels.iter().enumerate().map(|(at, number)| at as f64 * number).sum::<f64>()
    };
    let (all, whole) = (histogram.iter().sum::<f64>(), sum(histogram));
    let (mut count, mut part) = (0.0, 0.0);
    let (mut best, mut largest) = (0, 0.0);
    for (level, number) in histogram.iter().enumerate() {
        count += number;
        part += level as f64 * number;
        let rest = all - count;
        if count == 0.0 || rest == 0.0 {
            continue;
        }
        let apart = part / count - (whole - part) / rest;
        let between = count * rest * apart.powi(2);
        if between > largest {
            (best, largest) = (level, between);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn smoothing_is_the_weighted_mean_over_all_pixels_around(
            width in 1_usize..12,
            values in proptest::collection::vec(-100.0_f32..100.0, 12..150),
            sigma in 0.3_f64..6.0,
        ) {
            let height = values.len() / width;
            let plane = Plane::new(width, height, values[..width * height].to_vec()).unwrap();
            let smooth = gaussian(&plane, sigma);
            let reach = (2.0 * sigma).ceil() as isize;
            for (at, found) in smooth.values().iter().enumerate() {
                let (mut sum, mut weights) = (0.0, 0.0);
                for down in -reach..=reach {
                    for right in -reach..=reach {
                        let place = |at: usize, off: isize, count: usize| {
                            (at.cast_signed() + off).clamp(0, count.cast_signed() - 1) as usize
                        };
                        let distance = (right as f64).hypot(down as f64);
                        let weight = (-0.5 * (distance / sigma).powi(2)).exp();
                        let pixel = [place(at % width, right, width), place(at / width, down, height)];
                        sum += weight * f64::from(plane.at(pixel[0], pixel[1]));
                        weights += weight;
                    }
                }
                // Sums of up to 25 numbers of single precision, twice.
                prop_assert!((f64::from(*found) - sum / weights).abs() < 1e-3, "{found} {}", sum / weights);
            }
        }

        #[test]
        fn otsu_s_level_leaves_the_least_variance_within_the_classes(
            values in proptest::collection::vec(0_usize..LEVELS, 2..200),
        ) {
            let mut histogram = [0.0; LEVELS];
            for &value in &values {
                histogram[value] += 1.0;
            }
            let variance = |class: &dyn Fn(usize) -> bool| {
                let class: Vec<f64> =
                    values.iter().filter(|&&value| class(value)).map(|&value| value as f64).collect();
                let mean = class.iter().sum::<f64>() / class.len().max(1) as f64;
                class.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
            };
            let within = |level: usize| {
                variance(&|value| value <= level) + variance(&|value| value > level)
            };
            let least = (0..LEVELS).map(within).fold(f64::INFINITY, f64::min);
            let found = within(otsu_level(&histogram));
            // Rounding of sums of squares of up to 255.
            prop_assert!(found <= least + 1e-6, "{found} {least}");
        }
    }

    #[test]
    fn otsu_s_threshold_of_two_values_lies_between_them_and_explains_all() {
        let [threshold, share] = otsu(&[3.0, 7.0, 7.0, 3.0, 3.0]).unwrap();
        assert!(threshold > 3.0 && threshold < 7.0, "{threshold}");
        assert!((share - 1.0).abs() < 1e-6, "{share}");
        assert_eq!(otsu(&[2.0; 5]), None);
    }
}
