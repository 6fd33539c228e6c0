//! Texture inside an outline, on the scale of sarcomeres and organelles, beyond that of noise.
//!
//! Only pixels inside the outline are used: pixels outside are left out of every mean, since the
//! step at the outline would count as texture as far in as smoothing reaches.

use super::evidence::TEXTURE_UM;
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::Region;

/// Depths inside the outline from which texture is measured, um; the first that leaves enough area
/// is used. The blurred step of the outline lies above it.
const BELOW_UM: [f64; 4] = [3.0, 2.0, 1.5, 1.0];
/// Least area at that depth, um^2.
const ENOUGH_UM2: f64 = 60.0;
/// Scale over which texture is averaged before its median is taken, um: more than a period.
const ENERGY_UM: f64 = 2.5;
/// On coarser pixels, texture cannot be distinguished from noise, um: half of a short sarcomere.
const COARSEST_UM: f64 = 0.75;
/// Half-width of the interval of texture, in standard deviations of its measurement.
const SURE: f64 = 3.0;
/// Relative uncertainty of the texture of noise, because camera noise is not quite white.
const WHITE: f64 = 0.1;

/// Strength of texture, in grey values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grain {
    /// Lower bound.
    pub(super) least: f64,
    /// Upper bound, including the texture that noise may hide.
    pub(super) most: f64,
}

impl Grain {
    /// Measures the texture of a region; `ground` is the standard deviation of the noise outside
    /// it, per pixel. `None` if the region is too small to have an inside.
    pub(super) fn within(plane: &Plane, own: &Region, pixel_um: f64, ground: f32) -> Option<Self> {
        let enough = |core: &Region| core.count() as f64 * pixel_um * pixel_um >= ENOUGH_UM2;
        let core = BELOW_UM.iter().map(|um| own.shrunk(um / pixel_um)).find(enough)?;
        let window = core.window(1, 1);
        let core = core.cut(&window);
        let (width, height) = (window.width(), window.height());
        let part = |of: &dyn Fn(usize) -> f32| {
            Plane::new(width, height, (0..width * height).map(of).collect())
        };
        let values = window.cut(plane.values(), plane.width());
        let picture = Plane::new(width, height, values.clone())?;
        let inside = part(&|at| f32::from(u8::from(core.contains(at))))?;
        // Means over the inside only; relative to its mean, so that rounding errors stay small.
        let mean = |plane: &Plane, sigma: f64| {
            let [sums, weights] =
                [plane, &inside].map(|plane| filter::gaussian(plane, sigma / pixel_um));
            let means = sums
                .values()
                .iter()
                .zip(weights.values())
                .map(|(sum, weight)| sum / weight.max(1e-6));
            Plane::new(width, height, means.collect())
        };
        let middle = quantile(&values, 0.5);
        let within = part(&|at| if core.contains(at) { values[at] - middle } else { 0.0 })?;
        let [fine, rough] = TEXTURE_UM.map(|um| mean(&within, um));
        let (fine, rough) = (fine?, rough?);
        let squares = |at: usize| (fine.values()[at] - rough.values()[at]).powi(2);
        let energy = part(&|at| if core.contains(at) { squares(at) } else { 0.0 })?;
        let energy = mean(&energy, ENERGY_UM)?;
        let energy: Vec<f32> = (0..width * height)
            .filter(|&at| core.contains(at))
            .map(|at| energy.values()[at])
            .collect();
        let measured = f64::from(quantile(&energy, 0.5));
        let area = core.count() as f64 * pixel_um * pixel_um;
        let inner = core.shrunk(1.0);
        let local = || noise_at(&picture, (0..width * height).filter(|&at| inner.contains(at)));
        let noise = if pixel_um > COARSEST_UM { ground } else { ground.max(local()) };
        let expected = f64::from(noise * texture_of_noise(pixel_um)).powi(2);
        // Squares of a field smoothed by a Gaussian are nearly independent beyond this area.
        let scale = TEXTURE_UM[0].max(0.5 * pixel_um);
        let independent = (area / (2.0 * std::f64::consts::PI * scale * scale)).max(1.0);
        let off = SURE * expected * (2.0 / independent).sqrt() + WHITE * expected;
        let over = measured - expected;
        Some(Self { least: (over - off).max(0.0).sqrt(), most: (over + off).max(0.0).sqrt() })
    }
}

/// Standard deviation of white noise: the mixed second difference cancels stripes, and its median
/// ignores edges (Immerkaer 1996).
pub(super) fn noise_of(plane: &Plane) -> f32 {
    let pixels = plane.width() * plane.height();
    let stride = (pixels / 200_000).max(1) | 1;
    noise_at(plane, (0..pixels).step_by(stride))
}

fn noise_at(plane: &Plane, places: impl Iterator<Item = usize>) -> f32 {
    let (width, height) = (plane.width(), plane.height());
    let difference = |at: usize| {
        let (column, row) = (at % width, at / width);
        if column == 0 || row == 0 || column + 1 >= width || row + 1 >= height {
            return None;
        }
        let value = |x: usize, y: usize| plane.at(column + x - 1, row + y - 1);
        let corners = value(0, 0) + value(2, 0) + value(0, 2) + value(2, 2);
        let sides = value(1, 0) + value(0, 1) + value(2, 1) + value(1, 2);
        Some((corners - 2.0 * sides + 4.0 * value(1, 1)).abs())
    };
    let differences: Vec<f32> = places.filter_map(difference).collect();
    // Half of a normal distribution lies within 0.6745 standard deviations; the weights' squares
    // sum to 36.
    if differences.is_empty() { 0.0 } else { quantile(&differences, 0.5) / (0.6745 * 6.0) }
}

/// Texture of white noise of standard deviation 1, from the response to a single pixel.
pub(super) fn texture_of_noise(pixel_um: f64) -> f32 {
    let reach = (3.0 * TEXTURE_UM[1] / pixel_um).ceil() as usize;
    let side = 2 * reach + 1;
    let pixel = (0..side * side).map(|at| f32::from(u8::from(at == side * reach + reach)));
    let Some(pixel) = Plane::new(side, side, pixel.collect()) else { return 0.0 };
    let [fine, rough] = TEXTURE_UM.map(|um| filter::gaussian(&pixel, um / pixel_um));
    let squares = fine.values().iter().zip(rough.values()).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f32>().sqrt()
}
