//! A post on a coarse grid: the best of all shifts within reach.

use super::post::Body;
use crate::plane::Plane;

/// A post on a coarse grid that has a grid point at its middle.
#[derive(Debug)]
pub(super) struct Coarse {
    /// Places relative to the middle, grid points.
    at: Vec<[isize; 2]>,
    /// Values minus their mean, divided by their norm.
    values: Vec<f32>,
}

impl Coarse {
    /// The post around a place of a frame; `None` if it has no contrast. `factor` is the number of pixels along a square.
    pub(super) fn of(plane: &Plane, middle: [f64; 2], body: &Body, factor: usize) -> Option<Self> {
        let reach = (body.reach() / factor).cast_signed() + 1;
        let grid = Grid::around(plane, middle, reach, factor);
        let is_inside = |[x, y]: [isize; 2]| body.has([x, y].map(|at| at as f32 * factor as f32));
        let all = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
        let (at, mut values): (Vec<[isize; 2]>, Vec<f32>) =
            all.filter(|&at| is_inside(at)).filter_map(|at| Some((at, grid.at(at)?))).unzip();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        for value in &mut values {
            *value -= mean;
        }
        let norm = values.iter().map(|value| value * value).sum::<f32>().sqrt();
        for value in &mut values {
            *value /= norm;
        }
        (norm > 1e-6).then_some(Self { at, values })
    }

    /// The shift with the best correlation, to whole grid points, within `far` pixels of a shift along each axis.
    pub(super) fn find(
        &self,
        plane: &Plane,
        middle: [f64; 2],
        near: [f64; 2],
        far: f64,
        factor: usize,
    ) -> Option<[f64; 2]> {
        let steps = (far / factor as f64).ceil() as isize;
        let body = self.at.iter().flatten().map(|at| at.abs()).max().unwrap_or(0);
        let place = [0, 1].map(|k: usize| middle[k] + near[k]);
        let grid = Grid::around(plane, place, steps + body, factor);
        let mut best = None;
        for y in -steps..=steps {
            for x in -steps..=steps {
                let correlation = self.correlation(&grid, [x, y]);
                if best.is_none_or(|(before, _)| correlation > before) {
                    best = Some((correlation, [x, y]));
                }
            }
        }
        let (correlation, steps) = best?;
        let shift = |k: usize| near[k] + steps[k] as f64 * factor as f64;
        (correlation > 0.0).then(|| [shift(0), shift(1)])
    }

    /// Correlation with the post shifted on a grid; -1 where too little of it is in the frame.
    fn correlation(&self, grid: &Grid, [x, y]: [isize; 2]) -> f32 {
        let (mut sum, mut squares, mut product, mut own, mut count) = (0.0, 0.0, 0.0, 0.0, 0);
        for (at, rest) in self.at.iter().zip(&self.values) {
            if let Some(value) = grid.at([at[0] + x, at[1] + y]) {
                sum += value;
                squares += value * value;
                product += value * rest;
                own += rest;
                count += 1;
            }
        }
        if 5 * count < 3 * self.at.len() {
            return -1.0;
        }
        let mean = sum / count as f32;
        let norm = (squares - sum * mean).max(0.0).sqrt();
        if norm <= 1e-6 { -1.0 } else { (product - own * mean) / norm }
    }
}

/// Means of squares of a frame, one of them around a given place.
struct Grid {
    reach: isize,
    values: Vec<Option<f32>>,
}

impl Grid {
    fn around(plane: &Plane, place: [f64; 2], reach: isize, factor: usize) -> Self {
        let side = factor.cast_signed();
        let first = place.map(|at| at.round() as isize - side / 2);
        let squares = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
        let mean = |at: [isize; 2]| {
            let start = [0, 1].map(|k: usize| first[k] + at[k] * side);
            let size = [plane.width(), plane.height()].map(usize::cast_signed);
            if (0..2).any(|k| start[k] < 0 || start[k] + side > size[k]) {
                return None;
            }
            let [column, row] = start.map(isize::cast_unsigned);
            let rows = plane.values().chunks_exact(plane.width()).skip(row).take(factor);
            let sum: f32 = rows.map(|line| line[column..column + factor].iter().sum::<f32>()).sum();
            Some(sum / (factor * factor) as f32)
        };
        Self { reach, values: squares.map(mean).collect() }
    }

    /// The mean of a square, counted from the middle one; `None` outside the frame and the grid.
    fn at(&self, [x, y]: [isize; 2]) -> Option<f32> {
        if x.abs() > self.reach || y.abs() > self.reach {
            return None;
        }
        let side = 2 * self.reach + 1;
        self.values[((y + self.reach) * side + x + self.reach).cast_unsigned()]
    }
}
