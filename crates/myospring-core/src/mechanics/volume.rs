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
use super::lattice_law::LatticeLaw;
use super::runs::vectorised;
use super::stiffness::{Block, StiffnessMatrix};
use super::vectors::Vectors;
use crate::mesh::Mesh;
use crate::mesh::simplex::{self, Real};
use std::array::from_fn;
use std::ops::{Add, Mul, Range, Sub};

/// Volume preservation of groups of simplices.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumePreservation<const D: usize = 3, const N: usize = 4> {
    nodes: Vec<[u32; N]>,
    weights: Vec<f64>,
    forms: Vec<Form<N>>,
    groups: Vec<Group>,
    /// Resting measure of each group, um^3 or um^2.
    rest: Vec<f64>,
    /// kappa, kPa; nN/um for a flat mesh.
    stiffness: f64,
}

/// How the simplices of a group lie: that of most groups is the same.
#[derive(Debug, Clone, PartialEq)]
struct Form<const N: usize> {
    weights: Vec<f64>,
    /// The places of the corners of each simplex among the group's nodes.
    corners: Vec<[u8; N]>,
}

#[derive(Debug, Clone, PartialEq)]
struct Group {
    simplices: Range<usize>,
    /// Which form it has.
    form: usize,
    /// Its nodes, each once.
    nodes: Vec<u32>,
}

impl<const D: usize, const N: usize> VolumePreservation<D, N> {
    /// The law with one stiffness kappa, kPa (for a flat mesh nN/um, kPa times thickness), on
    /// groups of `group` consecutive simplices.
    ///
    /// # Panics
    /// If the simplices do not form complete groups, or a group has more than 256 nodes.
    pub fn new(mesh: &Mesh<D, N>, group: usize, stiffness: f64) -> Self {
        let count = mesh.simplices.len();
        assert!(group > 0 && count.is_multiple_of(group), "{count} simplices in groups of {group}");
        let nodes: Vec<[u32; N]> = mesh.simplices.iter().map(|simplex| simplex.nodes).collect();
        let weights = mesh.simplices.iter().map(|simplex| simplex.weight).collect();
        let (forms, groups, rest) = (Vec::new(), Vec::new(), Vec::new());
        let mut law = Self { nodes, weights, forms, groups, rest, stiffness };
        for first in (0..count).step_by(group) {
            let (group, rest) = law.group(first..first + group, &mesh.points);
            law.groups.push(group);
            law.rest.push(rest);
        }
        law
    }

    /// A group and its resting measure.
    fn group(&mut self, simplices: Range<usize>, points: &Vectors<D>) -> (Group, f64) {
        let mut nodes: Vec<u32> = Vec::new();
        let mut place = |node: u32| {
            let place = nodes.iter().position(|other| *other == node).unwrap_or_else(|| {
                nodes.push(node);
                nodes.len() - 1
            });
            u8::try_from(place).unwrap_or_else(|_| panic!("a group of more than 256 nodes"))
        };
        let corners = simplices.clone().map(|k| self.nodes[k].map(&mut place)).collect();
        let form = Form { weights: self.weights[simplices.clone()].to_vec(), corners };
        let place = |&node: &u32| from_fn(|axis| points[axis][node as usize]);
        let places: Vec<[f64; D]> = nodes.iter().map(place).collect();
        // As the forces have it, so that there are none at rest.
        let rest = form.gradients(&places, &mut Vec::new());
        let known = self.forms.iter().rposition(|other| *other == form);
        let form = known.unwrap_or_else(|| {
            self.forms.push(form);
            self.forms.len() - 1
        });
        (Group { simplices, form, nodes }, rest)
    }

    fn content(&self, simplices: &Range<usize>, positions: &Vectors<D>) -> f64 {
        let one = |k: usize| self.weights[k] * simplex::measure_at(positions, self.nodes[k]);
        simplices.clone().map(one).sum()
    }
}

impl<const D: usize, const N: usize> VolumePreservation<D, N> {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn add(&self, positions: &Vectors<D>, forces: &mut Vectors<D>) {
        let (mut points, mut gradients) = (Vec::new(), Vec::new());
        let alike = self.groups.chunk_by(|a, b| a.form == b.form);
        let mut rests = self.rest.iter();
        for groups in alike.flat_map(|groups| groups.chunks(LANES)) {
            let first = &groups[0];
            points.clear();
            points.resize(first.nodes.len(), [Lanes::default(); D]);
            for lane in 0..LANES {
                // Lanes that are left over repeat the first group.
                let group = groups.get(lane).unwrap_or(first);
                for (point, &node) in points.iter_mut().zip(&group.nodes) {
                    for axis in 0..D {
                        point[axis].0[lane] = positions[axis][node as usize];
                    }
                }
            }
            let Lanes(measures) = self.forms[first.form].gradients(&points, &mut gradients);
            for (lane, (group, rest)) in groups.iter().zip(&mut rests).enumerate() {
                let scale = self.stiffness * (measures[lane] - rest) / rest;
                for (&node, gradient) in group.nodes.iter().zip(&gradients) {
                    for axis in 0..D {
                        forces[axis][node as usize] -= scale * gradient[axis].0[lane];
                    }
                }
            }
        }
    }
}

