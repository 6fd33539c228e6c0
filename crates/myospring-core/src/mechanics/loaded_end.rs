//! A loaded end: the end of a cell that shortens against a constant load.
//!
//! The nodes of the end move together along the axis and not across it, as on the plate of a force transducer: each is
//! tied to the mean displacement of all by a spring far stiffer than the cell. The load acts on that mean:
//!
//! ```text
//! E = (K/2) sum ((u_i . a - m)^2 + (u_i . t)^2) - F m        m = mean of u_i . a
//! ```
//!
//! with displacements u from the stop of the grip, the axis a, and t across it (with three axes, two such). The load's part of
//! the energy is the work done on it since the grip left its stop.

use super::force::{Configuration, Force};
use super::stiffness::StiffnessMatrix;
use super::vectors::{Vectors, dot};
use crate::mesh::Mesh;
use crate::mesh::ends::end_nodes;
use std::array::from_fn;

/// Stiffness of the ties relative to that of an axial spring of the cell: the deformation of the
/// grip itself is about 1e-5 of the cell's length.
const STIFFER: f64 = 100.0;

/// The gripped nodes of the upper end, and the load on them.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedEnd<const D: usize = 2> {
    nodes: Vec<usize>,
    /// Their positions at the stop, um.
    stop: Vec<[f64; D]>,
    /// Unit vectors along the axis and across it.
    directions: [[f64; D]; D],
    /// Stiffness of each tie, nN/um.
    stiffness: f64,
    /// Load, nN.
    load: f64,
}

impl<const D: usize> LoadedEnd<D> {
    /// A grip at the upper end of a mesh whose long axis is the unit vector `axis`, in the plane of the first two axes, with its
    /// stop at `positions` (um), under a load in nN that pulls it outward; `spring` is the stiffness of
    /// an axial spring, nN/um.
    pub fn new<const N: usize>(
        mesh: &Mesh<D, N>,
        axis: [f64; D],
        positions: &Vectors<D>,
        spring: f64,
        load: f64,
    ) -> Self {
        let [_, nodes] = end_nodes(mesh, axis);
        let place = |&node: &usize| from_fn(|axis| positions[axis][node]);
        let directions = from_fn(|number| match number {
            0 => axis,
            1 => from_fn(|k| [-axis[1], axis[0]].get(k).copied().unwrap_or(0.0)),
            _ => from_fn(|k| f64::from(u8::from(k == number))),
        });
        let stop = nodes.iter().map(place).collect();
        Self { nodes, stop, directions, stiffness: STIFFER * spring, load }
    }

    /// Displacements of the nodes along and across the axis, and the mean along it.
    fn displacements(&self, positions: &Vectors<D>) -> (Vec<[f64; D]>, f64) {
        let one = |(&node, stop): (&usize, &[f64; D])| {
            let moved = from_fn(|axis| positions[axis][node] - stop[axis]);
            self.directions.map(|direction| dot(moved, direction))
        };
        let all: Vec<[f64; D]> = self.nodes.iter().zip(&self.stop).map(one).collect();
        let mean = all.iter().map(|moved| moved[0]).sum::<f64>() / all.len() as f64;
        (all, mean)
    }
}

impl<const D: usize> Force<D> for LoadedEnd<D> {
    fn name(&self) -> &'static str {
        "loaded grip"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        let (all, mean) = self.displacements(at.positions);
        let load = self.load / self.nodes.len() as f64;
        for (&node, moved) in self.nodes.iter().zip(all) {
            let parts: [f64; D] = from_fn(|k| match k {
                0 => load - self.stiffness * (moved[0] - mean),
                _ => -self.stiffness * moved[k],
            });
            for axis in 0..D {
                forces[axis][node] += dot(parts, self.directions.map(|of| of[axis]));
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let (all, mean) = self.displacements(at.positions);
        let tied = |moved: &[f64; D]| {
            (moved[0] - mean).powi(2) + moved[1..].iter().map(|across| across * across).sum::<f64>()
        };
        Some(0.5 * self.stiffness * all.iter().map(tied).sum::<f64>() - self.load * mean)
    }

    fn add_stiffness(
        &self,
        _at: &Configuration<'_, D>,
        stiffness: &mut StiffnessMatrix<D>,
    ) -> bool {
        let [axis, across @ ..] = &self.directions[..] else { return false };
        let share = 1.0 / self.nodes.len() as f64;
        for (first, &node) in self.nodes.iter().enumerate() {
            for &other in &self.nodes[first..] {
                let same = node == other;
                let part = self.stiffness * (if same { 1.0 } else { 0.0 } - share);
                let own = if same { self.stiffness } else { 0.0 };
                let block = from_fn(|i| {
                    from_fn(|j| {
                        let held = across.iter().map(|of| of[i] * of[j]).sum::<f64>();
                        part * (axis[i] * axis[j]) + own * held
                    })
                });
                stiffness.add(node, other, block);
            }
        }
        true
    }

    fn is_internal(&self) -> bool {
        false
    }
}
