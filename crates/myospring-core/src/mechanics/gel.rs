//! A gel under the cell: an elastic half-space, or a layer bonded to glass.
//!
//! The flat cell adheres to the surface of the gel and pulls on it within the plane; it neither presses nor lifts. The
//! displacement of the surface under forces `t` of the cell is linear in them, `u = C t` (`green`, `layer`, `wave`), and an adhesion
//! that gives way adds the displacement `t/(k_a A)` of a node of area `A`. The cell's nodes go where the surface goes, so the
//! gel pulls back with
//!
//! ```text
//! f = -t,     (C + 1/(k_a A)) t = x - X          E = t . (x - X) / 2
//! ```
//!
//! The force of each node acts on a square of the lattice's spacing around it. `C` is a Toeplitz matrix then, whose product is
//! a convolution (`convolution`): memory and time of a product go as the number of nodes. The forces are found by conjugate
//! gradients, preconditioned by springs that are like the gel ([`Compliance::likeness`]).

mod conjugate;
mod convolution;
pub mod cytometry;
mod description;
mod green;
mod layer;
pub mod pull;
mod surface;
mod wave;

pub use description::{ADHERING_END, ADHERING_RIM, Adhesion, Gel, GelError};
pub use surface::Surface;

use super::compliance::Compliance;
use super::force::{Configuration, Force};
use super::stiffness::StiffnessMatrix;
use super::vectors::{Vectors, product, zeros};
use crate::mesh::ends::end_zones;
use crate::mesh::{Lattice, Mesh, SpringKind};
use convolution::Convolution;
use green::Green;
use std::array::from_fn;
use std::f64::consts::PI;
use std::sync::{Mutex, PoisonError};

/// Displacements that the forces leave unexplained, as a part of all.
const SOLVED: f64 = 1e-10;
/// Largest number of rounds of conjugate gradients; some 30 are enough.
const ROUNDS: usize = 1000;

/// A node by which a cell lies on a gel, and its area there, um^2.
type Contact = (usize, f64);

impl Adhesion {
    /// Those of the nodes by which a mesh lies on a gel where it adheres; its long axis is the unit vector `axis`.
    fn among<const D: usize, const N: usize>(
        self,
        contacts: Vec<Contact>,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
    ) -> Vec<Contact> {
        let all = contacts.into_iter();
        match self {
            Self::Everywhere => all.collect(),
            Self::Ends => {
                let [[low, _], [_, high]] = end_zones(mesh, axis);
                let depth = ADHERING_END * (high - low);
                let along = |node: usize| {
                    let point = mesh.point(node);
                    point[0] * axis[0] + point[1] * axis[1]
                };
                all.filter(|&(node, _)| !(low + depth..=high - depth).contains(&along(node)))
                    .collect()
            }
            Self::Rim => {
                let rim = rim(mesh, all.as_slice());
                let near = |node: usize| {
                    let point = mesh.point(node);
                    rim.iter().any(|[p, q]| (point[0] - p).hypot(point[1] - q) <= ADHERING_RIM)
                };
                all.filter(|&(node, _)| near(node)).collect()
            }
        }
    }
}

impl Gel {
    /// The nodes of a mesh that adhere, in ascending order, where it adheres to each in proportion to the given number, and the area of
    /// each.
    pub(crate) fn attached<const D: usize, const N: usize>(
        &self,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
        adhesion: Option<&[f64]>,
    ) -> Vec<Contact> {
        let mut nodes = self.adhesion.among(mesh.underside(), mesh, axis);
        nodes.retain(|&(node, _)| adhesion.is_none_or(|adhesion| adhesion[node] > 0.0));
        nodes
    }
}

/// Places of the nodes on the rim, which have less than a whole square of the lattice.
fn rim<const D: usize, const N: usize>(mesh: &Mesh<D, N>, contacts: &[Contact]) -> Vec<[f64; 2]> {
    let whole = contacts.iter().map(|(_, area)| *area).fold(0.0, f64::max);
    let on_rim = contacts.iter().filter(|(_, area)| *area < 0.999 * whole);
    on_rim
        .map(|&(node, _)| {
            let point = mesh.point(node);
            [point[0], point[1]]
        })
        .collect()
}

/// A gel under one mesh: a flat one moves it in its plane, one with three axes also up and down.
pub struct GelBed<const D: usize = 2> {
    gel: Gel,
    /// Distance between places, um, and the place in the first column and row.
    spacing: f64,
    origin: [f64; 2],
    /// Columns and rows.
    shape: [usize; 2],
    /// The nodes that adhere, their places on the lattice, and where they are without force, um.
    nodes: Vec<usize>,
    places: Vec<[u32; 2]>,
    rest: Vectors<D>,
    /// Displacement per force of the adhesion of each, um/nN.
    slack: Vec<f64>,
    convolution: Convolution,
    /// Of the displacements up and down.
    normal: Option<Convolution>,
    /// Springs like the gel: stiffness (nN/um) to the resting place, of each node, and between neighbours, by their places
    /// in `nodes`.
    anchors: Vec<f64>,
    ties: Vec<([usize; 2], f64)>,
    /// The last forces, with the displacements that they belong to: force and energy are asked for at the same place.
    last: Mutex<Option<(Vectors<D>, Vectors<D>)>>,
}

