//! A cell that the frame of its film cuts: what is not seen of it pulls at it there.
//!
//! How hard, nobody knows; but where the points at the cut have gone was seen. They are held there, which makes up for
//! whatever force it takes. As each has its own noise, and neighbours that part make much force, they are held where a
//! plane through the ways of all points around them has them.

use super::observed_peak::ObservedPeak;
use crate::mechanics::support::Support;
use crate::mechanics::{Body, System};
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};

/// Points so many squares away from one hardly count for it.
const REACH: f64 = 2.0;

/// Holds the points at the cut where they were seen, and puts all others there; whether there is a cut.
pub(super) fn hold(mesh: &Mesh, seen: &ObservedPeak, body: &mut Body, system: &mut System) -> bool {
    let cut: Vec<usize> = (0..mesh.len()).filter(|&point| seen.cut[point]).collect();
    if cut.is_empty() {
        return false;
    }
    let clamped = match &system.support {
        // Ends that are clamped besides stay where they are.
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

/// The way at a place, um: a plane through the ways of the points around it that were found.
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
    // Too few points for a plane have a mean.
    let inverse = normal.try_inverse();
    sides.map(|side| inverse.map_or_else(|| mean(&side), |inverse| (inverse * side)[0]))
}
