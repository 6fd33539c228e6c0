//! Resistance to a change of volume: the energy of the [area law](super::area), with any number of axes.
//!
//! A group of simplices of weights `w` has the measure (area or volume) `V = sum w_i V_i`, at rest
//! `V0`:
//!
//! ```text
//! E = (kappa/2) (V - V0)^2 / V0          f_a = -kappa (V - V0)/V0 dV/dx_a
//! ```
//!
//! With one triangle or tetrahedron per group, this is the area law. But if each tetrahedron keeps
//! its volume, the mesh locks: when nearly incompressible, it hardly bends. With the ten tetrahedra
//! of a cube per group ([`crate::mesh::bar`]), each cube keeps its volume as a whole and can bend.

use super::force::{Configuration, Force};
use super::stiffness::StiffnessMatrix;
use super::vectors::Vectors;
use crate::mesh::{Mesh, simplex};
use std::array::from_fn;
use std::ops::Range;

/// Volume preservation of groups of simplices.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumePreservation<const D: usize = 3, const N: usize = 4> {
    nodes: Vec<[u32; N]>,
    weights: Vec<f64>,
    groups: Vec<Group>,
    /// kappa, kPa; nN/um for a flat mesh.
    stiffness: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Group {
    simplices: Range<usize>,
    /// Resting measure, um^3 or um^2.
    rest: f64,
}

impl<const D: usize, const N: usize> VolumePreservation<D, N> {
    /// The law with one stiffness kappa, kPa (for a flat mesh nN/um, kPa times thickness), on
    /// groups of `group` consecutive simplices.
    ///
    /// # Panics
    /// If the simplices do not form complete groups.
    pub fn new(mesh: &Mesh<D, N>, group: usize, stiffness: f64) -> Self {
        let count = mesh.simplices.len();
        assert!(group > 0 && count.is_multiple_of(group), "{count} simplices in groups of {group}");
        let nodes = mesh.simplices.iter().map(|simplex| simplex.nodes).collect();
        let weights = mesh.simplices.iter().map(|simplex| simplex.weight).collect();
        let mut law = Self { nodes, weights, groups: Vec::new(), stiffness };
        law.groups = (0..count)
            .step_by(group)
            .map(|first| first..first + group)
            .map(|simplices| Group { rest: law.content(&simplices, &mesh.points), simplices })
            .collect();
        law
    }

    fn corners(&self, simplex: usize, positions: &Vectors<D>) -> [[f64; D]; N] {
        self.nodes[simplex].map(|node| from_fn(|axis| positions[axis][node as usize]))
    }

    fn content(&self, simplices: &Range<usize>, positions: &Vectors<D>) -> f64 {
        let one = |k: usize| self.weights[k] * simplex::measure_at(positions, self.nodes[k]);
        simplices.clone().map(one).sum()
    }

    /// Derivative of a group's measure with respect to its nodes, each node once.
    fn gradients(&self, group: &Group, positions: &Vectors<D>) -> Vec<(usize, [f64; D])> {
        let mut gradients: Vec<(usize, [f64; D])> = Vec::new();
        for k in group.simplices.clone() {
            let parts = simplex::measure_gradients(&self.corners(k, positions));
            for (node, part) in self.nodes[k].iter().zip(parts) {
                let node = *node as usize;
                let at = gradients.iter().position(|(other, _)| *other == node);
                let at = at.unwrap_or_else(|| {
                    gradients.push((node, [0.0; D]));
                    gradients.len() - 1
                });
                for axis in 0..D {
                    gradients[at].1[axis] += self.weights[k] * part[axis];
                }
            }
        }
        gradients
    }

    /// Adds `scale d2V/(dx_a dx_b)` of a simplex: its measure is linear in each corner, so the
    /// derivative of the gradient at one corner is its change when another moves by one.
    fn add_curvature(
        &self,
        k: usize,
        scale: f64,
        positions: &Vectors<D>,
        stiffness: &mut StiffnessMatrix<D>,
    ) {
        let corners = self.corners(k, positions);
        let base = simplex::measure_gradients(&corners);
        for b in 0..N {
            for j in 0..D {
                let mut moved = corners;
                moved[b][j] += 1.0;
                let there = simplex::measure_gradients(&moved);
                for a in 0..b {
                    let mut block = [[0.0; D]; D];
                    for i in 0..D {
                        block[i][j] = scale * self.weights[k] * (there[a][i] - base[a][i]);
                    }
                    stiffness.add(self.nodes[k][a] as usize, self.nodes[k][b] as usize, block);
                }
            }
        }
    }
}

impl<const D: usize, const N: usize> Force<D> for VolumePreservation<D, N> {
    fn name(&self) -> &'static str {
        "volume preservation"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for group in &self.groups {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            let scale = self.stiffness * deviation / group.rest;
            for (node, gradient) in self.gradients(group, at.positions) {
                for axis in 0..D {
                    forces[axis][node] -= scale * gradient[axis];
                }
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let one = |group: &Group| {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            0.5 * self.stiffness * deviation * deviation / group.rest
        };
        Some(self.groups.iter().map(one).sum())
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        for group in &self.groups {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            let scale = self.stiffness / group.rest;
            // (kappa/V0) (dV (x) dV + (V - V0) d2V)
            let gradients = self.gradients(group, at.positions);
            for (k, (a, from)) in gradients.iter().enumerate() {
                for (b, to) in &gradients[k..] {
                    let block = from_fn(|i| from_fn(|j| scale * from[i] * to[j]));
                    stiffness.add(*a, *b, block);
                }
            }
            for k in group.simplices.clone() {
                self.add_curvature(k, scale * deviation, at.positions, stiffness);
            }
        }
        true
    }

    fn is_internal(&self) -> bool {
        true
    }
}
