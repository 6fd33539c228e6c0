//! What many runs share: the path of equilibria depends only on the mesh and its forces, and the course of a cell that
//! does not feel stretch only on the cell.

use super::equilibria::Equilibria;
use super::quasi_static::PreparedPath;
use super::shared_cell::SharedCell;
use super::space::Space;
use super::{Outcome, Progress, Ready, SettingError, SetupError, Simulation};
use crate::integrate::quasi_static::Tolerance;
use std::sync::{Arc, Mutex, PoisonError};

/// One mesh with its forces, and its path of equilibria as far as its runs have needed it; with it the course of the last
/// cell, unless that feels stretch.
///
/// Runs on several threads may share it. The path to a tension is the start of any longer one, and so is the course of a
/// cell, so a run has the same bits as without sharing.
pub struct SharedPath {
    simulation: Simulation,
    solved: Solved,
    cell: Mutex<SharedCell>,
}

/// The equilibria of a flat cell, or of a thick one.
enum Solved {
    Flat(Mutex<Equilibria>),
    Thick(Mutex<Equilibria<3, 4>>),
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
        let solved = match &self.thick {
            None => Solved::Flat(Mutex::new(self.equilibria_at_rest(tolerance)?)),
            Some(_) => Solved::Thick(Mutex::new(self.equilibria_at_rest(tolerance)?)),
        };
        let cell = Mutex::new(SharedCell::of(self));
        Ok(SharedPath { simulation: self.clone(), solved, cell })
    }
}

impl Simulation {
    /// Solves the path of equilibria up to the peak of a tension that is the same everywhere; time
    /// step and method of the numerical settings are not used.
    ///
    /// # Errors
    /// An invalid setting, forces without such a path, or a cell model without tension. A path that
    /// ends before the peak is not an error; see [`Ready::end`].
    pub fn prepare_quasi_static(&self, tolerance: Tolerance) -> Result<Ready, SetupError> {
        self.shared_path(tolerance)?.prepare(self)
    }

    /// Runs along the path of equilibria, to the end or to the first fault. `observe` is called at
    /// each recorded sample and stops the run by returning `false`.
    ///
    /// # Errors
    /// Those of [`Simulation::prepare_quasi_static`]. A path that ends before the largest tension
    /// of the run is not an error but a [`StopReason`](super::StopReason).
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::Tolerance;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::Simulation;
    ///
    /// let simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// let outcome = simulation.run_quasi_static(Tolerance::default(), |_progress| true)?;
    /// assert!(outcome.stop.is_none());
    /// let peak = outcome.recording.samples.iter().map(|s| s.shortening_pct).fold(0.0, f64::max);
    /// assert!((peak - 12.0).abs() < 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run_quasi_static(
        &self,
        tolerance: Tolerance,
        observe: impl FnMut(Progress) -> bool,
    ) -> Result<Outcome, SetupError> {
        Ok(self.prepare_quasi_static(tolerance)?.run(observe))
    }
}

impl SharedPath {
    /// Prepares a run with the shared mechanics; the path is extended if needed.
    ///
    /// # Errors
    /// As [`Simulation::prepare_quasi_static`]; other mechanics than the shared ones.
    pub fn prepare(&self, simulation: &Simulation) -> Result<Ready, SetupError> {
        simulation.check()?;
        if !self.has_mechanics_of(simulation) {
            return Err(SetupError::Setting(SettingError::Conflict {
                what: "a shared path of equilibria",
                with: "another mesh, material, support, or other fibres",
                because: "its shapes are those of its own mechanics; take Simulation::build",
            }));
        }
        let cell = self.cell_of(simulation);
        Ok(match &self.solved {
            Solved::Flat(solved) => Ready::of(prepared(solved, simulation, &cell)?),
            Solved::Thick(solved) => Ready::of(prepared(solved, simulation, &cell)?),
        })
    }

    /// Returns this path where it has the mechanics of a simulation, and else a new one, which takes over what is known of
    /// the cell.
    ///
    /// # Errors
    /// Those of [`Simulation::shared_path`].
    pub fn for_mechanics_of(
        self,
        simulation: &Simulation,
        tolerance: Tolerance,
    ) -> Result<Self, SetupError> {
        if self.has_mechanics_of(simulation) {
            return Ok(self);
        }
        Ok(Self { cell: self.cell, ..simulation.shared_path(tolerance)? })
    }

    /// The cell of a simulation, with what is known of it; from now on it is the last one.
    fn cell_of(&self, simulation: &Simulation) -> SharedCell {
        let mut cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        if !cell.is_that_of(simulation) {
            *cell = SharedCell::of(simulation);
        }
        cell.clone()
    }

    /// Whether the mechanics of a simulation are the shared ones.
    fn has_mechanics_of(&self, other: &Simulation) -> bool {
        let own = &self.simulation;
        own.mesh == other.mesh
            && own.thick == other.thick
            && own.fibres_in_space == other.fibres_in_space
            && own.long_axis == other.long_axis
            && own.fibres == other.fibres
            && own.myofibril_content == other.myofibril_content
            && own.material == other.material
            && own.active == other.active
            && own.support == other.support
            && own.adhesion == other.adhesion
            && own.end_stretch == other.end_stretch
    }
}

/// A run on shared equilibria, which are extended if needed.
fn prepared<const D: usize, const N: usize>(
    solved: &Mutex<Equilibria<D, N>>,
    simulation: &Simulation,
    cell: &SharedCell,
) -> Result<PreparedPath<D, N>, SetupError>
where
    Simulation: Space<D, N>,
{
    let solved = || solved.lock().unwrap_or_else(PoisonError::into_inner);
    let assembly = Arc::clone(&solved().held.assembly);
    let setup = simulation.set_up_on(assembly, cell)?;
    setup.check_path()?;
    let mut equilibria = solved().clone();
    if !equilibria.are_known_to(setup.peak()) {
        // Not under the lock: a thread that waits within the solution may take up another run, which asks for the lock, too.
        equilibria.extend_to(simulation, setup.peak())?;
        let mut solved = solved();
        if !solved.are_known_to(setup.peak()) {
            *solved = equilibria.clone();
        }
    }
    Ok(PreparedPath { setup, equilibria })
}
