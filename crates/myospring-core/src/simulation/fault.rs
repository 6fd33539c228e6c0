//! Faults of a moving mesh, and where they are.

use super::StopReason;
use crate::mechanics::Vectors;
use crate::mesh::simplex::measure_at;
use crate::mesh::{Mesh, Place};

/// Projected area of a mesh in given positions, um^2.
pub fn projected_area(mesh: &Mesh, positions: &[Vec<f64>; 2]) -> f64 {
    mesh.simplices.iter().map(|simplex| simplex.weight * measure_at(positions, simplex.nodes)).sum()
}

/// The first fault of a body, if there is any.
pub(super) fn fault<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    positions: &Vectors<D>,
    time: f64,
    tension: f64,
) -> Option<StopReason> {
    let lost = |&node: &usize| positions.iter().any(|of| !of[node].is_finite());
    if let Some(node) = (0..positions[0].len()).find(lost) {
        return Some(StopReason::NotFinite { time, node, place: Place::of(&mesh.points, node) });
    }
    let zero = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|node| node as usize);
        positions.iter().all(|of| of[a] == of[b])
    };
    if let Some(spring) = mesh.springs.iter().position(|spring| zero(spring.nodes)) {
        let place = Place::of(positions, mesh.springs[spring].nodes[0] as usize);
        return Some(StopReason::ZeroLength { time, tension, spring, place });
    }
    let inverted = |nodes: [u32; N]| measure_at(positions, nodes) <= 0.0;
    let triangle = mesh.simplices.iter().position(|simplex| inverted(simplex.nodes))?;
    let place = Place::of(positions, mesh.simplices[triangle].nodes[0] as usize);
    Some(StopReason::Inverted { time, tension, triangle, place })
}