impl<const D: usize> GelBed<D> {
    /// A gel under a mesh whose long axis is the unit vector `axis`.
    ///
    /// # Errors
    /// Those of [`Gel::check`].
    ///
    /// # Example
    /// ```
    /// use myospring::mechanics::compliance::Compliance;
    /// use myospring::mechanics::gel::{Gel, GelBed};
    /// use myospring::mesh::lattice;
    /// let strip = lattice::rectangle(60, 20, 1.0)?;
    /// let bed = GelBed::new(Gel::half_space(10.0), &strip, [1.0, 0.0])?;
    /// // Shortening by a tenth about the middle pulls both ends inward.
    /// let x = strip.points[0].iter().map(|x| 30.0 + 0.9 * (x - 30.0)).collect();
    /// let [tractions, _] = bed.forces(&bed.displacements(&[x, strip.points[1].clone()]));
    /// assert!(tractions[0] > 0.0 && tractions[60] < 0.0);
    /// assert!(tractions.iter().sum::<f64>().abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new<const N: usize>(
        gel: Gel,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
    ) -> Result<Self, GelError> {
        Self::adhering(gel, mesh, axis, None)
    }

    /// As [`GelBed::new`], for a cell that adheres to each node in proportion to the given number: 0 is not at all, 1 with
    /// the stiffness of the adhesion. It must be at least 0, and only nodes adhere where the [`Adhesion`] lets them.
    ///
    /// # Errors
    /// Those of [`Gel::check`].
    pub fn adhering<const N: usize>(
        gel: Gel,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
        adhesion: Option<&[f64]>,
    ) -> Result<Self, GelError> {
        let lattice = mesh.lattice.as_ref().ok_or(GelError::NoLattice)?;
        let Lattice { spacing, shape, cells, origin } = lattice;
        let (shape, origin) = ([shape[0], shape[1]], [origin[0], origin[1]]);
        gel.check(mesh)?;
        let green = Green::new(gel, *spacing);
        let convolution = Convolution::new(&green, *spacing, shape);
        let normal = (D > 2).then(|| Convolution::normal(&green, *spacing, shape));
        let contacts = gel.attached(mesh, axis, adhesion);
        let of_one = |node: usize| adhesion.map_or(1.0, |adhesion| adhesion[node]);
        let mut number = vec![None; mesh.len()];
        for (place, &(node, _)) in contacts.iter().enumerate() {
            number[node] = Some(place);
        }
        let axial = mesh.springs.iter().filter(|spring| spring.kind == SpringKind::Axial);
        let pairs =
            axial.map(|spring| (spring.nodes.map(|node| number[node as usize]), spring.share));
        // Below a thick cell there are squares on both sides of a spring, but cubes only above.
        let whole = if D > 2 { 0.5 } else { 1.0 };
        let pairs = pairs.filter_map(|([a, b], share)| Some(([a?, b?], share / whole)));
        // Anchors and ties resist waves with `a + b k^2`. The gel resists them with a concave function of `k^2`, which lies
        // above its chord between the longest and the shortest waves of the lattice.
        let longest = shape.iter().copied().max().unwrap_or(1).max(2) as f64 * spacing;
        let numbers = [0.5 * PI / longest, PI / spacing];
        let [soft, stiff] = numbers.map(|number| gel.stiffness_of_waves(number));
        let per_square = (stiff - soft) / (numbers[1].powi(2) - numbers[0].powi(2));
        let anchor = soft - per_square * numbers[0].powi(2);
        // Where the adhesion gives way more than elsewhere, so do the springs.
        let softened = |node: usize| {
            let more = 1.0 / of_one(node) - 1.0;
            gel.adhesion_stiffness.map_or(1.0, |k| 1.0 / (1.0 + stiff / k * more))
        };
        let [own, ..] = green.at(0.0, 0.0);
        let slack = |&(node, area): &Contact| {
            // A node on the rim has a part of a square, in which its force moves the gel further.
            let part = (area / (spacing * spacing)).sqrt();
            let of_adhesion =
                gel.adhesion_stiffness.map_or(0.0, |k| 1.0 / (k * of_one(node) * area));
            own * (1.0 / part - 1.0) + of_adhesion
        };
        let place = |&(node, _): &Contact| [cells[node][0], cells[node][1]];
        Ok(Self {
            gel,
            spacing: *spacing,
            origin,
            shape,
            places: contacts.iter().map(place).collect(),
            rest: from_fn(|axis| {
                contacts.iter().map(|(node, _)| mesh.points[axis][*node]).collect()
            }),
            slack: contacts.iter().map(slack).collect(),
            convolution,
            normal,
            anchors: contacts.iter().map(|&(node, area)| anchor * area * softened(node)).collect(),
            ties: pairs
                .map(|(pair, share)| {
                    let [a, b] = pair.map(|place| softened(contacts[place].0));
                    (pair, share * per_square * a.min(b))
                })
                .collect(),
            nodes: contacts.into_iter().map(|(node, _)| node).collect(),
            last: Mutex::default(),
        })
    }

    /// The gel.
    pub fn gel(&self) -> &Gel {
        &self.gel
    }
}

