//! A coarse grid over a window of pixels: sums over blocks, Gaussians, and linear interpolation.

/// Square blocks of pixels over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    /// Blocks along a row, and rows of blocks.
    pub(super) size: [usize; 2],
    /// Side of a block, pixels.
    pub(super) block: usize,
}

impl Grid {
    /// Blocks of `block` pixels that cover a window of `[columns, rows]`.
    pub(super) fn over(window: [usize; 2], block: usize) -> Self {
        Self { size: window.map(|length| length.div_ceil(block).max(1)), block }
    }

    pub(super) fn zeros(&self) -> Vec<f32> {
        vec![0.0; self.size[0] * self.size[1]]
    }

    /// Adds a row of pixels to the sums over the blocks.
    pub(super) fn add_row(&self, sums: &mut [f32], row: usize, pixels: &[f32]) {
        let sums = &mut sums[row / self.block * self.size[0]..];
        for (sum, pixels) in sums.iter_mut().zip(pixels.chunks(self.block)) {
            *sum += pixels.iter().sum::<f32>();
        }
    }

    /// Convolves with a Gaussian of `sigma` blocks; values outside the grid count as zero.
    pub(super) fn blur(&self, values: &mut [f32], sigma: f64) {
        let [columns, rows] = self.size;
        let half = half_gaussian(sigma, columns.max(rows));
        let mut blurred = vec![0.0; values.len()];
        for (line, out) in values.chunks_exact(columns).zip(blurred.chunks_exact_mut(columns)) {
            for (offset, &weight) in half.iter().enumerate().take(columns) {
                for (out, value) in out[offset..].iter_mut().zip(line) {
                    *out += weight * value;
                }
                if offset > 0 {
                    for (out, value) in out.iter_mut().zip(&line[offset..]) {
                        *out += weight * value;
                    }
                }
            }
        }
        // Row by row, so that memory is read in order.
        let line = |row: usize| &blurred[row * columns..(row + 1) * columns];
        for (row, out) in values.chunks_exact_mut(columns).enumerate() {
            out.fill(0.0);
            for (offset, &weight) in half.iter().enumerate() {
                let above = (offset > 0 && offset <= row).then(|| line(row - offset));
                let below = (row + offset < rows).then(|| line(row + offset));
                for line in [above, below].into_iter().flatten() {
                    for (out, value) in out.iter_mut().zip(line) {
                        *out += weight * value;
                    }
                }
            }
        }
    }
}

/// Weights of a Gaussian at 0, 1, 2, ..., normalised so that both sides together sum to 1.
pub(super) fn half_gaussian(sigma: f64, longest: usize) -> Vec<f32> {
    let reach = ((4.0 * sigma).ceil() as usize).min(longest);
    let weight = |i: usize| (-0.5 * (i as f64 / sigma.max(1e-3)).powi(2)).exp();
    let sum: f64 = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
    (0..=reach).map(|i| (weight(i) / sum) as f32).collect()
}

/// Interpolation of a pixel's position between block centres: the first block, and the fraction of
/// the way to the next.
pub(super) fn between(place: f64, blocks: usize) -> (usize, f64) {
    let place = if place.is_nan() { 0.0 } else { place.clamp(0.0, (blocks - 1) as f64) };
    let first = (place as usize).min(blocks.saturating_sub(2));
    (first, place - first as f64)
}

/// Values of a grid at all pixels of a row, interpolated linearly between block centres.
pub(super) struct Lines {
    columns: Vec<(u32, f32)>,
    line: Vec<f32>,
    values: Vec<f32>,
}

impl Lines {
    pub(super) fn new(grid: &Grid, pixels: usize) -> Self {
        let column = |pixel: usize| {
            let place = (pixel as f64 + 0.5) / grid.block as f64 - 0.5;
            let (first, part) = between(place, grid.size[0]);
            (first as u32, part as f32)
        };
        Self {
            columns: (0..pixels).map(column).collect(),
            line: vec![0.0; grid.size[0] + 1],
            values: vec![0.0; pixels],
        }
    }

    /// The values along a row of pixels.
    pub(super) fn at(&mut self, grid: &Grid, values: &[f32], row: usize) -> &[f32] {
        let place = (row as f64 + 0.5) / grid.block as f64 - 0.5;
        let (first, part) = between(place, grid.size[1]);
        let lower = &values[first * grid.size[0]..][..grid.size[0]];
        let next = (first + 1).min(grid.size[1] - 1);
        let upper = &values[next * grid.size[0]..][..grid.size[0]];
        for ((out, a), b) in self.line.iter_mut().zip(lower).zip(upper) {
            *out = a + part as f32 * (b - a);
        }
        for (value, &(first, part)) in self.values.iter_mut().zip(&self.columns) {
            let (a, b) = (self.line[first as usize], self.line[first as usize + 1]);
            *value = a + part * (b - a);
        }
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gaussian_keeps_the_sum_and_has_its_width() {
        let grid = Grid { size: [61, 41], block: 1 };
        let mut values = grid.zeros();
        values[20 * 61 + 30] = 1.0;
        grid.blur(&mut values, 3.0);
        let moment = |power: i32| -> f64 {
            let term = |(at, value): (usize, &f32)| {
                f64::from(*value) * ((at % 61) as f64 - 30.0).powi(power)
            };
            values.iter().enumerate().map(term).sum()
        };
        // Cut off at four standard deviations: a part in a thousand of the second moment.
        assert!((moment(0) - 1.0).abs() < 1e-4, "{}", moment(0));
        assert!((moment(2) / 9.0 - 1.0).abs() < 2e-3, "{}", moment(2));
    }

    #[test]
    fn a_straight_slope_stays_straight_between_blocks() {
        let grid = Grid { size: [5, 4], block: 4 };
        // The value of a block is the place of its centre: 2 (column + 1/2) + 3 (row + 1/2).
        let centre = |at: usize| 2.0 * (at % 5) as f32 + 3.0 * (at / 5) as f32;
        let values: Vec<f32> = (0..20).map(centre).collect();
        let mut lines = Lines::new(&grid, 20);
        let found = lines.at(&grid, &values, 9)[7];
        let expected = 2.0 * (7.5 / 4.0 - 0.5) + 3.0 * (9.5 / 4.0 - 0.5);
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }

    #[test]
    fn one_block_is_a_grid() {
        let grid = Grid::over([3, 3], 8);
        let mut values = vec![2.0];
        grid.blur(&mut values, 0.0);
        assert_eq!(Lines::new(&grid, 3).at(&grid, &values, 1), [2.0, 2.0, 2.0]);
    }
}
