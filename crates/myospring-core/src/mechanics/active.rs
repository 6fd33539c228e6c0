//! Active forces: the effect of the myofilaments' tension on the mesh.
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
//! `K_ij = sum V0 (grad N_i . f0)(grad N_j . f0)` whose rows sum to zero. Its elements belong to
//! the edges of the triangles: each edge has a weight, which is as cheap as a spring without square
//! root.
//!
//! A triangle with the relative content c of myofibrils carries `c Ta`, as if it had c times its
//! volume. If the tension is not uniform ([`Tension::PerElement`]), the sum runs over the
//! triangles: `f_i = -V0 Ta a (grad N_i . f0)` with `a = F f0 = sum x_i (grad N_i . f0)`, whose
//! length is the stretch. If it depends on the triangle's stretch and rate
//! ([`Tension::Following`]), `E = sum V0 int Ta stretch d(stretch)` at rest, and motion dissipates
//! the power `sum V0 c rate^2 stretch`, c the derivative of the tension with respect to the rate.

use super::force::{Configuration, Force};
use super::lattice_law::LatticeLaw;
use super::runs::{self, LONGEST, Run, vectorised};
use super::stiffness::{Block, StiffnessMatrix};
use super::tension::Tension;
use super::vectors::{Vectors, dot};
use crate::mesh::{Mesh, simplex};
use serde::Serialize;
use std::array::from_fn;
use std::collections::HashMap;

/// The law of the active tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActiveLaw {
    /// Stress along the fibre in each triangle; internal.
    Fibre,
    /// The paper's load on the end nodes along the long axis; external.
    Ends,
}

/// Directions and content of the myofibrils of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Myofibrils<'a, const D: usize = 2> {
    /// Their direction in each triangle, unit vectors.
    pub directions: &'a [[f64; D]],
    /// Their content in each triangle relative to that of the cell, dimensionless; `None` is 1
    /// everywhere.
    pub content: Option<&'a [f64]>,
}

impl<'a, const D: usize> From<&'a [[f64; D]]> for Myofibrils<'a, D> {
    fn from(directions: &'a [[f64; D]]) -> Self {
        Self { directions, content: None }
    }
}

impl<'a, const D: usize> From<&'a Vec<[f64; D]>> for Myofibrils<'a, D> {
    fn from(directions: &'a Vec<[f64; D]>) -> Self {
        Self { directions, content: None }
    }
}

/// Reads the stretch of each triangle of a mesh along its fibre.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreStretch<const D: usize = 2, const N: usize = 3> {
    nodes: Vec<[u32; N]>,
    /// `grad N_i . f0`, 1/um.
    along: Vec<[f64; N]>,
}

impl<const D: usize, const N: usize> FibreStretch<D, N> {
    /// A meter for fibres in these unit directions, one per triangle.
    ///
    /// # Panics
    /// If there is not one direction per triangle.
    ///
    /// # Example
    /// ```
    /// use myospring::mechanics::active::FibreStretch;
    /// use myospring::mesh::lattice;
    /// let strip = lattice::rectangle(2, 1, 1.0)?;
    /// let meter = FibreStretch::new(&strip, &vec![[1.0, 0.0]; 8]);
    /// let shorter = [strip.points[0].iter().map(|x| 0.9 * x).collect(), strip.points[1].clone()];
    /// assert!(meter.stretches(&shorter).iter().all(|stretch| (stretch - 0.9).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(mesh: &Mesh<D, N>, directions: &[[f64; D]]) -> Self {
        assert_eq!(directions.len(), mesh.simplices.len(), "one fibre direction per triangle");
        let nodes: Vec<[u32; N]> = mesh.simplices.iter().map(|simplex| simplex.nodes).collect();
        let along = nodes.iter().zip(directions).map(|(nodes, fibre)| {
            let corners = nodes.map(|node| mesh.point(node as usize));
            let content = simplex::measure(&corners);
            simplex::measure_gradients(&corners).map(|gradient| {
                let parts = gradient.iter().zip(fibre).map(|(g, f)| g / content * f);
                parts.reduce(|sum, part| sum + part).unwrap_or_default()
            })
        });
        Self { along: along.collect(), nodes }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The corners of a triangle, and `grad N_i . f0` of each, 1/um.
    pub(super) fn element(&self, element: usize) -> ([u32; N], [f64; N]) {
        (self.nodes[element], self.along[element])
    }

