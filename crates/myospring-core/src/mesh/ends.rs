//! The ends of a cell along its long axis, which are clamped or held, and between which its length
//! is measured.

use super::Mesh;

/// Part of the length that belongs to an end.
pub const END_PART: f64 = 0.05;

/// The points in the outer [`END_PART`] of their extent along the unit vector `axis`, at the lower and at the upper end.
///
/// # Example
/// ```
/// use myospring::mesh::ends::end_points;
/// let points = [vec![0.0, 1.0, 2.0, 98.0, 99.0, 100.0], vec![0.0; 6], vec![0.0; 6]];
/// assert_eq!(end_points(&points, [1.0, 0.0, 0.0]), [vec![0, 1, 2], vec![3, 4, 5]]);
/// ```
pub fn end_points<const D: usize>(points: &[Vec<f64>; D], axis: [f64; D]) -> [Vec<usize>; 2] {
    let along = along(points, axis);
    let lowest = along.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let zone = END_PART * (highest - lowest);
    let within = |held: &dyn Fn(f64) -> bool| -> Vec<usize> {
        (0..along.len()).filter(|&point| held(along[point])).collect()
    };
    [within(&|s| s <= lowest + zone), within(&|s| s >= highest - zone)]
}

/// Coordinate of each point along a unit vector, um.
fn along<const D: usize>(points: &[Vec<f64>; D], axis: [f64; D]) -> Vec<f64> {
    let place = |point: usize| {
        let parts = points.iter().zip(axis).map(|(x, part)| x[point] * part);
        parts.reduce(|sum, part| sum + part).unwrap_or_default()
    };
    (0..points.first().map_or(0, Vec::len)).map(place).collect()
}

/// The nodes in the outer [`END_PART`] of the length of a mesh whose long axis is the unit vector `axis`; see
/// [`end_points`].
pub fn end_nodes<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    axis: [f64; D],
) -> [Vec<usize>; 2] {
    end_points(&mesh.points, axis)
}

/// Range of the [`end_nodes`] along the unit vector `axis`, at the lower and at the upper end, um.
pub fn end_zones<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    axis: [f64; D],
) -> [[f64; 2]; 2] {
    let along = along(&mesh.points, axis);
    end_nodes(mesh, axis).map(|nodes| {
        let places = nodes.iter().map(|&node| along[node]);
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
    })
}
