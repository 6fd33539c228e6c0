//! Displacements by forces on all nodes of a lattice at once: a convolution, by Fourier transforms.
//!
//! Displacement depends on the distance between two nodes alone, so the matrix between all of them is a Toeplitz matrix,
//! and its product with the forces a convolution. It is computed on twice the rows and columns of the lattice, so that
//! nothing wraps round. Both components of a vector are one complex number.

use super::green::Green;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

pub(super) type Number = Complex<f64>;

/// Fourier transforms of a grid.
struct Transforms {
    /// Columns and rows.
    size: [usize; 2],
    /// Along rows and along columns, there and back.
    rows: [Arc<dyn Fft<f64>>; 2],
    columns: [Arc<dyn Fft<f64>>; 2],
}

impl Transforms {
    fn new(size: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let mut both =
            |length| [planner.plan_fft_forward(length), planner.plan_fft_inverse(length)];
        Self { size, rows: both(size[0]), columns: both(size[1]) }
    }

    /// Transforms a grid that is stored row by row, of which those rows that are not there are 0; column by column.
    fn forward(&self, mut grid: Vec<Number>) -> Vec<Number> {
        let [width, height] = self.size;
        self.rows[0].process(&mut grid);
        let mut turned = vec![Number::default(); width * height];
        for (row, values) in grid.chunks_exact(width).enumerate() {
            for (column, value) in values.iter().enumerate() {
                turned[column * height + row] = *value;
            }
        }
        self.columns[0].process(&mut turned);
        turned
    }

    /// The first rows of what was transformed, times the number of places.
    fn back(&self, mut turned: Vec<Number>, rows: usize) -> Vec<Number> {
        let [width, height] = self.size;
        self.columns[1].process(&mut turned);
        let mut grid = vec![Number::default(); width * rows];
        for (column, values) in turned.chunks_exact(height).enumerate() {
            for (row, value) in values[..rows].iter().enumerate() {
                grid[row * width + column] = *value;
            }
        }
        self.rows[1].process(&mut grid);
        grid
    }

    /// Calls `change` for each pair of opposite waves, and for those that are their own opposite, with the transforms of two
    /// real fields that are one complex number, and sets both to what it gives.
    fn for_waves(
        &self,
        turned: &mut [Number],
        mut change: impl FnMut(usize, [Number; 2]) -> [Number; 2],
    ) {
        let [width, height] = self.size;
        for column in 0..=width / 2 {
            let opposite = (width - column) % width;
            for row in 0..height {
                let [here, there] =
                    [column * height + row, opposite * height + (height - row) % height];
                if here > there && column == opposite {
                    continue;
                }
                // x and y from the transform of x + i y here and at the opposite wave vector.
                let (a, b) = (turned[here], turned[there].conj());
                let [x, y] = change(here, [0.5 * (a + b), Number::new(0.0, -0.5) * (a - b)]);
                turned[here] = x + Number::i() * y;
                turned[there] = x.conj() + Number::i() * y.conj();
            }
        }
    }
}

/// The convolution on a lattice.
pub(super) struct Convolution {
    /// Columns and rows of the lattice.
    shape: [usize; 2],
    /// Of twice as many.
    transforms: Transforms,
    /// The transformed displacements `[xx, xy, yy]`, column by column, with the factor of the transform back; they are real,
    /// because a force moves opposite places alike.
    kernel: Vec<[f64; 3]>,
}

impl Convolution {
    /// The convolution on a lattice; `shape` has its columns and rows.
    pub(super) fn new(green: &Green, spacing: f64, shape: [usize; 2]) -> Self {
        Self::of(|x, y| green.at(x, y), spacing, shape)
    }

    /// The convolution of forces normal to the surface, each the first of two, with what they move normal to it.
    pub(super) fn normal(green: &Green, spacing: f64, shape: [usize; 2]) -> Self {
        Self::of(|x, y| [green.normal_at(x, y), 0.0, 0.0], spacing, shape)
    }

