//! All forces on a body, with its support.

use super::compliance::Compliance;
use super::drag::Drag;
use super::force::{Configuration, Force};
use super::support::Support;
use super::vectors::Vectors;

/// All forces on a body, its support and its drag.
pub struct System<const D: usize = 2> {
    /// Forces that store or dissipate energy: springs, area law, elastic supports.
    pub passive: Vec<Box<dyn Force<D>>>,
    /// Forces driven by the active tension.
    pub active: Vec<Box<dyn Force<D>>>,
    /// Drag; integrators treat it separately and implicitly.
    pub drag: Drag,
    /// The support of the body.
    pub support: Support,
}

impl<const D: usize> System<D> {
    /// All forces except the drag, the passive ones first.
    pub fn forces(&self) -> impl Iterator<Item = &dyn Force<D>> {
        self.passive.iter().chain(&self.active).map(|force| &**force)
    }

    /// The body outside the mesh to which nodes are attached, if there is one.
    pub fn compliance(&self) -> Option<&dyn Compliance<D>> {
        self.passive.iter().find_map(|force| force.compliance())
    }

    /// Whether all forces except the drag are internal.
    pub fn is_internal(&self) -> bool {
        self.forces().all(Force::is_internal)
    }

    /// Overwrites `forces` with the sum of all forces except the drag, before the support is
    /// applied.
    pub fn sum_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for axis in forces.iter_mut() {
            axis.fill(0.0);
        }
        for force in self.forces() {
            force.add_forces(at, forces);
        }
    }

    /// Removes from the forces the part that the support carries.
    ///
    /// With internal forces only, the mass centre stays at rest by itself; only rounding errors
    /// would be removed, so the sums over all masses are skipped.
    pub fn constrain(&self, positions: &Vectors<D>, masses: &[f64], forces: &mut Vectors<D>) {
        let stays = self.support == Support::MassCentre && self.is_internal();
        if !stays {
            self.support.constrain(positions, masses, forces);
        }
    }

    /// Energy stored in the passive forces, fJ; forces without an energy are left out.
    pub fn elastic_energy(&self, at: &Configuration<'_, D>) -> f64 {
        self.passive.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// As [`System::elastic_energy`], without that of a body outside the mesh.
    pub(crate) fn own_energy(&self, at: &Configuration<'_, D>) -> f64 {
        let own = self.passive.iter().filter(|force| force.compliance().is_none());
        own.filter_map(|force| force.energy(at)).sum()
    }

    /// Energy of the active forces at fixed tension, fJ; its decrease is their work.
    pub fn active_energy(&self, at: &Configuration<'_, D>) -> f64 {
        self.active.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// Rate at which dashpots and drag dissipate energy, fJ/ms.
    pub fn dissipation(&self, at: &Configuration<'_, D>) -> f64 {
        self.forces().map(|force| force.dissipation(at)).sum::<f64>() + self.drag.dissipation(at)
    }
}
