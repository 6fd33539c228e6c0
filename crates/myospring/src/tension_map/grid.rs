//! Squares over the cell: those whose points have one error, and the grid that the map is drawn on.

use crate::mesh::Mesh;
use crate::mesh::simplex::measure_at;
use std::collections::BTreeMap;

/// Points of a mesh in squares.
pub(super) struct Squares {
    /// Points of each square.
    pub(super) points: Vec<Vec<usize>>,
    /// Weight of each square: the root of how full it is, relative to the fullest.
    pub(super) weights: Vec<f64>,
}

impl Squares {
    /// The points that `count`, in squares of this side, um.
    pub(super) fn new(mesh: &Mesh, side: f64, counts: &[bool]) -> Self {
        let mut squares = BTreeMap::<[i64; 2], Vec<usize>>::new();
        let start = [0, 1].map(|axis: usize| start(&mesh.points[axis], side));
        for point in (0..mesh.len()).filter(|&point| counts[point]) {
            let at = mesh.point(point);
            let square = [0, 1].map(|axis: usize| ((at[axis] - start[axis]) / side).floor() as i64);
            squares.entry(square).or_default().push(point);
        }
        let points: Vec<Vec<usize>> = squares.into_values().collect();
        let most = points.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let weights = points.iter().map(|points| (points.len() as f64 / most).sqrt()).collect();
        Self { points, weights }
    }

    /// Weight of each point of each square in its mean.
    pub(super) fn shares(&self) -> Vec<f64> {
        self.points
            .iter()
            .zip(&self.weights)
            .map(|(points, weight)| weight / points.len() as f64)
            .collect()
    }

    /// The weighted mean of each square, both axes one after the other.
    pub(super) fn means(&self, vectors: &[Vec<f64>; 2]) -> Vec<f64> {
        let mean = |axis: usize, square: usize| {
            let points = &self.points[square];
            let sum: f64 = points.iter().map(|&point| vectors[axis][point]).sum();
            self.weights[square] * sum / points.len() as f64
        };
        (0..2)
            .flat_map(|axis| (0..self.points.len()).map(move |square| mean(axis, square)))
            .collect()
    }
}

/// Where squares of a side begin, so that they stand evenly over all.
fn start(values: &[f64], side: f64) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let squares = ((high - low) / side).ceil().max(1.0);
    f64::midpoint(low, high) - 0.5 * squares * side
}

/// A grid of points, between which a value in the triangles of a mesh is bilinear.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// For each triangle the points of the grid around its centre, and their weights, which sum to 1.
    pub(super) weights: Vec<Vec<(usize, f64)>>,
    /// Points next to each other.
    pub(super) sides: Vec<[usize; 2]>,
    /// Area that belongs to each point, um^2.
    pub(super) areas: Vec<f64>,
}

impl Grid {
    /// With this distance of its points, um.
    pub(super) fn new(mesh: &Mesh, apart: f64) -> Self {
        let start = [0, 1].map(|axis: usize| start(&mesh.points[axis], apart));
        let mut numbers = BTreeMap::<[i64; 2], usize>::new();
        let mut weights = Vec::with_capacity(mesh.simplices.len());
        let mut areas: Vec<f64> = Vec::new();
        for triangle in &mesh.simplices {
            let centre = mesh.centre(triangle);
            let place = [0, 1].map(|axis: usize| (centre[axis] - start[axis]) / apart);
            let (low, part) = (place.map(f64::floor), place.map(f64::fract));
            let area = triangle.weight * measure_at(&mesh.points, triangle.nodes);
            let mut around = Vec::with_capacity(4);
            for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let along =
                    |axis: usize, next: i32| if next == 1 { part[axis] } else { 1.0 - part[axis] };
                let weight = along(0, i) * along(1, j);
                if weight > 0.0 {
                    let next = numbers.len();
                    let at = [low[0] as i64 + i64::from(i), low[1] as i64 + i64::from(j)];
                    let number = *numbers.entry(at).or_insert(next);
                    if number == areas.len() {
                        areas.push(0.0);
                    }
                    areas[number] += weight * area;
                    around.push((number, weight));
                }
            }
            weights.push(around);
        }
        let beside = |([i, j], number): (&[i64; 2], &usize)| {
            [[i + 1, *j], [*i, j + 1]]
                .into_iter()
                .filter_map(|other| Some([*number, *numbers.get(&other)?]))
                .collect::<Vec<_>>()
        };
        let sides = numbers.iter().flat_map(beside).collect();
        Self { weights, sides, areas }
    }

    pub(super) fn len(&self) -> usize {
        self.areas.len()
    }

    /// The value in each triangle.
    pub(super) fn in_triangles(&self, values: &[f64]) -> Vec<f64> {
        let of = |around: &Vec<(usize, f64)>| around.iter().map(|&(at, w)| w * values[at]).sum();
        self.weights.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;

    #[test]
    fn a_grid_has_the_area_of_the_cell_and_gives_lines_exactly() {
        let mesh = lattice::rectangle(20, 6, 1.0).unwrap();
        let grid = Grid::new(&mesh, 3.0);
        assert!((grid.areas.iter().sum::<f64>() - 120.0).abs() < 1e-9);
        // Values that rise along x by 1 a point: the bilinear map of a line is that line.
        let ones = grid.in_triangles(&vec![1.0; grid.len()]);
        assert!(ones.iter().all(|one| (one - 1.0).abs() < 1e-12));
        assert!(grid.sides.len() >= 2 * grid.len() - 14);
    }

    #[test]
    fn squares_have_every_point_that_counts_once() {
        let mesh = lattice::rectangle(20, 6, 1.0).unwrap();
        let counts: Vec<bool> = (0..mesh.len()).map(|point| point % 5 > 0).collect();
        let squares = Squares::new(&mesh, 4.0, &counts);
        let mut all: Vec<usize> = squares.points.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..mesh.len()).filter(|&point| counts[point]).collect::<Vec<_>>());
        assert!(squares.weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
    }
}