    /// The fibre's unit vector, rotated and stretched with the triangle, `F f0`; for velocities,
    /// its rate.
    pub(super) fn fibre(&self, element: usize, vectors: &Vectors<D>) -> [f64; D] {
        let (nodes, along) = (self.nodes[element], self.along[element]);
        let first = nodes[0] as usize;
        from_fn(|axis| {
            let of = &vectors[axis];
            (1..N).map(|i| (of[nodes[i] as usize] - of[first]) * along[i]).sum()
        })
    }

    /// `F f0`, the stretch, and its rate, 1/ms.
    fn read(&self, element: usize, at: &Configuration<'_, D>) -> ([f64; D], f64, f64) {
        let fibre = self.fibre(element, at.positions);
        let stretch = length(fibre);
        let rate = dot(fibre, self.fibre(element, at.velocities)) / stretch;
        (fibre, stretch, rate)
    }

    /// Stretch of each triangle along its fibre, length over resting length.
    pub fn stretches(&self, positions: &Vectors<D>) -> Vec<f64> {
        (0..self.len()).map(|element| length(self.fibre(element, positions))).collect()
    }

    /// Rate of that stretch, 1/ms.
    pub fn rates(&self, positions: &Vectors<D>, velocities: &Vectors<D>) -> Vec<f64> {
        let at = Configuration { positions, velocities, tension: 0.0.into() };
        (0..self.len()).map(|element| self.read(element, &at).2).collect()
    }
}

/// Active tension along a fibre field.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreTension<const D: usize = 2, const N: usize = 3> {
    edges: Vec<[u32; 2]>,
    /// Minus the matrix element `K_ij` of each edge, um.
    weights: Vec<f64>,
    runs: Vec<Run<2>>,
    stretch: FibreStretch<D, N>,
    /// Resting volume of each triangle times its content of myofibrils, um^3.
    volumes: Vec<f64>,
}

