//! Myofibrils that resist a change of length more than what is around them.
//!
//! With the deformation gradient `F`, the resting fibre direction `f0` and the resting volume `V0` of a triangle or tetrahedron:
//!
//! ```text
//! E = sum V0 (k_f/8) (|F f0|^2 - 1)^2          f_i = -V0 (k_f/2) (|a|^2 - 1) a (grad N_i . f0),    a = F f0
//! ```
//!
//! For small strains `e` along the fibre this is `k_f e^2/2` per volume: `k_f` adds to the modulus along the fibre and to no other.

use super::active::{FibreStretch, Myofibrils};
use super::force::{Configuration, Force};
use super::stiffness::{Block, StiffnessMatrix};
use super::vectors::{Vectors, dot};
use crate::mesh::{Mesh, simplex};
use std::array::from_fn;

/// The stiffness of the myofibrils along themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreStiffness<const D: usize = 2, const N: usize = 3> {
    stretch: FibreStretch<D, N>,
    /// Resting volumes times the modulus, fJ.
    stiffness: Vec<f64>,
}

impl<const D: usize, const N: usize> FibreStiffness<D, N> {
    /// The law for a modulus `k_f` in kPa; thickness in um, 1 with three axes.
    ///
    /// # Panics
    /// If there is not one direction per triangle.
    pub fn new<'a>(
        mesh: &Mesh<D, N>,
        myofibrils: impl Into<Myofibrils<'a, D>>,
        modulus: f64,
        thickness: f64,
    ) -> Self {
        let Myofibrils { directions, .. } = myofibrils.into();
        let volume = |simplex: &crate::mesh::Simplex<N>| {
            modulus * thickness * simplex.weight * simplex::measure_at(&mesh.points, simplex.nodes)
        };
        let stiffness = mesh.simplices.iter().map(volume).collect();
        Self { stretch: FibreStretch::new(mesh, directions), stiffness }
    }
}

impl<const D: usize, const N: usize> Force<D> for FibreStiffness<D, N> {
    fn name(&self) -> &'static str {
        "stiffness of the fibres"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for (element, stiffness) in self.stiffness.iter().enumerate() {
            let (nodes, along) = self.stretch.element(element);
            let fibre = self.stretch.fibre(element, at.positions);
            let pull = 0.5 * stiffness * (dot(fibre, fibre) - 1.0);
            for (node, along) in nodes.iter().zip(along) {
                for axis in 0..D {
                    forces[axis][*node as usize] -= pull * along * fibre[axis];
                }
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let one = |(element, stiffness): (usize, &f64)| {
            let fibre = self.stretch.fibre(element, at.positions);
            0.125 * stiffness * (dot(fibre, fibre) - 1.0).powi(2)
        };
        Some(self.stiffness.iter().enumerate().map(one).sum())
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        for (element, k) in self.stiffness.iter().enumerate() {
            let (nodes, along) = self.stretch.element(element);
            let fibre = self.stretch.fibre(element, at.positions);
            let across = 0.5 * (dot(fibre, fibre) - 1.0);
            let block: Block<D> = from_fn(|i| {
                from_fn(|j| k * (f64::from(u8::from(i == j)) * across + fibre[i] * fibre[j]))
            });
            for i in 0..N {
                for j in i..N {
                    let block = block.map(|row| row.map(|value| value * along[i] * along[j]));
                    stiffness.add(nodes[i] as usize, nodes[j] as usize, block);
                }
            }
        }
        true
    }

    fn is_internal(&self) -> bool {
        true
    }
}
