//! Faults of a moving mesh, and where they are.

use super::StopReason;
use crate::mechanics::Vectors;
use crate::mesh::Mesh;
use crate::mesh::simplex::measure_at;

/// Projected area of a mesh in given positions, um^2.
pub fn projected_area(mesh: &Mesh, positions: &[Vec<f64>; 2]) -> f64 {
    mesh.simplices.iter().map(|simplex| simplex.weight * measure_at(positions, simplex.nodes)).sum()
}

/// The first fault of a body, if there is any.
pub(super) fn fault(
    mesh: &Mesh,
    positions: &Vectors,
    time: f64,
    tension: f64,
) -> Option<StopReason> {
    let [x, y] = positions;
    let rest = |node: usize| (mesh.points[0][node], mesh.points[1][node]);
    if let Some(node) = (0..x.len()).find(|&node| !(x[node].is_finite() && y[node].is_finite())) {
        let (x, y) = rest(node);
        return Some(StopReason::NotFinite { time, node, x, y });
    }
    let zero = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|node| node as usize);
        x[a] == x[b] && y[a] == y[b]
    };
    if let Some(spring) = mesh.springs.iter().position(|spring| zero(spring.nodes)) {
        let node = mesh.springs[spring].nodes[0] as usize;
        let (x, y) = (x[node], y[node]);
        return Some(StopReason::ZeroLength { time, tension, spring, x, y });
    }
    let inverted = |nodes: [u32; 3]| measure_at(positions, nodes) <= 0.0;
    let triangle = mesh.simplices.iter().position(|simplex| inverted(simplex.nodes))?;
    let node = mesh.simplices[triangle].nodes[0] as usize;
    Some(StopReason::Inverted { time, tension, triangle, x: x[node], y: y[node] })
}