impl GelBed {
    /// How forces of the nodes that adhere (nN) move the surface under the cell and around it, up to `around` times the
    /// cell's extent away.
    pub fn surface(&self, forces: &Vectors, around: f64) -> Surface {
        let Self { spacing, origin, shape: cell, .. } = *self;
        let beyond = (around * cell[0].max(cell[1]) as f64).ceil() as usize;
        let shape = cell.map(|count| count + 2 * beyond);
        let convolution = Convolution::new(&Green::new(self.gel, spacing), spacing, shape);
        let places = self.places.iter().map(|place| place.map(|at| at + beyond as u32));
        let mut all = zeros(shape[0] * shape[1]);
        for (place, [column, row]) in places.enumerate() {
            for (all, forces) in all.iter_mut().zip(forces) {
                all[row as usize * shape[0] + column as usize] = forces[place];
            }
        }
        let everywhere: Vec<[u32; 2]> = (0..shape[1] as u32)
            .flat_map(|row| (0..shape[0] as u32).map(move |column| [column, row]))
            .collect();
        Surface {
            spacing,
            origin: origin.map(|at| at - beyond as f64 * spacing),
            shape,
            displacements: convolution.displacements(&everywhere, &all),
        }
    }
}

impl<const D: usize> Compliance<D> for GelBed<D> {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn displacements(&self, positions: &Vectors<D>) -> Vectors<D> {
        from_fn(|axis| {
            let places = self.nodes.iter().map(|&node| positions[axis][node]);
            places.zip(&self.rest[axis]).map(|(now, rest)| now - rest).collect()
        })
    }

    fn forces(&self, displacements: &Vectors<D>) -> Vectors<D> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, tractions)) = last.as_ref()
            && of == displacements
        {
            return tractions.clone();
        }
        let tractions = conjugate::solve(
            displacements,
            |forces| self.displaced(forces),
            |moved| self.likeness(moved),
            SOLVED,
            ROUNDS,
        );
        *last = Some((displacements.clone(), tractions.clone()));
        tractions
    }

    fn displaced(&self, forces: &Vectors<D>) -> Vectors<D> {
        let in_plane = [forces[0].clone(), forces[1].clone()];
        let [x, y] = self.convolution.displacements(&self.places, &in_plane);
        let [mut x, mut y] = [Some(x), Some(y)];
        let up = || {
            let none = vec![0.0; self.nodes.len()];
            let [up, _] =
                self.normal.as_ref()?.displacements(&self.places, &[forces.get(2)?.clone(), none]);
            Some(up)
        };
        let mut moved: Vectors<D> = from_fn(|axis| {
            match axis {
                0 => x.take(),
                1 => y.take(),
                _ => up(),
            }
            .unwrap_or_default()
        });
        for (moved, forces) in moved.iter_mut().zip(forces) {
            for (moved, (slack, force)) in moved.iter_mut().zip(self.slack.iter().zip(forces)) {
                *moved += slack * force;
            }
        }
        moved
    }

    fn likeness(&self, displacements: &Vectors<D>) -> Vectors<D> {
        displacements.each_ref().map(|moved| {
            let mut forces: Vec<f64> =
                self.anchors.iter().zip(moved).map(|(anchor, moved)| anchor * moved).collect();
            for &([a, b], tie) in &self.ties {
                let pull = tie * (moved[a] - moved[b]);
                forces[a] += pull;
                forces[b] -= pull;
            }
            forces
        })
    }
}

impl<const D: usize> Force<D> for GelBed<D> {
    fn name(&self) -> &'static str {
        "gel"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        let tractions = self.forces(&self.displacements(at.positions));
        for (forces, tractions) in forces.iter_mut().zip(tractions) {
            for (&node, traction) in self.nodes.iter().zip(tractions) {
                forces[node] -= traction;
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let displacements = self.displacements(at.positions);
        Some(0.5 * product(&self.forces(&displacements), &displacements))
    }

    fn add_stiffness(
        &self,
        _at: &Configuration<'_, D>,
        stiffness: &mut StiffnessMatrix<D>,
    ) -> bool {
        let isotropic = |k: f64| from_fn(|i| from_fn(|j| if i == j { k } else { 0.0 }));
        for (&node, &anchor) in self.nodes.iter().zip(&self.anchors) {
            stiffness.add(node, node, isotropic(anchor));
        }
        for &([a, b], tie) in &self.ties {
            stiffness.add_pair(self.nodes[a], self.nodes[b], isotropic(tie));
        }
        true
    }

    fn compliance(&self) -> Option<&dyn Compliance<D>> {
        Some(self)
    }

    fn is_internal(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests;
