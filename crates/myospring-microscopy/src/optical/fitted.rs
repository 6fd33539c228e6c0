//! Activation times over a grid: single errors, and gradients.

use myospring_core::analysis::order::median;
use myospring_core::mesh::Mesh;
use nalgebra::{Matrix6, Vector6};
use std::collections::HashMap;

/// Points on each side to which a parabola is fitted, and the fewest that it needs.
const REACH: i64 = 3;
const FEWEST: usize = 12;
/// A second fit leaves out what is farther from the parabola than this many median distances.
const FAR: f64 = 3.0;

/// The points of a grid, by column and row.
struct Grid {
    places: Vec<[i64; 2]>,
    nodes: HashMap<[i64; 2], usize>,
}

impl Grid {
    fn new(mesh: &Mesh) -> Self {
        let cells = mesh.lattice.iter().flat_map(|lattice| &lattice.cells);
        let places: Vec<[i64; 2]> = cells.map(|cell| cell.map(i64::from)).collect();
        let nodes = places.iter().enumerate().map(|(node, place)| (*place, node)).collect();
        Self { places, nodes }
    }

    /// Points within a reach of one, and where they lie from it.
    fn near(&self, node: usize, reach: i64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let [column, row] = self.places[node];
        let square = (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |x| [x, y]));
        let disc = square.filter(move |[x, y]| x * x + y * y <= reach * reach + 1);
        disc.filter_map(move |[x, y]| {
            let node = self.nodes.get(&[column + x, row + y])?;
            Some((*node, [x as f64, y as f64]))
        })
    }
}

/// Each value replaced by the median of it and its neighbours; one of which fewer than half of the neighbours are known is none.
pub(super) fn middling(mesh: &Mesh, values: &[Option<f64>]) -> Vec<Option<f64>> {
    let grid = Grid::new(mesh);
    let one = |node: usize| {
        values[node]?;
        let near: Vec<Option<f64>> = grid.near(node, 1).map(|(at, _)| values[at]).collect();
        let known: Vec<f64> = near.iter().flatten().copied().collect();
        if 2 * known.len() > near.len() { median(known) } else { None }
    };
    (0..mesh.len()).map(one).collect()
}

/// The gradient of times at each point, ms/um, along x and y, from the parabola `a + b x + c y + d x^2 + e x y + f y^2` that fits those
/// around it best; `None` where too few are known.
pub(super) fn fitted_slopes(
    mesh: &Mesh,
    spacing: f64,
    times_ms: &[Option<f64>],
) -> Vec<Option<[f64; 2]>> {
    let grid = Grid::new(mesh);
    let one = |node: usize| {
        times_ms[node]?;
        let near = grid.near(node, REACH).filter_map(|(at, place)| Some((place, times_ms[at]?)));
        let mut near: Vec<([f64; 2], f64)> = near.collect();
        let mut parabola = fit(&near)?;
        let off = |(place, time): &([f64; 2], f64), of: &Vector6<f64>| {
            (of.dot(&terms(*place)) - time).abs()
        };
        let usual = median(near.iter().map(|point| off(point, &parabola)))?;
        let count = near.len();
        near.retain(|point| off(point, &parabola) <= FAR * usual);
        if near.len() < count {
            parabola = fit(&near)?;
        }
        Some([parabola[1] / spacing, parabola[2] / spacing])
    };
    (0..mesh.len()).map(one).collect()
}

fn terms([x, y]: [f64; 2]) -> Vector6<f64> {
    Vector6::new(1.0, x, y, x * x, x * y, y * y)
}

/// The least-squares parabola.
fn fit(points: &[([f64; 2], f64)]) -> Option<Vector6<f64>> {
    if points.len() < FEWEST {
        return None;
    }
    let (mut left, mut right) = (Matrix6::zeros(), Vector6::zeros());
    for (place, time) in points {
        let terms = terms(*place);
        left += terms * terms.transpose();
        right += *time * terms;
    }
    left.cholesky().map(|factor| factor.solve(&right))
}
