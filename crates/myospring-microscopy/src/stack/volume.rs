//! Values on a grid of voxels.

use crate::filter;
use crate::plane::Plane;

/// A box of values: x fastest, then rows from the top of the picture, then slices in the order of
/// the file.
#[derive(Debug, Clone)]
pub(super) struct Volume<T> {
    /// Columns, rows and slices.
    pub(super) size: [usize; 3],
    /// Sides of a voxel, um.
    pub(super) pitch: [f64; 3],
    pub(super) values: Vec<T>,
}

impl<T: Copy> Volume<T> {
    /// Number of voxels of one slice.
    pub(super) fn layer(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The slices from the first on.
    pub(super) fn slices(&self) -> impl Iterator<Item = &[T]> {
        self.values.chunks_exact(self.layer())
    }

    /// Values of one column in depth, from the first slice on.
    pub(super) fn column(&self, at: usize) -> impl Iterator<Item = T> + '_ {
        self.values[at..].iter().step_by(self.layer()).copied()
    }
}

impl Volume<f32> {
    /// Smoothed with a Gaussian of standard deviation `um`; nothing is smoothed along an axis with
    /// voxels longer than about three of it.
    pub(super) fn smoothed(self, um: f64) -> Self {
        let Self { size, pitch, mut values } = self;
        let layer = size[0] * size[1];
        for slice in values.chunks_exact_mut(layer) {
            if let Some(plane) = Plane::new(size[0], size[1], slice.to_vec()) {
                slice.copy_from_slice(filter::gaussian(&plane, um / pitch[0]).values());
            }
        }
        // Rows of slices as a picture: its columns are voxels, its rows slices.
        for row in 0..size[1] {
            let starts = (0..size[2]).map(|z| z * layer + row * size[0]);
            let side = starts.clone().flat_map(|at| values[at..][..size[0]].iter().copied());
            let side = Plane::new(size[0], size[2], side.collect());
            let Some(side) = side.map(|side| filter::gaussian_down(&side, um / pitch[2])) else {
                continue;
            };
            for (at, smooth) in starts.zip(side.values().chunks_exact(size[0])) {
                values[at..][..size[0]].copy_from_slice(smooth);
            }
        }
        Self { size, pitch, values }
    }

    /// The largest value of each column in depth.
    pub(super) fn largest_down(&self) -> Vec<f32> {
        let mut most = vec![f32::NEG_INFINITY; self.layer()];
        for slice in self.slices() {
            for (most, value) in most.iter_mut().zip(slice) {
                *most = most.max(*value);
            }
        }
        most
    }

    /// The largest value within `reach` slices above and below.
    pub(super) fn largest_near(&self, reach: usize) -> Self {
        let layer = self.layer();
        let count = self.size[2];
        let mut values = self.values.clone();
        for (z, most) in values.chunks_exact_mut(layer).enumerate() {
            for other in z.saturating_sub(reach)..(z + reach + 1).min(count) {
                for (most, value) in most.iter_mut().zip(&self.values[other * layer..]) {
                    *most = most.max(*value);
                }
            }
        }
        Self { values, ..*self }
    }

    /// The box of columns `from` to `to` (column and row, without the last) in all slices.
    pub(super) fn cropped(&self, from: [usize; 2], to: [usize; 2]) -> Self {
        let size = [to[0] - from[0], to[1] - from[1], self.size[2]];
        let row = |slice: usize, row: usize| {
            let start = slice * self.layer() + row * self.size[0];
            &self.values[start + from[0]..start + to[0]]
        };
        let rows = (0..size[2]).flat_map(|z| (from[1]..to[1]).map(move |y| (z, y)));
        let values = rows.flat_map(|(z, y)| row(z, y).iter().copied()).collect();
        Self { size, values, ..*self }
    }

    /// Interpolated linearly to `parts` layers per slice; the values continue outward beyond the
    /// middles of the first and last slice.
    pub(super) fn finer(&self, parts: usize) -> Self {
        let last = self.size[2] - 1;
        let layer = self.layer();
        let slice = |z: usize| &self.values[z * layer..][..layer];
        let mut values = Vec::with_capacity(self.values.len() * parts);
        for at in 0..self.size[2] * parts {
            let z = ((at as f32 + 0.5) / parts as f32 - 0.5).clamp(0.0, last as f32);
            let (low, part) = (z as usize, z.fract());
            let pairs = slice(low).iter().zip(slice((low + 1).min(last)));
            values.extend(pairs.map(|(a, b)| a + part * (b - a)));
        }
        let size = [self.size[0], self.size[1], self.size[2] * parts];
        let pitch = [self.pitch[0], self.pitch[1], self.pitch[2] / parts as f64];
        Self { size, pitch, values }
    }
}
