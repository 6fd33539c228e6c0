//! Interpolation between pixels: the cubic B-spline through all pixels of a plane (`unser_1993`).
#![allow(clippy::inline_always, reason = "code dispatched to wider vectors must be inlined")]

use crate::plane::Plane;

/// Pole of the filter that turns values into coefficients of cubic B-splines.
const POLE: f32 = -0.267_949_2;
/// Number of terms of the mirrored sum that starts the filter: `POLE^12` is 1e-7.
const START: usize = 12;
/// Number of mirrored coefficients beyond the rim.
const PAD: usize = 2;

/// Coefficients of cubic B-splines, one for each pixel and two beyond each rim.
#[derive(Debug, Clone)]
pub(crate) struct Spline {
    width: usize,
    height: usize,
    stride: usize,
    coefficients: Vec<f32>,
}

impl Spline {
    /// The spline through the pixels of a plane, minus its mean.
    pub(crate) fn of(plane: &Plane) -> Self {
        let (width, height) = (plane.width(), plane.height());
        let values = plane.values();
        let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64;
        let stride = width + 2 * PAD;
        let mut coefficients = vec![0.0; stride * (height + 2 * PAD)];
        for (row, line) in values.chunks_exact(width).enumerate() {
            let start = (row + PAD) * stride + PAD;
            let into = &mut coefficients[start..start + width];
            for (into, value) in into.iter_mut().zip(line) {
                *into = value - mean as f32;
            }
            filter_line(into);
        }
        filter_columns(&mut coefficients[PAD * stride..(PAD + height) * stride], stride, height);
        let mut spline = Self { width, height, stride, coefficients };
        spline.pad();
        spline
    }

    /// Mirrors the coefficients beyond the rim.
    fn pad(&mut self) {
        let Self { width, height, stride, coefficients } = self;
        let mirrored = |at: usize, count: usize| at.min(count.saturating_sub(1));
        for row in PAD..PAD + *height {
            let line = &mut coefficients[row * *stride..(row + 1) * *stride];
            for out in 1..=PAD {
                line[PAD - out] = line[PAD + mirrored(out, *width)];
                line[PAD + *width - 1 + out] = line[PAD + *width - 1 - mirrored(out, *width)];
            }
        }
        for out in 1..=PAD {
            let inward = mirrored(out, *height);
            let (above, below) = (PAD + inward, PAD + *height - 1 - inward);
            coefficients.copy_within(above * *stride..(above + 1) * *stride, (PAD - out) * *stride);
            let to = (PAD + *height - 1 + out) * *stride;
            coefficients.copy_within(below * *stride..(below + 1) * *stride, to);
        }
    }

    pub(crate) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The values at eight positions, in pixels from the centre of the first pixel; NaN outside the
    /// centres of the outermost pixels.
    #[inline(always)]
    pub(crate) fn at_eight(&self, xs: &[f32; 8], ys: &[f32; 8]) -> [f32; 8] {
        let [right, bottom] = [self.width, self.height].map(|count| (count - 1) as f32);
        // Index of the first of the sixteen coefficients of each position, and the fractional
        // distance past the second.
        let mut first = [0_usize; 8];
        let (mut across, mut down) = ([0.0; 8], [0.0; 8]);
        for k in 0..8 {
            let [x, y] = [xs[k].clamp(0.0, right), ys[k].clamp(0.0, bottom)];
            let [column, row] = [x, y].map(|place| place as u32);
            across[k] = x - column as f32;
            down[k] = y - row as f32;
            first[k] = (row as usize + PAD - 1) * self.stride + column as usize + PAD - 1;
        }
        let (across, down) = (weights_of_eight(&across), weights_of_eight(&down));
        let mut values = [0.0; 8];
        for k in 0..8 {
            let rows = &self.coefficients[first[k]..first[k] + 3 * self.stride + 4];
            let mut along = [0.0_f32; 4];
            for (line, weights) in down.iter().enumerate() {
                let four = &rows[line * self.stride..line * self.stride + 4];
                for at in 0..4 {
                    along[at] += weights[k] * four[at];
                }
            }
            values[k] = (across[0][k] * along[0] + across[1][k] * along[1])
                + (across[2][k] * along[2] + across[3][k] * along[3]);
        }
        for k in 0..8 {
            // Also false for NaN.
            let inside = xs[k] >= 0.0 && ys[k] >= 0.0 && xs[k] <= right && ys[k] <= bottom;
            values[k] = if inside { values[k] } else { f32::NAN };
        }
        values
    }

    /// The value at a position; `None` outside the centres of the outermost pixels.
    #[cfg(test)]
    fn at(&self, x: f32, y: f32) -> Option<f32> {
        let [value, ..] = self.at_eight(&[x; 8], &[y; 8]);
        (!value.is_nan()).then_some(value)
    }

    /// Value and slopes at the centre of a pixel.
    pub(crate) fn at_pixel(&self, column: usize, row: usize) -> [f32; 3] {
        let level = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
        let slope = [-0.5, 0.0, 0.5];
        let first = (row + PAD - 1) * self.stride + column + PAD - 1;
        let mut found = [0.0; 3];
        for line in 0..3 {
            let from = first + line * self.stride;
            let three = &self.coefficients[from..from + 3];
            let along = |weights: [f32; 3]| {
                weights.iter().zip(three).map(|(weight, value)| weight * value).sum::<f32>()
            };
            found[0] += level[line] * along(level);
            found[1] += level[line] * along(slope);
            found[2] += slope[line] * along(level);
        }
        found
    }
}