impl<const D: usize, const N: usize> FibreTension<D, N> {
    /// The law for myofibrils of a mesh, or unit vectors, one per triangle; thickness in um, 1 with
    /// three axes.
    ///
    /// # Panics
    /// If there is not one direction, or, if contents are given, one content per triangle.
    pub fn new<'a>(
        mesh: &Mesh<D, N>,
        myofibrils: impl Into<Myofibrils<'a, D>>,
        thickness: f64,
    ) -> Self {
        let Myofibrils { directions, content } = myofibrils.into();
        let stretch = FibreStretch::new(mesh, directions);
        let content = content.unwrap_or(&[]);
        assert!(
            content.is_empty() || content.len() == mesh.simplices.len(),
            "one content of myofibrils per triangle"
        );
        let mut edges: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
        let mut index: HashMap<[u32; 2], usize> =
            edges.iter().enumerate().map(|(edge, &[a, b])| ([a.min(b), a.max(b)], edge)).collect();
        let mut weights = vec![0.0; edges.len()];
        let mut volumes = Vec::with_capacity(mesh.simplices.len());
        for (element, simplex) in mesh.simplices.iter().enumerate() {
            let area = simplex::measure_at(&mesh.points, simplex.nodes);
            let content = content.get(element).copied().unwrap_or(1.0);
            let volume = simplex.weight * area * thickness * content;
            let along = stretch.along[element];
            for i in 0..N {
                for j in i + 1..N {
                    // Around the simplex: the last edge leads from its last corner to its first.
                    let (i, j) = if j - i == N - 1 { (j, i) } else { (i, j) };
                    let (a, b) = (simplex.nodes[i], simplex.nodes[j]);
                    let edge = *index.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        edges.push([a, b]);
                        weights.push(0.0);
                        edges.len() - 1
                    });
                    weights[edge] -= volume * along[i] * along[j];
                }
            }
            volumes.push(volume);
        }
        let runs = runs::find(&edges);
        Self { edges, weights, runs, stretch, volumes }
    }

    /// The same fibre direction everywhere: a unit vector.
    pub fn uniform(mesh: &Mesh<D, N>, fibre: [f64; D], thickness: f64) -> Self {
        Self::new(mesh, &vec![fibre; mesh.simplices.len()], thickness)
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn add_uniform(&self, tension: f64, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        let mut buffer = [0.0; LONGEST];
        for &Run { nodes: [a, b], first, len } in &self.runs {
            let weights = &self.weights[first..first + len];
            let buffer = &mut buffer[..len];
            for (position, force) in at.positions.iter().zip(forces.iter_mut()) {
                let (from, to) = (&position[a..a + len], &position[b..b + len]);
                for k in 0..len {
                    buffer[k] = tension * weights[k] * (to[k] - from[k]);
                }
                runs::add(force, a, buffer);
                runs::subtract(force, b, buffer);
            }
        }
    }

    /// Adds forces triangle by triangle, for tensions that are not uniform.
    fn add_by_element(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for (element, volume) in self.volumes.iter().enumerate() {
            let (nodes, along) = (self.stretch.nodes[element], self.stretch.along[element]);
            let (fibre, tension) = match at.tension {
                Tension::Following(law) => {
                    let (fibre, stretch, rate) = self.stretch.read(element, at);
                    (fibre, law.at(element, stretch, rate))
                }
                tension => (self.stretch.fibre(element, at.positions), tension.at(element)),
            };
            let [first, others @ ..] = &nodes[..] else { return };
            for axis in 0..D {
                let load = volume * tension * fibre[axis];
                let force = &mut forces[axis];
                let mut rest = 0.0;
                for (node, along) in others.iter().zip(&along[1..]) {
                    force[*node as usize] -= load * along;
                    rest += load * along;
                }
                force[*first as usize] += rest;
            }
        }
    }

    /// `sum -K_ij |x_i - x_j|^2 / 2` over the edges, fJ per kPa.
    fn energy_per_tension(&self, positions: &Vectors<D>) -> f64 {
        let mut total = 0.0;
        vectorised(
            #[inline(always)]
            || {
                let mut buffer = [0.0; LONGEST];
                for &Run { nodes: [a, b], first, len } in &self.runs {
                    let weights = &self.weights[first..first + len];
                    let [from, to]: [[&[f64]; D]; 2] =
                        [a, b].map(|node| from_fn(|axis| &positions[axis][node..node + len]));
                    let values = &mut buffer[..len];
                    for (k, value) in values.iter_mut().enumerate() {
                        let l: [f64; D] = from_fn(|axis| to[axis][k] - from[axis][k]);
                        *value = weights[k] * dot(l, l);
                    }
                    total += runs::sum(values);
                }
            },
        );
        total
    }

    /// `V0 (Ta (grad N_i . f0)(grad N_j . f0) + dTa/d(stretch) a (x) a / stretch ...)` of one triangle.
    fn add_stiffness_of(
        &self,
        element: usize,
        [tension, slope]: [f64; 2],
        positions: &Vectors<D>,
        stiffness: &mut StiffnessMatrix<D>,
    ) {
        let (nodes, along) = (self.stretch.nodes[element], self.stretch.along[element]);
        let fibre = self.stretch.fibre(element, positions);
        let rise = if slope == 0.0 { 0.0 } else { slope / length(fibre) };
        let volume = self.volumes[element];
        let block: Block<D> = from_fn(|i| {
            from_fn(|j| volume * (f64::from(i == j) * tension + rise * fibre[i] * fibre[j]))
        });
        for i in 0..N {
            for j in i..N {
                let part = along[i] * along[j];
                let block = block.map(|row| row.map(|value| value * part));
                stiffness.add(nodes[i] as usize, nodes[j] as usize, block);
            }
        }
    }
}

