//! A loaded end: the end of a cell that shortens against a constant load.
//!
//! The nodes of the end move together along the axis and not across it, as on the plate of a force transducer: each is
//! tied to the mean displacement of all by a spring far stiffer than the cell. The load acts on that mean:
//!
//! ```text
//! E = (K/2) sum ((u_i . a - m)^2 + (u_i . t)^2) - F m        m = mean of u_i . a
//! ```
//!
//! with displacements u from the stop of the grip, the axis a, and t across it. The load's part of
//! the energy is the work done on it since the grip left its stop.

use super::force::{Configuration, Force};
use super::stiffness::StiffnessMatrix;
use super::vectors::Vectors;
use crate::mesh::Mesh;
use crate::mesh::ends::end_nodes;

/// Stiffness of the ties relative to that of an axial spring of the cell: the deformation of the
/// grip itself is about 1e-5 of the cell's length.
const STIFFER: f64 = 100.0;

/// The gripped nodes of the upper end, and the load on them.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedEnd {
    nodes: Vec<usize>,
    /// Their positions at the stop, um.
    stop: Vec<[f64; 2]>,
    axis: [f64; 2],
    /// Stiffness of each tie, nN/um.
    stiffness: f64,
    /// Load, nN.
    load: f64,
}

impl LoadedEnd {
    /// A grip at the upper end of a mesh whose long axis is the unit vector `axis`, with its stop
    /// at `positions` (um), under a load in nN that pulls it outward; `spring` is the stiffness of
    /// an axial spring, nN/um.
    pub fn new(mesh: &Mesh, axis: [f64; 2], positions: &Vectors, spring: f64, load: f64) -> Self {
        let [_, nodes] = end_nodes(mesh, axis);
        let stop = nodes.iter().map(|&node| [positions[0][node], positions[1][node]]).collect();
        Self { nodes, stop, axis, stiffness: STIFFER * spring, load }
    }

    /// Displacements of the nodes along and across the axis, and the mean along it.
    fn displacements(&self, positions: &Vectors) -> (Vec<[f64; 2]>, f64) {
        let [a, b] = self.axis;
        let one = |(&node, stop): (&usize, &[f64; 2])| {
            let [x, y] = [0, 1].map(|axis| positions[axis][node] - stop[axis]);
            [x * a + y * b, y * a - x * b]
        };
        let all: Vec<[f64; 2]> = self.nodes.iter().zip(&self.stop).map(one).collect();
        let mean = all.iter().map(|[along, _]| along).sum::<f64>() / all.len() as f64;
        (all, mean)
    }
}

impl Force for LoadedEnd {
    fn name(&self) -> &'static str {
        "loaded grip"
    }

    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        let [a, b] = self.axis;
        let (all, mean) = self.displacements(at.positions);
        let load = self.load / self.nodes.len() as f64;
        for (&node, [along, across]) in self.nodes.iter().zip(all) {
            let (along, across) =
                (load - self.stiffness * (along - mean), -self.stiffness * across);
            forces[0][node] += along * a - across * b;
            forces[1][node] += along * b + across * a;
        }
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        let (all, mean) = self.displacements(at.positions);
        let tied = |[along, across]: &[f64; 2]| (along - mean).powi(2) + across * across;
        Some(0.5 * self.stiffness * all.iter().map(tied).sum::<f64>() - self.load * mean)
    }

    fn add_stiffness(&self, _at: &Configuration<'_>, stiffness: &mut StiffnessMatrix) -> bool {
        let [a, b] = self.axis;
        let (along, across) =
            ([[a * a, a * b], [a * b, b * b]], [[b * b, -a * b], [-a * b, a * a]]);
        let share = 1.0 / self.nodes.len() as f64;
        for (first, &node) in self.nodes.iter().enumerate() {
            for &other in &self.nodes[first..] {
                let same = node == other;
                let part = self.stiffness * (if same { 1.0 } else { 0.0 } - share);
                let own = if same { self.stiffness } else { 0.0 };
                let block = [0, 1].map(|i| [0, 1].map(|j| part * along[i][j] + own * across[i][j]));
                stiffness.add(node, other, block);
            }
        }
        true
    }

    fn is_internal(&self) -> bool {
        false
    }
}
