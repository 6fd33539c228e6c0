//! All that acts on a body.

use super::drag::Drag;
use super::force::{Configuration, Force};
use super::support::Support;
use super::vectors::Vectors;

/// All forces on a body, what holds it and what slows it.
pub struct System<const D: usize = 2> {
    /// Forces that store or take energy: springs, area law, elastic supports.
    pub passive: Vec<Box<dyn Force<D>>>,
    /// Forces that the active tension drives.
    pub active: Vec<Box<dyn Force<D>>>,
    /// Drag; integrators treat it on its own, implicitly.
    pub drag: Drag,
    /// What holds the body.
    pub support: Support,
}

impl<const D: usize> System<D> {
    /// Every force but the drag, the passive ones first.
    pub fn forces(&self) -> impl Iterator<Item = &dyn Force<D>> {
        self.passive.iter().chain(&self.active).map(|force| &**force)
    }

    /// Whether all forces but the drag are internal.
    pub fn is_internal(&self) -> bool {
        self.forces().all(Force::is_internal)
    }

    /// Overwrites `forces` with the sum of all but the drag, before the support acts.
    pub fn sum_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for axis in forces.iter_mut() {
            axis.fill(0.0);
        }
        for force in self.forces() {
            force.add_forces(at, forces);
        }
    }

    /// Takes from the forces what the support bears.
    ///
    /// A mass centre at rest stays at rest by itself when all forces are internal: then there is
    /// nothing to take but rounding, and the sums over all masses are spared.
    pub fn constrain(&self, positions: &Vectors<D>, masses: &[f64], forces: &mut Vectors<D>) {
        let stays = self.support == Support::MassCentre && self.is_internal();
        if !stays {
            self.support.constrain(positions, masses, forces);
        }
    }

    /// Energy stored in the passive forces, fJ; those without an energy count nothing.
    pub fn elastic_energy(&self, at: &Configuration<'_, D>) -> f64 {
        self.passive.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// Energy of the active forces at fixed tension, fJ; its drop is the work that they do.
    pub fn active_energy(&self, at: &Configuration<'_, D>) -> f64 {
        self.active.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// Rate at which dashpots and drag take energy, fJ/ms.
    pub fn dissipation(&self, at: &Configuration<'_, D>) -> f64 {
        self.forces().map(|force| force.dissipation(at)).sum::<f64>() + self.drag.dissipation(at)
    }
}
