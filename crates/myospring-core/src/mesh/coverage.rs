//! Exact part of each lattice square inside a cell, for masks and outlines.

use super::mask::Mask;
use super::outline::Outline;
use super::quality::{extent_along, principal_axis};

/// A block of squares; square `(i, j)` has the index `j * columns + i`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Side of a square, um.
    pub(super) spacing: f64,
    /// Lower left corner, um.
    pub(super) origin: [f64; 2],
    /// Squares along x.
    pub(super) columns: usize,
    /// Squares along y.
    pub(super) rows: usize,
}

/// Measures of a cell that are needed to place the lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Area, um^2.
    pub(super) area: f64,
    /// Lower left and upper right corner of the bounding box, um.
    pub(super) bounds: [[f64; 2]; 2],
    /// Extent across the long axis, um.
    pub(super) width: f64,
}

/// A shape that can be covered with a lattice.
pub(super) trait Source {
    /// Its measures.
    fn shape(&self) -> Shape;
    /// Fraction of each square that is inside, 0 to 1.
    fn coverage(&self, grid: &Grid) -> Vec<f64>;
}

impl Source for Mask {
    fn shape(&self) -> Shape {
        let pixel = self.pixel_size().um();
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [x, y] in pixels_up(self) {
            count += 1.0;
            for (axis, value) in [x, y].into_iter().enumerate() {
                sum[axis] += value + 0.5;
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value + 1.0);
            }
        }
        let centre = sum.map(|total| total / count);
        let [mut xx, mut yy, mut xy] = [0.0; 3];
        for [x, y] in pixels_up(self) {
            let (dx, dy) = (x + 0.5 - centre[0], y + 0.5 - centre[1]);
            xx += dx * dx;
            yy += dy * dy;
            xy += dx * dy;
        }
        let [cos, sin] = principal_axis(xx, yy, xy);
        // The corners of the pixels: centres plus half a pixel's own extent.
        let centres = pixels_up(self).map(|[x, y]| [x + 0.5, y + 0.5]);
        let width = extent_along(centres, [-sin, cos]) + cos.abs() + sin.abs();
        Shape {
            area: count * pixel * pixel,
            bounds: [low.map(|value| value * pixel), high.map(|value| value * pixel)],
            width: width * pixel,
        }
    }

    fn coverage(&self, grid: &Grid) -> Vec<f64> {
        // Integral image of the box around the cell, row 0 at the bottom: sums[y][x] = pixels of the cell left of x,
        // below y.
        let part = self.part();
        let (width, height) = (part.width, part.height());
        let bottom = self.height() - part.top - height;
        let stride = width + 1;
        let mut sums = vec![0_u32; stride * (height + 1)];
        for (y, row) in part.inside.chunks_exact(width).rev().enumerate() {
            let mut along = 0;
            for (x, &inside) in row.iter().enumerate() {
                along += u32::from(inside);
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + along;
            }
        }
        // The integral at a point within a pixel: bilinear, since pixels are constant.
        let scale = 1.0 / self.pixel_size().um();
        let place = |at: f64, first: usize, limit: usize| {
            let at = (at * scale - first as f64).clamp(0.0, limit as f64);
            let cell = (at as usize).min(limit - 1);
            (cell, at - cell as f64)
        };
        let corner_row = |j: usize| -> Vec<f64> {
            let (y, fy) = place(grid.origin[1] + grid.spacing * j as f64, bottom, height);
            let along = |x: usize, row: usize| f64::from(sums[row * stride + x]);
            (0..=grid.columns)
                .map(|i| {
                    let (x, fx) = place(grid.origin[0] + grid.spacing * i as f64, part.left, width);
                    (1.0 - fy) * ((1.0 - fx) * along(x, y) + fx * along(x + 1, y))
                        + fy * ((1.0 - fx) * along(x, y + 1) + fx * along(x + 1, y + 1))
                })
                .collect()
        };
        let square = (grid.spacing * scale).powi(2);
        let mut coverage = Vec::with_capacity(grid.columns * grid.rows);
        let mut below = corner_row(0);
        for j in 0..grid.rows {
            let above = corner_row(j + 1);
            for i in 0..grid.columns {
                coverage.push((above[i + 1] - above[i] - below[i + 1] + below[i]) / square);
            }
            below = above;
        }
        coverage
    }
}

/// Lower left corners of the cell's pixels, in pixels from the picture's lower left corner.
fn pixels_up(mask: &Mask) -> impl Iterator<Item = [f64; 2]> + '_ {
    let part = mask.part();
    let up = mask.height() - 1 - part.top;
    part.inside
        .iter()
        .enumerate()
        .filter(|&(_, &inside)| inside)
        .map(move |(at, _)| [(part.left + at % part.width) as f64, (up - at / part.width) as f64])
}

impl Source for Outline {
    fn shape(&self) -> Shape {
        let [xx, yy, xy] = self.second_moments();
        let [cos, sin] = principal_axis(xx, yy, xy);
        Shape {
            area: self.area(),
            bounds: self.bounds(),
            width: extent_along(self.exterior().iter().copied(), [-sin, cos]),
        }
    }

    /// Each edge adds the signed area between itself and a square's right side to that square, and
    /// its height to all squares further right (exact-area method of font rasterisers); the sum
    /// over a closed ring is minus the area inside.
    fn coverage(&self, grid: &Grid) -> Vec<f64> {
        let stride = grid.columns + 1;
        let mut sums = vec![0.0; stride * grid.rows];
        let place = |point: [f64; 2]| [0, 1].map(|k| (point[k] - grid.origin[k]) / grid.spacing);
        let mut cuts = Vec::new();
        for ring in self.rings() {
            for (p, q) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let (p, q) = (place(*p), place(*q));
                let at = |t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
                cuts.clear();
                cuts.extend([0.0, 1.0]);
                for axis in 0..2 {
                    let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
                    let mut line = low.floor() + 1.0;
                    while line < high {
                        cuts.push((line - p[axis]) / (q[axis] - p[axis]));
                        line += 1.0;
                    }
                }
                cuts.sort_by(f64::total_cmp);
                for piece in cuts.windows(2) {
                    let (a, b) = (at(piece[0]), at(piece[1]));
                    let rise = b[1] - a[1];
                    let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                    let i = (middle[0].max(0.0) as usize).min(grid.columns - 1);
                    let j = (middle[1].max(0.0) as usize).min(grid.rows - 1);
                    let right = i as f64 + 1.0 - middle[0];
                    sums[j * stride + i] += rise * right;
                    sums[j * stride + i + 1] += rise * (1.0 - right);
                }
            }
        }
        let mut coverage = Vec::with_capacity(grid.columns * grid.rows);
        for row in sums.chunks_exact(stride) {
            let mut along = 0.0;
            for &value in &row[..grid.columns] {
                along -= value;
                coverage.push(along);
            }
        }
        coverage
    }
}
