//! Springs from nodes to their resting positions: elastic supports.
//!
//! Each anchored node is pulled back to its resting position, equally in all directions of the
//! plane:
//!
//! ```text
//! f_i = -k_i (x_i - X_i)          E = sum k_i |x_i - X_i|^2 / 2
//! ```
//!
//! - [`Anchors::elastic_bed`]: a cell that adheres to a gel or to pillars, an elastic foundation as
//!   in `edwards_schwarz_2011`: `k_i = b A_i` with the bed's stiffness `b` (kPa/um: traction per
//!   displacement) and the node's area. A soft layer of thickness `t` bonded to glass, thin against
//!   the cell, is sheared by `u/t`, so `b = G/t = E/(2 (1 + nu) t)`; on thicker gels, the points at
//!   which the cell pulls interact, and `b` is an effective value (`banerjee_marchetti_2012`).
//!   Displacements decay from the cell's ends over `sqrt(E w/b)`, with the cell's Young's modulus
//!   and thickness.
//! - [`Anchors::spring_held_ends`]: an auxotonic contraction between two elastic fibres. At each
//!   end the nodes of the outer twentieth of the length
//!   ([`END_PART`](crate::mesh::ends::END_PART)), where the fibre is attached, share its stiffness
//!   in proportion to their areas, so the fibre's force is stiffness times mean displacement. A
//!   round cantilever perpendicular to the picture, such as a carbon fibre, bends equally in both
//!   directions of the plane, so the springs are isotropic. They carry no force when the cell
//!   rests.
//!
//! On soft springs, the whole cell swings slowly: because of numerical mass and drag, its position
//! (not its shape) lags in a run in time. A path of equilibria has no such lag.

pub use super::lattice_law::Anchor;

use super::force::{Configuration, Force};
use super::lattice_law::LatticeLaw;
use super::stiffness::StiffnessMatrix;
use super::vectors::Vectors;
use crate::mesh::Mesh;
use crate::mesh::ends::end_nodes;

/// Nodes tied to their resting positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Anchors<const D: usize = 2> {
    name: &'static str,
    springs: Vec<Anchor<D>>,
}

impl<const D: usize> Anchors<D> {
    /// An elastic bed of this stiffness (kPa/um) under the whole mesh; under the lowest face of one with three axes.
    ///
    /// # Example
    /// ```
    /// use myospring::mechanics::{Force, anchor::Anchors};
    /// use myospring::mesh::lattice;
    /// let strip = lattice::rectangle(10, 2, 1.0)?;
    /// let bed = Anchors::elastic_bed(&strip, 0.5);
    /// // Shifting 20 um^2 by 2 um takes 0.5 kPa/um * 20 um^2 * (2 um)^2 / 2 = 20 fJ.
    /// let mut body = myospring::mechanics::Body::at_rest(&strip, 1.0, 1.0);
    /// body.positions[0].iter_mut().for_each(|x| *x += 2.0);
    /// assert!((bed.energy(&body.configuration(0.0)).unwrap() - 20.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn elastic_bed<const N: usize>(mesh: &Mesh<D, N>, stiffness: f64) -> Self {
        let anchor = |(node, area): (usize, f64)| Anchor {
            node,
            place: mesh.point(node),
            stiffness: stiffness * area,
        };
        Self { name: "elastic bed", springs: mesh.underside().into_iter().map(anchor).collect() }
    }

    /// Springs of this stiffness (nN/um) at either end of a mesh whose long axis is the unit vector
    /// `axis`.
    pub fn spring_held_ends<const N: usize>(
        mesh: &Mesh<D, N>,
        axis: [f64; D],
        stiffness: f64,
    ) -> Self {
        let mut both = Self { name: "spring-held ends", springs: Vec::new() };
        for nodes in end_nodes(mesh, axis) {
            let whole: f64 = nodes.iter().map(|&node| mesh.areas[node]).sum();
            let share = |area: f64| stiffness * area / whole;
            both.springs.extend(Self::new(both.name, mesh, nodes, share).springs);
        }
        both
    }

    fn new<const N: usize>(
        name: &'static str,
        mesh: &Mesh<D, N>,
        nodes: impl IntoIterator<Item = usize>,
        stiffness: impl Fn(f64) -> f64,
    ) -> Self {
        let anchor = |node: usize| Anchor {
            node,
            place: mesh.point(node),
            stiffness: stiffness(mesh.areas[node]),
        };
        Self { name, springs: nodes.into_iter().map(anchor).collect() }
    }
}

impl<const D: usize> Force<D> for Anchors<D> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for axis in 0..D {
            let (position, force) = (&at.positions[axis], &mut forces[axis]);
            for anchor in &self.springs {
                force[anchor.node] -=
                    anchor.stiffness * (position[anchor.node] - anchor.place[axis]);
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        let one = |anchor: &Anchor<D>| {
            let away = |axis: usize| at.positions[axis][anchor.node] - anchor.place[axis];
            anchor.stiffness * (0..D).map(|axis| away(axis) * away(axis)).sum::<f64>()
        };
        Some(0.5 * self.springs.iter().map(one).sum::<f64>())
    }

    fn add_stiffness(
        &self,
        _at: &Configuration<'_, D>,
        stiffness: &mut StiffnessMatrix<D>,
    ) -> bool {
        for &Anchor { node, stiffness: k, .. } in &self.springs {
            let mut block = [[0.0; D]; D];
            for axis in 0..D {
                block[axis][axis] = k;
            }
            stiffness.add(node, node, block);
        }
        true
    }

    fn on_lattice(&self) -> Option<LatticeLaw<'_, D>> {
        Some(LatticeLaw::Anchors(&self.springs))
    }

    fn is_internal(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;

    #[test]
    fn a_shift_of_the_whole_cell_pulls_with_the_stated_stiffness() {
        let mesh = lattice::rectangle(40, 6, 1.0).unwrap();
        let force_under_a_shift_of_3_um = |anchors: &Anchors| {
            let mut forces = crate::mechanics::zeros(mesh.len());
            let positions =
                [mesh.points[0].iter().map(|x| x + 3.0).collect(), mesh.points[1].clone()];
            let still = crate::mechanics::zeros(mesh.len());
            let at =
                Configuration { positions: &positions, velocities: &still, tension: 0.0.into() };
            anchors.add_forces(&at, &mut forces);
            forces[0].iter().sum::<f64>()
        };
        // Two ends of 7 nN/um; a bed of 0.2 kPa/um under 240 um^2.
        let ends = Anchors::spring_held_ends(&mesh, [1.0, 0.0], 7.0);
        assert!((force_under_a_shift_of_3_um(&ends) + 2.0 * 7.0 * 3.0).abs() < 1e-10);
        let bed = Anchors::elastic_bed(&mesh, 0.2);
        assert!((force_under_a_shift_of_3_um(&bed) + 0.2 * 240.0 * 3.0).abs() < 1e-10);
    }
}
