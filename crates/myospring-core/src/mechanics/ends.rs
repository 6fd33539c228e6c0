//! The ends of a cell along its long axis, where it is clamped or held.

use crate::mesh::Mesh;

/// Part of the length at an end that a clamp or spring holds.
pub const END_PART: f64 = 0.05;

/// The nodes in the outer [`END_PART`] of the length at the lower and at the upper end of a mesh whose
/// long axis is the unit vector `axis`.
pub fn end_nodes<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    axis: [f64; D],
) -> [Vec<usize>; 2] {
    let place = |node: usize| {
        let parts = mesh.points.iter().zip(axis).map(|(x, part)| x[node] * part);
        parts.reduce(|sum, part| sum + part).unwrap_or_default()
    };
    let along: Vec<f64> = (0..mesh.len()).map(place).collect();
    let lowest = along.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let zone = END_PART * (highest - lowest);
    let nodes = |held: &dyn Fn(f64) -> bool| -> Vec<usize> {
        (0..along.len()).filter(|&node| held(along[node])).collect()
    };
    [nodes(&|s| s <= lowest + zone), nodes(&|s| s >= highest - zone)]
}

/// Where along the unit vector `axis` the [`end_nodes`] lie, from and to, at the lower and at the upper end, um.
pub fn end_zones<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    axis: [f64; D],
) -> [[f64; 2]; 2] {
    end_nodes(mesh, axis).map(|nodes| {
        let along = nodes.iter().map(|&node| {
            let place = mesh.point(node);
            (0..D).map(|k| place[k] * axis[k]).sum::<f64>()
        });
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
    })
}
