//! Active force: what the tension of the myofilaments does to the mesh.
//!
//! - [`FibreTension`] (default): the first Piola-Kirchhoff stress `P = Ta F f0 (x) f0` in each
//!   triangle gives the nodal forces `f_i = -V0 P grad N_i`, with the deformation gradient `F`, the
//!   resting fibre direction `f0` and the resting volume `V0 = w A0 thickness`. It is internal: no
//!   resultant force, no torque, whatever the fibre field. At fixed tension it is minus the
//!   gradient of `E = (Ta/2) sum V0 |F f0|^2`.
//! - [`EndTension`] (the paper's): the load `Ta thickness` per unit of end edge, along the long axis,
//!   on the two end faces. External; a shortened cell turns under it unless its rotation is held.
//!
//! On a bar with a uniform fibre along x the two agree up to the fibre's stretch `lambda`: the
//! resultant of the fibre law on a cross-section is `Ta lambda`, that of the end load `Ta`.
//!
//! Because `F` is linear in the positions, `f = -Ta K x` with a constant, sparse, symmetric matrix
//! `K_ij = sum V0 (grad N_i . f0)(grad N_j . f0)` whose rows sum to zero. It lives on the edges of
//! the triangles: on each edge a weight, as cheap as a spring without its square root.

use super::runs::{self, LONGEST, Run, vectorised};
use super::stencil::LatticeTerms;
use super::stiffness::StiffnessMatrix;
use super::{Configuration, Force, Vectors};
use crate::mesh::Mesh;
use serde::Serialize;
use std::collections::HashMap;

/// Which law carries the active tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActiveLaw {
    /// Stress along the fibre in each triangle; internal.
    Fibre,
    /// The paper's load on the end nodes along the long axis; external.
    Ends,
}

/// Active tension along a fibre field.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreTension {
    edges: Vec<[u32; 2]>,
    /// Minus the matrix element `K_ij` of each edge, um.
    weights: Vec<f64>,
    runs: Vec<Run<2>>,
}

impl FibreTension {
    /// Fibres in the unit directions `fibres`, one per triangle of the mesh; thickness in um.
    ///
    /// # Panics
    /// If there is not one direction per triangle.
    pub fn new(mesh: &Mesh, fibres: &[[f64; 2]], thickness: f64) -> Self {
        assert_eq!(fibres.len(), mesh.simplices.len(), "one fibre direction per triangle");
        let mut edges: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
        let mut index: HashMap<[u32; 2], usize> =
            edges.iter().enumerate().map(|(edge, &[a, b])| ([a.min(b), a.max(b)], edge)).collect();
        let mut weights = vec![0.0; edges.len()];
        for (simplex, fibre) in mesh.simplices.iter().zip(fibres) {
            let (area, gradients) = shape_gradients(&mesh.points, simplex.nodes);
            let volume = simplex.weight * area * thickness;
            let along = gradients.map(|gradient| gradient[0] * fibre[0] + gradient[1] * fibre[1]);
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (simplex.nodes[i], simplex.nodes[j]);
                let edge = *index.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    edges.push([a, b]);
                    weights.push(0.0);
                    edges.len() - 1
                });
                weights[edge] -= volume * along[i] * along[j];
            }
        }
        let runs = runs::find(&edges);
        Self { edges, weights, runs }
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn add(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        let mut buffer = [0.0; LONGEST];
        for &Run { nodes: [a, b], first, len } in &self.runs {
            let weights = &self.weights[first..first + len];
            let buffer = &mut buffer[..len];
            for (position, force) in at.positions.iter().zip(forces.iter_mut()) {
                let (from, to) = (&position[a..a + len], &position[b..b + len]);
                for k in 0..len {
                    buffer[k] = at.tension * weights[k] * (to[k] - from[k]);
                }
                runs::add(force, a, buffer);
                runs::subtract(force, b, buffer);
            }
        }
    }

    /// The same fibre direction everywhere: a unit vector.
    pub fn uniform(mesh: &Mesh, fibre: [f64; 2], thickness: f64) -> Self {
        Self::new(mesh, &vec![fibre; mesh.simplices.len()], thickness)
    }
}

/// Area of a triangle and the gradients of its three linear shape functions, 1/um.
fn shape_gradients(points: &Vectors, nodes: [u32; 3]) -> (f64, [[f64; 2]; 3]) {
    let corners = nodes.map(|node| [points[0][node as usize], points[1][node as usize]]);
    let area = super::area::signed_area(points, nodes);
    let gradient = |i: usize| {
        let (next, last) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        [(next[1] - last[1]) / (2.0 * area), (last[0] - next[0]) / (2.0 * area)]
    };
    (area, [gradient(0), gradient(1), gradient(2)])
}

