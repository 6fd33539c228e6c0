//! A cell that the frame of its film cuts: the part beyond the frame pulls at it.
//!
//! That force is not known, but the positions of the points at the cut were measured. They are held
//! there, which replaces the force. Since each has its own noise, and neighbours that move apart
//! make large forces, their displacements are smoothed: each is that of a plane through the
//! displacements of the points around it.

use super::observed_peak::ObservedPeak;
use crate::mechanics::support::Support;
use crate::mechanics::{Body, System};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};

/// Width of the smoothing, in squares.
const REACH: f64 = 2.0;

/// Holds the points at the cut at their measured positions and moves all others to theirs; returns
/// whether there is a cut.
pub(super) fn hold(mesh: &Mesh, seen: &ObservedPeak, body: &mut Body, system: &mut System) -> bool {
    let cut: Vec<usize> = (0..mesh.len()).filter(|&point| seen.cut[point]).collect();
    if cut.is_empty() {
        return false;
    }
    let clamped = match &system.support {
        // Clamped ends stay clamped.
        Support::Clamped(nodes) => nodes.clone(),
        Support::MassCentre | Support::Free => Vec::new(),
    };
    for point in (0..mesh.len()).filter(|point| !clamped.contains(point)) {
        let place = mesh.point(point);
        for (axis, way) in smooth(mesh, seen, place).into_iter().enumerate() {
            body.positions[axis][point] = place[axis] + way;
        }
    }
    let mut held = clamped;
    held.extend(cut);
    held.sort_unstable();
    held.dedup();
    system.support = Support::Clamped(held);
    true
}

/// The smoothed displacement at a place, um: that of a plane through the displacements of the found
/// points around it.
fn smooth(mesh: &Mesh, seen: &ObservedPeak, place: [f64; 2]) -> [f64; 2] {
    let mut normal = Matrix3::zeros();
    let mut sides = [Vector3::zeros(); 2];
    for point in (0..mesh.len()).filter(|&point| seen.found[point]) {
        let [x, y] = [0, 1].map(|axis: usize| mesh.points[axis][point] - place[axis]);
        let square = (x * x + y * y) / seen.alike_um.powi(2);
        if square > REACH.powi(2) {
            continue;
        }
        let weight = (-square).exp();
        let terms = Vector3::new(1.0, x, y);
        normal += weight * terms * terms.transpose();
        for (axis, side) in sides.iter_mut().enumerate() {
            *side += weight * seen.displacements_um[axis][point] * terms;
        }
    }
    let mean =
        |side: &Vector3<f64>| if normal[(0, 0)] > 0.0 { side[0] / normal[(0, 0)] } else { 0.0 };
    // With too few points for a plane, their mean.
    let inverse = normal.try_inverse();
    sides.map(|side| inverse.map_or_else(|| mean(&side), |inverse| (inverse * side)[0]))
}