    /// `moved` are the displacements `[xx, xy, yy]` at a distance, um/nN.
    fn of(moved: impl Fn(f64, f64) -> [f64; 3], spacing: f64, shape: [usize; 2]) -> Self {
        let transforms = Transforms::new(shape.map(|count| smooth(2 * count - 1)));
        let [width, height] = transforms.size;
        // xx and yy as one complex number, whose transforms are both real; xy as another.
        let mut grids = [(); 2].map(|()| vec![Number::default(); width * height]);
        for row in 0..shape[1] {
            for column in 0..shape[0] {
                let [xx, xy, yy] = moved(spacing * column as f64, spacing * row as f64);
                let across = [column, (width - column) % width];
                let along = [row, (height - row) % height];
                for (j, y) in [(along[0], 1.0), (along[1], -1.0)] {
                    for (i, x) in [(across[0], 1.0), (across[1], -1.0)] {
                        grids[0][j * width + i] = Number::new(xx, yy);
                        grids[1][j * width + i] = Number::new(x * y * xy, 0.0);
                    }
                }
            }
        }
        let scale = 1.0 / (width * height) as f64;
        let [straight, mixed] = grids.map(|grid| transforms.forward(grid));
        let entries = straight.iter().zip(&mixed);
        let kernel =
            entries.map(|(own, mixed)| [own.re, mixed.re, own.im].map(|x| scale * x)).collect();
        Self { shape, transforms, kernel }
    }

    /// The displacements (um) of all places under forces (nN) at them, x and y as one complex number, row by row.
    ///
    /// `places` are column and row of each.
    pub(super) fn displacements(
        &self,
        places: &[[u32; 2]],
        forces: &[Vec<f64>; 2],
    ) -> [Vec<f64>; 2] {
        let [width, _] = self.transforms.size;
        let rows = self.shape[1];
        let at = |&[column, row]: &[u32; 2]| row as usize * width + column as usize;
        let mut grid = vec![Number::default(); width * rows];
        for (place, (x, y)) in places.iter().zip(forces[0].iter().zip(&forces[1])) {
            grid[at(place)] = Number::new(*x, *y);
        }
        let mut turned = self.transforms.forward(grid);
        self.transforms.for_waves(&mut turned, |wave, [x, y]| {
            let [xx, xy, yy] = self.kernel[wave];
            [x * xx + y * xy, x * xy + y * yy]
        });
        let grid = self.transforms.back(turned, rows);
        let moved = places.iter().map(|place| grid[at(place)]);
        moved.map(|moved| (moved.re, moved.im)).unzip::<_, _, Vec<f64>, Vec<f64>>().into()
    }
}

/// The waves of a window that goes on periodically.
pub(super) struct Waves(Transforms);

impl Waves {
    /// The waves of a window; `shape` has its columns and rows.
    pub(super) fn new(shape: [usize; 2]) -> Self {
        Self(Transforms::new(shape))
    }

    /// Multiplies the waves of a vector field, which is stored row by row: `change` gets column and row of the wave vector, and
    /// the transforms of both components.
    pub(super) fn changed(
        &self,
        vectors: &[Vec<f64>; 2],
        mut change: impl FnMut([usize; 2], [Number; 2]) -> [Number; 2],
    ) -> [Vec<f64>; 2] {
        let [width, height] = self.0.size;
        let both = vectors[0].iter().zip(&vectors[1]);
        let mut turned = self.0.forward(both.map(|(x, y)| Number::new(*x, *y)).collect());
        self.0.for_waves(&mut turned, |wave, parts| change([wave / height, wave % height], parts));
        let scale = 1.0 / (width * height) as f64;
        let grid = self.0.back(turned, height);
        grid.into_iter()
            .map(|value| (scale * value.re, scale * value.im))
            .unzip::<_, _, Vec<f64>, Vec<f64>>()
            .into()
    }
}

/// The smallest number from this one on without prime factors above 5: transforms of such lengths are fast.
fn smooth(least: usize) -> usize {
    let is_smooth = |number: &usize| {
        [2, 3, 5].into_iter().fold(*number, |mut rest, factor| {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
            rest
        }) == 1
    };
    // A power of two is among them.
    (least..=2 * least).find(is_smooth).unwrap_or(least)
}
