//! The shift of a whole picture, by cross-correlation over all shifts at once.

use crate::filter;
use crate::plane::Plane;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Longest side of the pictures that are compared, pixels.
const LONGEST: usize = 512;
/// Standard deviation of the Gaussian whose blur counts as uneven light, compared pixels.
const LIGHT: f64 = 8.0;
/// Least height of the correlation's peak, standard deviations of all other shifts: of pictures that have nothing in common,
/// the highest of some 10^5 is near 5.
const LEAST_PEAK: f32 = 8.0;

/// A picture at rest, with which others are compared.
pub(super) struct Registration {
    /// Pixels of the film along the side of one compared pixel.
    factor: usize,
    /// Columns and rows that are compared.
    size: [usize; 2],
    /// Transforms there and back, along rows and along columns.
    rows: [Arc<dyn Fft<f32>>; 2],
    columns: [Arc<dyn Fft<f32>>; 2],
    /// The transformed picture, column by column.
    rest: Vec<Complex<f32>>,
}

impl Registration {
    /// The picture at rest.
    pub(super) fn of(rest: &Plane) -> Self {
        let factor = rest.width().max(rest.height()).div_ceil(LONGEST);
        let size = [rest.width(), rest.height()].map(|side| side.div_ceil(factor));
        let mut planner = FftPlanner::new();
        let mut both =
            |length| [planner.plan_fft_forward(length), planner.plan_fft_inverse(length)];
        let (rows, columns) = (both(size[0]), both(size[1]));
        let mut made = Self { factor, size, rows, columns, rest: Vec::new() };
        made.rest = made.transformed(rest);
        made
    }

    /// How far a picture of the same size is shifted, pixels of the film, to whole compared pixels; `None` if they have
    /// nothing in common.
    pub(super) fn shift(&self, now: &Plane) -> Option<[f32; 2]> {
        let [width, height] = self.size;
        let mut product = self.transformed(now);
        for (now, rest) in product.iter_mut().zip(&self.rest) {
            *now *= rest.conj();
        }
        self.columns[1].process(&mut product);
        let mut correlation = turned(&product, height, width);
        self.rows[1].process(&mut correlation);
        let values = || correlation.iter().map(|value| value.re);
        let squares = values().map(|value| value * value).sum::<f32>();
        let deviation = (squares / (width * height) as f32).sqrt();
        let (at, peak) = values().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let signed = |at: usize, count: usize| {
            if 2 * at <= count { at as f32 } else { at as f32 - count as f32 }
        };
        let shift = [signed(at % width, width), signed(at / width, height)];
        (peak > LEAST_PEAK * deviation).then(|| shift.map(|along| along * self.factor as f32))
    }

    /// The transform of a picture without uneven light that fades out toward its edges, column by column.
    fn transformed(&self, plane: &Plane) -> Vec<Complex<f32>> {
        let [width, height] = self.size;
        let coarse = filter::coarse(plane, self.factor);
        let light = filter::slow_part(&coarse, LIGHT);
        let fade =
            |at: usize, count: usize| 0.5 - 0.5 * (TAU * (at as f32 + 0.5) / count as f32).cos();
        let values = coarse.values().iter().zip(light.values()).enumerate();
        let mut grid: Vec<Complex<f32>> = values
            .map(|(at, (value, light))| {
                let weight = fade(at % width, width) * fade(at / width, height);
                Complex::new(weight * (value - light), 0.0)
            })
            .collect();
        self.rows[0].process(&mut grid);
        let mut columns = turned(&grid, width, height);
        self.columns[0].process(&mut columns);
        columns
    }
}

/// A grid of rows of this width, column by column.
fn turned(grid: &[Complex<f32>], width: usize, height: usize) -> Vec<Complex<f32>> {
    let columns = (0..width).flat_map(|column| (0..height).map(move |row| row * width + column));
    columns.map(|at| grid[at]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spots at irregular places, moved.
    fn spots(by: [f32; 2], seed: u32) -> Plane {
        let mut state = seed;
        let mut even = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let places: Vec<[f32; 2]> =
            (0..300).map(|_| [180.0 * even() - 10.0, 140.0 * even() - 10.0]).collect();
        let values = (0..160 * 120).map(|at| {
            let (x, y) = ((at % 160) as f32, (at / 160) as f32);
            let light = |[a, b]: &[f32; 2]| {
                (-((x - a - by[0]).powi(2) + (y - b - by[1]).powi(2)) / 4.0).exp()
            };
            places.iter().map(light).sum()
        });
        Plane::new(160, 120, values.collect()).unwrap()
    }

    #[test]
    fn a_shift_is_found_and_pictures_of_other_spots_have_none() {
        let rest = Registration::of(&spots([0.0; 2], 1));
        for by in [[0.0, 0.0], [13.0, -7.0], [-30.0, 22.0]] {
            assert_eq!(rest.shift(&spots(by, 1)), Some(by));
        }
        assert_eq!(rest.shift(&spots([0.0; 2], 77)), None);
        let flat = Plane::new(160, 120, vec![3.0; 160 * 120]).unwrap();
        assert_eq!(rest.shift(&flat), None);
    }
}
