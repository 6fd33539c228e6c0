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
//! of a cube per group ([`crate::mesh::cubes`]), each cube keeps its volume as a whole and can bend.

use super::force::{Configuration, Force};
use super::stiffness::{Block, StiffnessMatrix};
use super::vectors::Vectors;
use crate::mesh::{Mesh, simplex};
use std::array::from_fn;
use std::ops::Range;

/// Volume preservation of groups of simplices.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumePreservation<const D: usize = 3, const N: usize = 4> {
    nodes: Vec<[u32; N]>,
    weights: Vec<f64>,
    groups: Vec<Group<N>>,
    /// kappa, kPa; nN/um for a flat mesh.
    stiffness: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Group<const N: usize> {
    simplices: Range<usize>,
    /// Its nodes, each once, and the places among them of the corners of each simplex.
    nodes: Vec<u32>,
    corners: Vec<[usize; N]>,
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
        let nodes: Vec<[u32; N]> = mesh.simplices.iter().map(|simplex| simplex.nodes).collect();
        let weights = mesh.simplices.iter().map(|simplex| simplex.weight).collect();
        let mut law = Self { groups: Vec::new(), nodes, weights, stiffness };
        let firsts = (0..count).step_by(group);
        law.groups = firsts.map(|first| law.group(first..first + group, &mesh.points)).collect();
        law
    }

    fn group(&self, simplices: Range<usize>, points: &Vectors<D>) -> Group<N> {
        let mut nodes: Vec<u32> = Vec::new();
        let mut place = |node: u32| {
            nodes.iter().position(|other| *other == node).unwrap_or_else(|| {
                nodes.push(node);
                nodes.len() - 1
            })
        };
        let corners = simplices.clone().map(|k| self.nodes[k].map(&mut place)).collect();
        Group { rest: self.content(&simplices, points), simplices, nodes, corners }
    }

    fn content(&self, simplices: &Range<usize>, positions: &Vectors<D>) -> f64 {
        let one = |k: usize| self.weights[k] * simplex::measure_at(positions, self.nodes[k]);
        simplices.clone().map(one).sum()
    }

    fn corners(&self, simplex: usize, positions: &Vectors<D>) -> [[f64; D]; N] {
        self.nodes[simplex].map(|node| from_fn(|axis| positions[axis][node as usize]))
    }

    /// Derivative of a group's measure with respect to its nodes, in their order.
    fn gradients(&self, group: &Group<N>, positions: &Vectors<D>, gradients: &mut Vec<[f64; D]>) {
        gradients.clear();
        gradients.resize(group.nodes.len(), [0.0; D]);
        for (k, corners) in group.simplices.clone().zip(&group.corners) {
            let parts = simplex::measure_gradients(&self.corners(k, positions));
            for (&corner, part) in corners.iter().zip(parts) {
                for axis in 0..D {
                    gradients[corner][axis] += self.weights[k] * part[axis];
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
        let mut gradients = Vec::new();
        for group in &self.groups {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            let scale = self.stiffness * deviation / group.rest;
            self.gradients(group, at.positions, &mut gradients);
            for (&node, gradient) in group.nodes.iter().zip(&gradients) {
                for axis in 0..D {
                    forces[axis][node as usize] -= scale * gradient[axis];
                }
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let one = |group: &Group<N>| {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            0.5 * self.stiffness * deviation * deviation / group.rest
        };
        Some(self.groups.iter().map(one).sum())
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        let mut gradients = Vec::new();
        let mut blocks: Vec<Block<D>> = Vec::new();
        for group in &self.groups {
            let deviation = self.content(&group.simplices, at.positions) - group.rest;
            let scale = self.stiffness / group.rest;
            // (kappa/V0) (dV (x) dV + (V - V0) d2V)
            self.gradients(group, at.positions, &mut gradients);
            let count = group.nodes.len();
            let one = |at: usize| -> Block<D> {
                let (from, to) = (&gradients[at / count], &gradients[at % count]);
                from_fn(|i| from_fn(|j| scale * from[i] * to[j]))
            };
            blocks.clear();
            blocks.extend((0..count * count).map(one));
            for (k, corners) in group.simplices.clone().zip(&group.corners) {
                let scale = scale * deviation * self.weights[k];
                let of = simplex::measure_curvature(&self.corners(k, at.positions));
                for a in 0..N {
                    for b in 0..N {
                        let block = &mut blocks[corners[a] * count + corners[b]];
                        for i in 0..D {
                            for j in 0..D {
                                block[i][j] += scale * of[a][b][i][j];
                            }
                        }
                    }
                }
            }
            for a in 0..count {
                for b in a..count {
                    let [from, to] = [a, b].map(|place| group.nodes[place] as usize);
                    stiffness.add(from, to, blocks[a * count + b]);
                }
            }
        }
        true
    }

    fn is_internal(&self) -> bool {
        true
    }
}
