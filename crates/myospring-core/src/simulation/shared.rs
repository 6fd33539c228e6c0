//! Mechanics that many runs share: the path of equilibria depends only on the mesh and its forces.

use super::equilibria::Equilibria;
use super::quasi_static::PreparedPath;
use super::{SettingError, SetupError, Simulation};
use crate::integrate::quasi_static::Tolerance;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One mesh with its forces, and its path of equilibria as far as its runs have needed it.
///
/// Runs on several threads may share it. The path to a tension is the start of any longer one, so a
/// run has the same bits as without sharing.
pub struct SharedPath {
    simulation: Simulation,
    solved: Mutex<Equilibria>,
}

impl Simulation {
    /// Prepares the mechanics of this simulation for runs that differ in cell model, peak tension,
    /// protocol, duration or intervals.
    ///
    /// # Errors
    /// Those of [`Simulation::prepare_quasi_static`].
    ///
    /// # Example
    /// ```
    /// use myospring::prelude::*;
    /// use myospring::integrate::quasi_static::Tolerance;
    ///
    /// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// let shared = simulation.shared_path(Tolerance::default())?;
    /// for peak_tension in [20.0, 50.0] {
    ///     simulation.peak_tension = peak_tension;
    ///     let together = shared.prepare(&simulation)?.run(|_progress| true);
    ///     let alone = simulation.run_quasi_static(Tolerance::default(), |_progress| true)?;
    ///     assert_eq!(together.recording, alone.recording);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shared_path(&self, tolerance: Tolerance) -> Result<SharedPath, SetupError> {
        let solved = Mutex::new(self.equilibria_at_rest(tolerance)?);
        Ok(SharedPath { simulation: self.clone(), solved })
    }
}

impl SharedPath {
    /// Prepares a run with the shared mechanics; the path is extended if needed.
    ///
    /// # Errors
    /// As [`Simulation::prepare_quasi_static`]; other mechanics than the shared ones.
    pub fn prepare(&self, simulation: &Simulation) -> Result<PreparedPath, SetupError> {
        simulation.check()?;
        if !self.has_mechanics_of(simulation) {
            return Err(SetupError::Setting(SettingError::Conflict {
                what: "a shared path of equilibria",
                with: "another mesh, material, support, or other fibres",
                because: "its shapes are those of its own mechanics; take Simulation::build",
            }));
        }
        let assembly = Arc::clone(&self.solved().held.assembly);
        let setup = simulation.set_up_on(assembly)?;
        setup.check_path()?;
        let mut solved = self.solved();
        solved.extend_to(simulation, setup.peak())?;
        Ok(PreparedPath { setup, equilibria: solved.clone() })
    }

    fn solved(&self) -> MutexGuard<'_, Equilibria> {
        self.solved.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the mechanics of a simulation are the shared ones.
    pub fn has_mechanics_of(&self, other: &Simulation) -> bool {
        let own = &self.simulation;
        own.mesh == other.mesh
            && own.long_axis == other.long_axis
            && own.fibres == other.fibres
            && own.myofibril_content == other.myofibril_content
            && own.material == other.material
            && own.active == other.active
            && own.support == other.support
            && own.end_stretch == other.end_stretch
    }
}
