//! The trait of force laws.

use super::compliance::Compliance;
use super::lattice_law::LatticeLaw;
use super::stiffness::StiffnessMatrix;
use super::tension::Tension;
use super::vectors::Vectors;

/// The variables on which a force depends.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a, const D: usize = 2> {
    /// Positions, um.
    pub positions: &'a Vectors<D>,
    /// Velocities, um/ms.
    pub velocities: &'a Vectors<D>,
    /// Active tension.
    pub tension: Tension<'a>,
}

/// A force law.
pub trait Force<const D: usize = 2>: Send + Sync {
    /// Its name in messages and records.
    fn name(&self) -> &'static str;

    /// Adds to `forces` the force on each node, nN.
    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>);

    /// Potential energy, fJ, of which the force at zero velocity and fixed tension is minus the
    /// gradient; `None` if there is no such energy.
    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64>;

    /// Rate at which velocity-dependent parts dissipate energy, fJ/ms; never negative.
    fn dissipation(&self, _at: &Configuration<'_, D>) -> f64 {
        0.0
    }

    /// Adds the tangent stiffness, nN/um: minus the derivative of the force at zero velocity, which at
    /// fixed tension is the second derivative of the energy.
    ///
    /// Optional: returns whether the force has one, and adds nothing if not. Equilibria need it
    /// (`integrate::quasi_static`); motion in time does not.
    fn add_stiffness(
        &self,
        _at: &Configuration<'_, D>,
        _stiffness: &mut StiffnessMatrix<D>,
    ) -> bool {
        false
    }

    /// The body outside the mesh that makes this force, if its stiffness ties all nodes to each other and
    /// [`Force::add_stiffness`] adds only one that is like it. Equilibria solve for both together.
    fn compliance(&self) -> Option<&dyn Compliance<D>> {
        None
    }

    /// The law as data for a kernel that sweeps a lattice (`integrate::stencil`).
    ///
    /// Optional: with `None`, plain loops are used.
    fn on_lattice(&self) -> Option<LatticeLaw<'_, D>> {
        None
    }

    /// Whether the forces have no resultant force and torque (for instance pairs along the line
    /// between nodes), so that linear and angular momentum are conserved.
    fn is_internal(&self) -> bool;
}