impl Force for FibreTension {
    fn name(&self) -> &'static str {
        "fibre tension"
    }

    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        vectorised(
            #[inline(always)]
            || self.add(at, forces),
        );
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        // (Ta/2) x.K x = (Ta/2) sum over edges of -K_ij |x_i - x_j|^2
        let [x, y] = at.positions;
        let mut total = 0.0;
        vectorised(
            #[inline(always)]
            || {
                let mut buffer = [0.0; LONGEST];
                for &Run { nodes: [a, b], first, len } in &self.runs {
                    let weights = &self.weights[first..first + len];
                    let (xa, xb) = (&x[a..a + len], &x[b..b + len]);
                    let (ya, yb) = (&y[a..a + len], &y[b..b + len]);
                    let values = &mut buffer[..len];
                    for (k, value) in values.iter_mut().enumerate() {
                        let (dx, dy) = (xb[k] - xa[k], yb[k] - ya[k]);
                        *value = weights[k] * (dx * dx + dy * dy);
                    }
                    total += runs::sum(values);
                }
            },
        );
        Some(0.5 * at.tension * total)
    }

    fn add_stiffness(&self, at: &Configuration<'_>, stiffness: &mut StiffnessMatrix) -> bool {
        for (nodes, weight) in self.edges.iter().zip(&self.weights) {
            let [a, b] = nodes.map(|node| node as usize);
            // f = -Ta K x
            let value = at.tension * weight;
            stiffness.add_pair(a, b, [[value, 0.0], [0.0, value]]);
        }
        true
    }

    fn add_to_lattice(&self, terms: &mut LatticeTerms) -> bool {
        self.edges
            .iter()
            .zip(&self.weights)
            .all(|(&nodes, &weight)| terms.add_tension(nodes, weight))
    }

    fn is_internal(&self) -> bool {
        true
    }
}

/// The paper's active force: a load on the end nodes along a fixed axis.
#[derive(Debug, Clone, PartialEq)]
pub struct EndTension {
    axis: [f64; 2],
    /// Nodes and their load per unit of tension, um^2; positive along the axis.
    loads: Vec<(usize, f64)>,
}

impl EndTension {
    /// Loads both ends of the cell along the unit vector `axis`; thickness in um.
    ///
    /// The rim edges that face an end within the outer tenth of the length carry `Ta thickness`
    /// times their length across the axis, shared by their two nodes, so the resultant on an end
    /// is the tension times the area of its cross-section.
    pub fn new(mesh: &Mesh, axis: [f64; 2], thickness: f64) -> Self {
        let count = mesh.areas.len();
        let along: Vec<f64> =
            (0..count).map(|i| mesh.points[0][i] * axis[0] + mesh.points[1][i] * axis[1]).collect();
        let lowest = along.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let zone = 0.1 * (highest - lowest);
        let mut load = vec![0.0; count];
        for [a, b] in rim_edges(mesh) {
            // The cell lies on the left of the edge a -> b, so (dy, -dx) points outward.
            let edge = [0, 1].map(|k| mesh.points[k][b] - mesh.points[k][a]);
            let outward = edge[1] * axis[0] - edge[0] * axis[1];
            let middle = 0.5 * (along[a] + along[b]);
            let faces_end = (outward < 0.0 && middle <= lowest + zone)
                || (outward > 0.0 && middle >= highest - zone);
            if faces_end {
                load[a] -= 0.5 * thickness * outward;
                load[b] -= 0.5 * thickness * outward;
            }
        }
        // Where steps make one end wider than the other inside its tenth, scale the smaller up:
        // the pair must have no resultant.
        let pull: f64 = load.iter().filter(|value| **value > 0.0).sum();
        let push: f64 = -load.iter().filter(|value| **value < 0.0).sum::<f64>();
        let total = pull.max(push);
        let loads = load
            .into_iter()
            .enumerate()
            .filter(|(_, value)| *value != 0.0)
            .map(|(node, value)| (node, value * total / if value > 0.0 { pull } else { push }))
            .collect();
        Self { axis, loads }
    }
}

/// Edges of triangles with a square on one side only, the cell on their left.
fn rim_edges(mesh: &Mesh) -> Vec<[usize; 2]> {
    let mut weight: HashMap<[u32; 2], f64> = HashMap::new();
    for simplex in &mesh.simplices {
        for k in 0..3 {
            let (a, b) = (simplex.nodes[k], simplex.nodes[(k + 1) % 3]);
            *weight.entry([a, b]).or_default() += simplex.weight;
            *weight.entry([b, a]).or_default() -= simplex.weight;
        }
    }
    let mut edges: Vec<[usize; 2]> = weight
        .into_iter()
        .filter(|(_, weight)| *weight > 0.25)
        .map(|(nodes, _)| nodes.map(|node| node as usize))
        .collect();
    edges.sort_unstable();
    edges
}

impl Force for EndTension {
    fn name(&self) -> &'static str {
        "end tension"
    }

    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        for &(node, load) in &self.loads {
            for axis in 0..2 {
                forces[axis][node] += at.tension * load * self.axis[axis];
            }
        }
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        let one = |&(node, load): &(usize, f64)| {
            load * (0..2).map(|axis| at.positions[axis][node] * self.axis[axis]).sum::<f64>()
        };
        Some(-at.tension * self.loads.iter().map(one).sum::<f64>())
    }

    fn is_internal(&self) -> bool {
        false
    }
}
