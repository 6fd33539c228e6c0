//! Length, width, area and stretches of the whole cell, defined as for a simulated beat.

use super::CellMotion;
use myospring_core::analysis::shape::{Extent, ShapeMeter};
use myospring_core::mesh::quality::long_axis;
use myospring_core::mesh::simplex::measure_at;

/// Least part of the cell's area that must be tracked to represent the whole cell.
const LEAST_SEEN: f64 = 0.1;

/// Principal stretches of a deformation, and the direction of the smaller one at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretches {
    /// The smaller one: below 1 where the cell shortens.
    pub smaller: f64,
    /// The larger one.
    pub larger: f64,
    /// Unit vector at rest along the smaller stretch.
    pub direction: [f64; 2],
}

impl Stretches {
    /// Computes the stretches from a deformation gradient `f[a][b]`, position `a` now by position
    /// `b` at rest: the square roots of the eigenvalues of `F^T F`.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::motion::Stretches;
    /// let shortened = Stretches::of([[0.9, 0.0], [0.0, 1.05]]);
    /// assert!((shortened.smaller - 0.9).abs() < 1e-12 && (shortened.larger - 1.05).abs() < 1e-12);
    /// assert!(shortened.direction[0].abs() > 0.999);
    /// ```
    pub fn of(f: [[f64; 2]; 2]) -> Self {
        let dot = |i: usize, j: usize| f[0][i] * f[0][j] + f[1][i] * f[1][j];
        let (a, b, d) = (dot(0, 0), dot(0, 1), dot(1, 1));
        let (mean, half) = (f64::midpoint(a, d), 0.5 * (a - d));
        let radius = half.hypot(b);
        // The eigenvector of the larger eigenvalue lies at half this angle; that of the smaller one
        // is perpendicular.
        let angle = 0.5 * b.atan2(half) + std::f64::consts::FRAC_PI_2;
        Self {
            smaller: (mean - radius).max(0.0).sqrt(),
            larger: (mean + radius).sqrt(),
            direction: [angle.cos(), angle.sin()],
        }
    }
}

impl CellMotion {
    /// Number of frames that were followed.
    pub fn len(&self) -> usize {
        self.times_ms.len()
    }

    /// Whether no frame was followed.
    pub fn is_empty(&self) -> bool {
        self.times_ms.is_empty()
    }

    /// Index of the frame at rest among the frames that were followed.
    pub fn rest_index(&self) -> usize {
        self.frames.partition_point(|frame| *frame < self.rest)
    }

    /// Positions of the points in a frame, without the motion of the stage, um: `[axis][point]`.
    ///
    /// # Panics
    /// There is no such frame.
    pub fn positions(&self, frame: usize) -> [Vec<f64>; 2] {
        [0, 1].map(|axis: usize| {
            let moved = self.mesh.points[axis].iter().zip(&self.displacements_um[frame][axis]);
            moved.map(|(rest, u)| rest + u).collect()
        })
    }

    /// Part of the points that were interpolated in a frame, 0 to 1.
    ///
    /// # Panics
    /// There is no such frame.
    pub fn interpolated_share(&self, frame: usize) -> f64 {
        let interpolated = &self.interpolated[frame];
        interpolated.iter().filter(|&&interpolated| interpolated).count() as f64
            / interpolated.len().max(1) as f64
    }

    /// Length and width of the cell in each frame, um, as for a simulated beat ([`ShapeMeter`]):
    /// along and across its long axis, which turns with the cell. Points that were interpolated in
    /// more than half of the frames are left out.
    pub fn extents(&self) -> Vec<Extent> {
        let axis = long_axis(&self.mesh);
        let meter = ShapeMeter::new(self.mesh.points.clone(), axis, &self.seen_areas());
        (0..self.len()).map(|frame| meter.measure(&self.positions(frame))).collect()
    }

    /// Length of the cell in each frame, um; see [`CellMotion::extents`].
    pub fn lengths_um(&self) -> Vec<f64> {
        self.extents().into_iter().map(|extent| extent.length).collect()
    }

    /// Projected area of the lattice in a frame, um^2.
    ///
    /// # Panics
    /// There is no such frame.
    pub fn area_um2(&self, frame: usize) -> f64 {
        let positions = self.positions(frame);
        let areas = self
            .mesh
            .simplices
            .iter()
            .map(|triangle| triangle.weight * measure_at(&positions, triangle.nodes));
        areas.sum()
    }

    /// Deformation gradient of the whole cell in each frame: the affine map closest to its motion,
    /// with points weighted by area. Points that were interpolated in more than half of the frames
    /// are left out. (The mean over triangles is not used: by Gauss's theorem it depends only on
    /// the points of the rim, and so on their noise.)
    pub fn mean_deformations(&self) -> Vec<[[f64; 2]; 2]> {
        let areas = self.seen_areas();
        self.displacements_um.iter().map(|moved| self.mean_deformation(moved, &areas)).collect()
    }

    fn mean_deformation(&self, moved: &[Vec<f64>; 2], areas: &[f64]) -> [[f64; 2]; 2] {
        let rest = &self.mesh.points;
        let total: f64 = areas.iter().sum();
        let mean = |values: &[f64]| {
            values.iter().zip(areas).map(|(value, area)| value * area).sum::<f64>() / total
        };
        let middle = [mean(&rest[0]), mean(&rest[1])];
        let moment = |of: &dyn Fn(usize) -> f64| {
            (0..areas.len()).map(|at| areas[at] * of(at)).sum::<f64>() / total
        };
        let away = |axis: usize, at: usize| rest[axis][at] - middle[axis];
        let second = |a: usize, b: usize| moment(&|at| away(a, at) * away(b, at));
        let (xx, xy, yy) = (second(0, 0), second(0, 1), second(1, 1));
        let determinant = xx * yy - xy * xy;
        let slopes = |axis: usize| {
            let with = |b: usize| moment(&|at| moved[axis][at] * away(b, at));
            let (x, y) = (with(0), with(1));
            [(x * yy - y * xy) / determinant, (y * xx - x * xy) / determinant]
        };
        let [[xx, xy], [yx, yy]] = [slopes(0), slopes(1)];
        [[1.0 + xx, xy], [yx, 1.0 + yy]]
    }

    /// Area of each point, 0 for points that were interpolated in more than half of the frames; if
    /// too few points remain, all points count.
    pub(super) fn seen_areas(&self) -> Vec<f64> {
        let often = |point: usize| {
            let interpolated =
                self.interpolated.iter().filter(|interpolated| interpolated[point]).count();
            2 * interpolated > self.len()
        };
        let areas = &self.mesh.areas;
        let seen: Vec<f64> = areas
            .iter()
            .enumerate()
            .map(|(at, area)| if often(at) { 0.0 } else { *area })
            .collect();
        let least = LEAST_SEEN * areas.iter().sum::<f64>();
        if seen.iter().sum::<f64>() >= least { seen } else { areas.clone() }
    }

    /// Principal stretches of the whole cell in each frame; see [`CellMotion::mean_deformations`].
    pub fn stretches(&self) -> Vec<Stretches> {
        self.mean_deformations().into_iter().map(Stretches::of).collect()
    }
}
