//! The part of a picture that holds the cell, with its local mean subtracted, at the needed
//! resolution.

use super::super::dilation::{Norm, eroded};
use super::super::plane::Plane;
use super::grid::{Grid, Lines};

/// How a cell is cut out of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// This number of pixels along rows and along columns is binned into one.
    pub(super) side: usize,
    /// Standard deviation of the Gaussian whose mean is subtracted, um.
    pub(super) background_um: f64,
    /// Width of the ignored rim along the outline, um.
    pub(super) rim_um: f64,
    /// Width of the rim's outer part that is not used for filtering either, um.
    pub(super) unseen_um: f64,
    /// Width of the empty frame around the cell, pixels of the window.
    pub(super) frame: usize,
}

/// Grey values minus their local mean within the cell, zero elsewhere, with an empty frame around
/// it.
pub(super) struct Window {
    /// Pixels along a row, and rows.
    pub(super) size: [usize; 2],
    /// Values minus their local mean, row by row from the top.
    pub(super) values: Vec<f32>,
    /// Whether a pixel lies in the cell.
    pub(super) inside: Vec<bool>,
    /// Whether a pixel lies in the cell outside its rim, so that it counts.
    pub(super) counted: Vec<bool>,
    /// Side of a pixel here, um.
    pub(super) pixel_um: f64,
    /// Upper left corner, um, y upward.
    pub(super) corner_um: [f64; 2],
    /// Width of the empty frame, pixels of the window.
    pub(super) frame: usize,
    /// Smallest difference of grey values that the picture can show.
    pub(super) grey_step: f64,
}

impl Window {
    /// Cuts out the cell; `None` where no pixel is the cell.
    pub(super) fn cut(
        plane: &Plane,
        inside: &[bool],
        pixel_size_um: f64,
        cut: &Cut,
    ) -> Option<Self> {
        let (width, height) = (plane.width(), plane.height());
        let [left, right, top, bottom] = bounds(inside, width)?;
        let (side, frame) = (cut.side, cut.frame);
        let pixel_um = pixel_size_um * side as f64;
        let size = [(right - left).div_ceil(side), (bottom - top).div_ceil(side)]
            .map(|length| length + 2 * frame);
        let mut window = Self {
            size,
            values: vec![0.0; size[0] * size[1]],
            inside: vec![false; size[0] * size[1]],
            counted: Vec::new(),
            pixel_um,
            corner_um: [
                pixel_size_um * left as f64 - pixel_um * frame as f64,
                pixel_size_um * (height as f64 - top as f64) + pixel_um * frame as f64,
            ],
            frame,
            grey_step: 0.0,
        };
        // Subtracting one of the cell's own values keeps sums small and precise.
        let mut cell = plane.values().iter().zip(inside);
        let level = cell.find(|(value, inside)| **inside && value.is_finite());
        let level = level.map_or(0.0, |(value, _)| *value);
        let columns = size[0] - 2 * frame;
        let (mut sums, mut counts) = (vec![0.0_f32; columns], vec![[0_u32; 2]; columns]);
        for row in 0..size[1] - 2 * frame {
            sums.fill(0.0);
            counts.fill([0; 2]);
            for y in (top + row * side)..(top + (row + 1) * side).min(height) {
                let line = y * width + left..y * width + right;
                let values = plane.values()[line.clone()].chunks(side);
                let pixels = values.zip(inside[line].chunks(side));
                for ((values, inside), (sum, count)) in pixels.zip(sums.iter_mut().zip(&mut counts))
                {
                    for (value, &inside) in values.iter().zip(inside) {
                        let known = inside && value.is_finite();
                        *sum += if known { value - level } else { 0.0 };
                        *count = [count[0] + u32::from(inside), count[1] + u32::from(known)];
                    }
                }
            }
            let start = (row + frame) * size[0] + frame;
            for (column, (sum, [of_cell, known])) in sums.iter().zip(&counts).enumerate() {
                // A binned pixel partly outside would contain the step at the outline.
                if *of_cell as usize == side * side {
                    // NaN if no value is known.
                    window.values[start + column] = sum / *known as f32;
                    window.inside[start + column] = true;
                }
            }
        }
        window.grey_step = grey_step(plane, inside);
        let seen = window.without_rim(cut.unseen_um / pixel_um);
        window.take_off_local_mean(cut.background_um, &seen);
        window.counted = window.without_rim(cut.rim_um / pixel_um);
        Some(window)
    }