impl<const N: usize> Form<N> {
    /// The measure of a group, and in `gradients` its derivative with respect to its nodes, in their order.
    ///
    /// A measure is homogeneous of degree D, so it follows from its derivatives: `V = sum x_a . dV/dx_a / D` (Euler).
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn gradients<T: Real, const D: usize>(
        &self,
        points: &[[T; D]],
        gradients: &mut Vec<[T; D]>,
    ) -> T {
        gradients.clear();
        gradients.resize(points.len(), [T::default(); D]);
        for (&weight, corners) in self.weights.iter().zip(&self.corners) {
            let at: [&[T; D]; N] = from_fn(|k| &points[usize::from(corners[k])]);
            let parts = simplex::gradients_of(at);
            for (&corner, part) in corners.iter().zip(parts) {
                let sum = &mut gradients[usize::from(corner)];
                for axis in 0..D {
                    sum[axis] = sum[axis] + part[axis] * weight;
                }
            }
        }
        let mut sum = T::default();
        for (point, gradient) in points.iter().zip(&*gradients) {
            for axis in 0..D {
                sum = sum + (point[axis] - points[0][axis]) * gradient[axis];
            }
        }
        sum * (1.0 / D as f64)
    }
}

/// Groups that are pulled at once, with vector units.
const LANES: usize = 8;

/// One number of each of these groups.
#[derive(Debug, Clone, Copy, Default)]
struct Lanes([f64; LANES]);

impl Lanes {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let mut lanes = self.0;
        for (lane, other) in lanes.iter_mut().zip(other.0) {
            *lane = of(*lane, other);
        }
        Self(lanes)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
    fn mul(self, by: f64) -> Self {
        self.with(Self([by; LANES]), |a, b| a * b)
    }
}

impl<const D: usize, const N: usize> Force<D> for VolumePreservation<D, N> {
    fn name(&self) -> &'static str {
        "volume preservation"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        vectorised(
            #[inline(always)]
            || self.add(at.positions, forces),
        );
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let one = |(group, rest): (&Group, &f64)| {
            let deviation = self.content(&group.simplices, at.positions) - rest;
            0.5 * self.stiffness * deviation * deviation / rest
        };
        Some(self.groups.iter().zip(&self.rest).map(one).sum())
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        let mut points: Vec<[f64; D]> = Vec::new();
        let (mut gradients, mut blocks) = (Vec::new(), Vec::<Block<D>>::new());
        for (group, rest) in self.groups.iter().zip(&self.rest) {
            let form = &self.forms[group.form];
            let place = |&node: &u32| from_fn(|axis| at.positions[axis][node as usize]);
            points.clear();
            points.extend(group.nodes.iter().map(place));
            // (kappa/V0) (dV (x) dV + (V - V0) d2V)
            let deviation = form.gradients(&points, &mut gradients) - rest;
            let scale = self.stiffness / rest;
            let count = group.nodes.len();
            let one = |at: usize| -> Block<D> {
                let (from, to) = (&gradients[at / count], &gradients[at % count]);
                from_fn(|i| from_fn(|j| scale * from[i] * to[j]))
            };
            blocks.clear();
            blocks.extend((0..count * count).map(one));
            for (weight, corners) in form.weights.iter().zip(&form.corners) {
                let corners = corners.map(usize::from);
                let scale = scale * deviation * weight;
                let of = simplex::measure_curvature(&corners.map(|corner| points[corner]));
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

    fn on_lattice(&self) -> Option<LatticeLaw<'_, D>> {
        Some(LatticeLaw::Volumes {
            corners: self.nodes.as_flattened(),
            weights: &self.weights,
            stiffness: self.stiffness,
            rest: &self.rest,
        })
    }

    fn is_internal(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::{Body, zeros};
    use crate::mesh::cubes;

    #[test]
    fn groups_that_are_pulled_at_once_have_the_forces_of_each_alone_to_the_last_bit() {
        // Fewer than the lanes, as many, one left over, and several rows of them.
        for count in [3, 8, 9, 40] {
            let mesh = cubes::block([count, 1, 1], 2.0).unwrap();
            let law = VolumePreservation::new(&mesh, cubes::TETRAHEDRA_OF_A_CUBE, 700.0);
            let mut body = Body::at_rest(&mesh, 1.0, 1.0);
            for (k, x) in body.positions.iter_mut().flatten().enumerate() {
                *x += 0.3 * (1.7 * k as f64).sin();
            }
            let mut at_once = zeros::<3>(mesh.len());
            law.add_forces(&body.configuration(0.0), &mut at_once);
            let (mut alone, mut gradients) = (zeros::<3>(mesh.len()), Vec::new());
            for (group, rest) in law.groups.iter().zip(&law.rest) {
                let place = |&node: &u32| from_fn(|axis| body.positions[axis][node as usize]);
                let points: Vec<[f64; 3]> = group.nodes.iter().map(place).collect();
                let measure = law.forms[group.form].gradients(&points, &mut gradients);
                let scale = law.stiffness * (measure - rest) / rest;
                for (&node, gradient) in group.nodes.iter().zip(&gradients) {
                    for axis in 0..3 {
                        alone[axis][node as usize] -= scale * gradient[axis];
                    }
                }
            }
            assert_eq!(at_once, alone, "{count} cubes");
            assert!(at_once.iter().flatten().any(|force| force.abs() > 1.0));
        }
    }
}