fn length<const D: usize>(vector: [f64; D]) -> f64 {
    dot(vector, vector).sqrt()
}

impl<const D: usize, const N: usize> Force<D> for FibreTension<D, N> {
    fn name(&self) -> &'static str {
        "fibre tension"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        match at.tension {
            Tension::Uniform(tension) => vectorised(
                #[inline(always)]
                || self.add_uniform(tension, at, forces),
            ),
            Tension::PerElement(_) | Tension::Following(_) => self.add_by_element(at, forces),
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let elements = 0..self.volumes.len();
        let stretch = |element| length(self.stretch.fibre(element, at.positions));
        Some(match at.tension {
            // (Ta/2) x.K x
            Tension::Uniform(tension) => 0.5 * tension * self.energy_per_tension(at.positions),
            Tension::PerElement(tensions) => {
                elements.map(|e| 0.5 * self.volumes[e] * tensions[e] * stretch(e).powi(2)).sum()
            }
            // Ta = t + k s gives V0 (t s^2/2 + k s^3/3)
            Tension::Following(law) => elements
                .map(|e| {
                    let (slope, s) = (law.per_stretch[e], stretch(e));
                    let base = law.at(e, 0.0, 0.0);
                    self.volumes[e] * (base * s * s / 2.0 + slope * s.powi(3) / 3.0)
                })
                .sum(),
        })
    }

    fn dissipation(&self, at: &Configuration<'_, D>) -> f64 {
        let Tension::Following(law) = at.tension else { return 0.0 };
        let one = |element: usize| {
            let (_, stretch, rate) = self.stretch.read(element, at);
            self.volumes[element] * law.per_rate[element] * rate * rate * stretch
        };
        (0..self.volumes.len()).map(one).sum()
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        match at.tension {
            Tension::Uniform(tension) => {
                for (nodes, weight) in self.edges.iter().zip(&self.weights) {
                    let [a, b] = nodes.map(|node| node as usize);
                    // f = -Ta K x
                    let value = tension * weight;
                    let block = from_fn(|i| from_fn(|j| if i == j { value } else { 0.0 }));
                    stiffness.add_pair(a, b, block);
                }
            }
            Tension::PerElement(tensions) => {
                for (element, tension) in tensions.iter().enumerate() {
                    self.add_stiffness_of(element, [*tension, 0.0], at.positions, stiffness);
                }
            }
            Tension::Following(law) => {
                for element in 0..self.volumes.len() {
                    let stretch = length(self.stretch.fibre(element, at.positions));
                    let tension = [law.at(element, stretch, 0.0), law.per_stretch[element]];
                    self.add_stiffness_of(element, tension, at.positions, stiffness);
                }
            }
        }
        true
    }

    fn on_lattice(&self) -> Option<LatticeLaw<'_, D>> {
        Some(LatticeLaw::Tension { nodes: &self.edges, weights: &self.weights })
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
    /// Loads both ends of the cell along the unit vector `axis`; thickness in um. The law supports
    /// only a uniform tension; with any other, its forces are NaN.
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
        // If steps make one end wider than the other within its tenth, the smaller load is scaled
        // up, because the pair must have no resultant.
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

/// Edges with a square on one side only; the cell is on their left.
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
        let tension = at.tension.uniform().unwrap_or(f64::NAN);
        for &(node, load) in &self.loads {
            for axis in 0..2 {
                forces[axis][node] += tension * load * self.axis[axis];
            }
        }
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        let one = |&(node, load): &(usize, f64)| {
            load * (0..2).map(|axis| at.positions[axis][node] * self.axis[axis]).sum::<f64>()
        };
        Some(-at.tension.uniform()? * self.loads.iter().map(one).sum::<f64>())
    }

    fn is_internal(&self) -> bool {
        false
    }
}