/// Weights of four neighbouring coefficients at eight fractional distances past the second:
/// `[coefficient][place]`.
#[inline(always)]
fn weights_of_eight(distances: &[f32; 8]) -> [[f32; 8]; 4] {
    let mut weights = [[0.0; 8]; 4];
    for (k, &t) in distances.iter().enumerate() {
        let s = 1.0 - t;
        let (tt, ss) = (t * t, s * s);
        weights[0][k] = ss * s / 6.0;
        weights[1][k] = 2.0 / 3.0 - tt * (1.0 - 0.5 * t);
        weights[2][k] = 2.0 / 3.0 - ss * (1.0 - 0.5 * s);
        weights[3][k] = tt * t / 6.0;
    }
    weights
}

/// The powers of the pole with which the filter starts.
fn powers() -> impl Iterator<Item = f32> {
    std::iter::successors(Some(1.0), |power| Some(power * POLE)).take(START)
}

/// Turns the values of a line into coefficients: forward and backward over the line, mirrored at
/// its ends.
fn filter_line(line: &mut [f32]) {
    let count = line.len();
    if count < 2 {
        return;
    }
    for value in line.iter_mut() {
        *value *= 6.0;
    }
    line[0] += powers().zip(line.iter()).skip(1).map(|(power, value)| power * value).sum::<f32>();
    for k in 1..count {
        line[k] += POLE * line[k - 1];
    }
    line[count - 1] = POLE / (POLE * POLE - 1.0) * (line[count - 1] + POLE * line[count - 2]);
    for k in (0..count - 1).rev() {
        line[k] = POLE * (line[k + 1] - line[k]);
    }
}

/// The same down all columns at once.
fn filter_columns(rows: &mut [f32], stride: usize, height: usize) {
    if height < 2 {
        return;
    }
    for value in rows.iter_mut() {
        *value *= 6.0;
    }
    for (k, weight) in powers().enumerate().take(height).skip(1) {
        let (first, others) = rows.split_at_mut(stride);
        let from = &others[(k - 1) * stride..k * stride];
        first.iter_mut().zip(from).for_each(|(into, value)| *into += weight * value);
    }
    for k in 1..height {
        let (before, from) = rows.split_at_mut(k * stride);
        let above = &before[(k - 1) * stride..];
        from[..stride].iter_mut().zip(above).for_each(|(into, value)| *into += POLE * value);
    }
    let (before, last) = rows.split_at_mut((height - 1) * stride);
    let above = &before[(height - 2) * stride..];
    let scale = POLE / (POLE * POLE - 1.0);
    last.iter_mut().zip(above).for_each(|(into, value)| *into = scale * (*into + POLE * value));
    for k in (0..height - 1).rev() {
        let (before, below) = rows.split_at_mut((k + 1) * stride);
        let into = &mut before[k * stride..];
        into.iter_mut().zip(&below[..stride]).for_each(|(own, next)| *own = POLE * (next - *own));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(x: f64, y: f64) -> f32 {
        (100.0 + 20.0 * (0.7 * x).sin() * (0.5 * y + 0.3).cos()) as f32
    }

    #[test]
    fn the_spline_passes_through_the_pixels_and_near_what_lies_between() {
        let values = (0..30 * 20).map(|at| wave(f64::from(at % 30), f64::from(at / 30))).collect();
        let plane = Plane::new(30, 20, values).unwrap();
        let spline = Spline::of(&plane);
        let mean = plane.values().iter().sum::<f32>() / 600.0;
        for row in 0..20_u16 {
            for column in 0..30_u16 {
                let [value, dx, dy] = spline.at_pixel(column.into(), row.into());
                let found = spline.at(column.into(), row.into()).unwrap();
                let there = plane.at(column.into(), row.into()) - mean;
                assert!((value - there).abs() < 1e-3 && (found - there).abs() < 1e-3);
                // A wave of 9 pixels: slopes of the spline are true within 1 % of the steepest.
                let (x, y) = (f64::from(column), f64::from(row));
                let near_rim = column < 4 || row < 4 || column > 25 || row > 15;
                let slopes = [
                    14.0 * (0.7 * x).cos() * (0.5 * y + 0.3).cos(),
                    -10.0 * (0.7 * x).sin() * (0.5 * y + 0.3).sin(),
                ];
                let off = (f64::from(dx) - slopes[0]).hypot(f64::from(dy) - slopes[1]);
                assert!(near_rim || off < 0.14, "{column} {row}: {off}");
            }
        }
        for (x, y) in [(10.3, 9.7), (15.5, 10.5), (20.9, 8.1)] {
            let found = spline.at(x as f32, y as f32).unwrap() + mean;
            assert!((found - wave(x, y)).abs() < 0.05, "{x} {y}");
        }
        assert_eq!((spline.at(-0.1, 3.0), spline.at(29.1, 3.0)), (None, None));
        assert_eq!(spline.at(f32::NAN, 3.0), None);
    }
}
