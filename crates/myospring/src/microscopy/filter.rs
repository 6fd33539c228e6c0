//! Smoothing, coarsening and the slowly varying part of a plane.

use image::{ImageBuffer, Luma};

use super::plane::Plane;

/// Smooths with a Gaussian of standard deviation `sigma` pixels; the rim is continued outward.
///
/// Below 0.3 pixels a Gaussian is narrower than a pixel, and the plane comes back as it is.
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
    let (width, height) = (plane.width() as u32, plane.height() as u32);
    let blurred = ImageBuffer::<Luma<f32>, _>::from_raw(width, height, plane.values().to_vec())
        .map(|image| imageproc::filter::gaussian_blur_f32(&image, sigma as f32).into_raw())
        .and_then(|values| Plane::new(plane.width(), plane.height(), values));
    blurred.unwrap_or_else(|| plane.clone())
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
    // A block a quarter of the width of the Gaussian: linear interpolation between them is then within
    // a per cent of the curve.
    let factor = ((sigma / 4.0) as usize).max(1);
    let blocks = gaussian(&coarse(plane, factor), sigma / factor as f64);
    spread(&blocks, factor, plane.width(), plane.height())
}

/// Coarse values brought back to a fine grid by linear interpolation between block centres.
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

/// The value below which lies the part `share` (0 to 1) of all values.
///
/// # Example
/// ```
/// assert_eq!(myospring::microscopy::filter::quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
/// ```
#[must_use]
pub fn quantile(values: &[f32], share: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let mut values = values.to_vec();
    let at = ((values.len() - 1) as f64 * share.clamp(0.0, 1.0)).round() as usize;
    *values.select_nth_unstable_by(at, f32::total_cmp).1
}

/// Values at regular places, at most about `most` of them, for statistics of a large plane.
pub(super) fn sample(values: &[f32], most: usize) -> Vec<f32> {
    // A stride that is odd does not fall into step with rows of even width.
    let stride = (values.len() / most.max(1)).max(1) | 1;
    values.iter().copied().step_by(stride).collect()
}

/// Median and standard deviation of the bulk of values, by the median of absolute deviations.
pub(super) fn bulk(values: &[f32]) -> [f32; 2] {
    let middle = quantile(values, 0.5);
    let off: Vec<f32> = values.iter().map(|value| (value - middle).abs()).collect();
    // Of a normal distribution, half the values lie within 0.6745 standard deviations.
    [middle, quantile(&off, 0.5) / 0.6745]
}

/// The threshold that parts values into two classes with the largest variance between them
/// (Otsu 1979), and the share of the whole variance that lies between the classes, 0 to 1.
pub(super) fn otsu(values: &[f32]) -> Option<[f32; 2]> {
    let mut low = f32::INFINITY;
    let mut high = f32::NEG_INFINITY;
    for &value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    if low.is_nan() || high <= low {
        return None;
    }
    let scale = 255.0 / (high - low);
    let levels: Vec<u8> =
        values.iter().map(|&value| ((value - low) * scale).round() as u8).collect();
    let image = image::GrayImage::from_raw(levels.len() as u32, 1, levels)?;
    let level = imageproc::contrast::otsu_level(&image);
    let (mut sums, mut counts) = ([0.0_f64; 2], [0.0_f64; 2]);
    let mut squares = 0.0;
    for &pixel in image.as_raw() {
        let class = usize::from(pixel > level);
        sums[class] += f64::from(pixel);
        counts[class] += 1.0;
        squares += f64::from(pixel).powi(2);
    }
    let count = counts[0] + counts[1];
    let mean = (sums[0] + sums[1]) / count;
    let whole = squares / count - mean * mean;
    let between: f64 = (0..2)
        .filter(|&class| counts[class] > 0.0)
        .map(|class| counts[class] / count * (sums[class] / counts[class] - mean).powi(2))
        .sum();
    // Between this level and the next.
    Some([low + (f32::from(level) + 0.5) / scale, (between / whole.max(1e-12)) as f32])
}