    /// Subtracts the local mean over the visible pixels: normalised convolution with a Gaussian.
    /// Pixels that are not visible or have no value become zero.
    fn take_off_local_mean(&mut self, scale_um: f64, seen: &[bool]) {
        let columns = self.size[0];
        let sigma = scale_um / self.pixel_um;
        // Blocks of half the Gaussian's width are fine enough for linear interpolation.
        let grid = Grid::over(self.size, ((sigma / 2.0) as usize).max(1));
        let (mut sums, mut counts) = (grid.zeros(), grid.zeros());
        let (mut known, mut weights) = (vec![0.0; columns], vec![0.0; columns]);
        let rows = self.values.chunks_exact(columns).zip(seen.chunks_exact(columns));
        for (row, (values, seen)) in rows.enumerate() {
            let out = known.iter_mut().zip(&mut weights);
            for ((value, &seen), (known, weight)) in values.iter().zip(seen).zip(out) {
                let counts = seen && value.is_finite();
                *known = if counts { *value } else { 0.0 };
                *weight = if counts { 1.0 } else { 0.0 };
            }
            grid.add_row(&mut sums, row, &known);
            grid.add_row(&mut counts, row, &weights);
        }
        let sigma = sigma / grid.block as f64;
        grid.blur(&mut sums, sigma);
        grid.blur(&mut counts, sigma);
        for (sum, count) in sums.iter_mut().zip(&counts) {
            *sum = if *count > f32::MIN_POSITIVE { *sum / count } else { 0.0 };
        }
        let mut lines = Lines::new(&grid, columns);
        let rows = self.values.chunks_exact_mut(columns).zip(seen.chunks_exact(columns));
        for (row, (values, seen)) in rows.enumerate() {
            let means = lines.at(&grid, &sums, row);
            for ((value, &seen), mean) in values.iter_mut().zip(seen).zip(means) {
                *value = if seen && value.is_finite() { *value - mean } else { 0.0 };
            }
        }
    }

    /// The pixels of the cell more than `rim` pixels from its outline (along rows, columns or
    /// diagonals).
    fn without_rim(&self, rim: f64) -> Vec<bool> {
        eroded(&self.inside, self.size[0], rim.round() as usize, Norm::Chessboard)
    }
}

/// Bounding box of the cell: first column, column after the last, first row, row after the last.
fn bounds(inside: &[bool], width: usize) -> Option<[usize; 4]> {
    let mut bounds: Option<[usize; 4]> = None;
    for (row, line) in inside.chunks_exact(width).enumerate() {
        let Some(first) = line.iter().position(|&inside| inside) else { continue };
        let behind = line.iter().rposition(|&inside| inside).map_or(first, |last| last + 1);
        let [left, right, top, _] = bounds.unwrap_or([first, behind, row, row]);
        bounds = Some([left.min(first), right.max(behind), top, row + 1]);
    }
    bounds
}

/// The smallest difference between neighbours in a row of the cell, at least the resolution of
/// single precision.
fn grey_step(plane: &Plane, inside: &[bool]) -> f64 {
    let (mut step, mut largest) = (f32::INFINITY, 0.0_f32);
    let rows = plane.values().chunks_exact(plane.width());
    for (values, inside) in rows.zip(inside.chunks_exact(plane.width())) {
        for (two, _) in values.windows(2).zip(inside).filter(|(_, inside)| **inside) {
            let difference = (two[1] - two[0]).abs();
            if difference > 0.0 {
                step = step.min(difference);
            }
            if two[0].is_finite() {
                largest = largest.max(two[0].abs());
            }
        }
    }
    let step = if step.is_finite() { step } else { 0.0 };
    f64::from(step.max(4.0 * f32::EPSILON * largest))
}
