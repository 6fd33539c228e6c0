//! Mechanics that many runs share: the path of equilibria hangs on the mesh and its forces alone.

use super::quasi_static::{Curve, PreparedPath};
use super::setup::{Assembly, Setup};
use super::{SettingError, SetupError, Simulation};
use crate::integrate::quasi_static::{Path, PathError, Shapes, Tolerance};
use crate::interruption::Interrupted;
use std::sync::{Arc, Mutex, PoisonError};

/// One mesh with its forces, and its path of equilibria as far as any of its runs has needed it.
///
/// Runs on several threads may share it. The path to a tension is the start of any longer one, so a run has the same
/// bits as it has alone.
pub struct SharedPath {
    simulation: Simulation,
    assembly: Arc<Assembly>,
    solved: Mutex<Arc<Solved>>,
}

struct Solved {
    shapes: Shapes,
    curve: Arc<Curve>,
    /// Why it goes no further.
    end: Option<PathError>,
}

impl Simulation {
    /// Makes the mechanics of this simulation ready to be shared by runs that differ in all else: cell model, peak
    /// tension, protocol, duration, intervals.
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
        let setup = self.set_up()?;
        setup.check_path()?;
        let Assembly { system, body, .. } = &*setup.assembly;
        let path = Path::start_interruptible(system, body, tolerance, &self.interruption)?;
        let mesh = &setup.simulation.mesh;
        let curve = Arc::new(Curve::along(&path, mesh, &setup.assembly, &self.interruption)?);
        let solved = Mutex::new(Arc::new(Solved { shapes: path.into_shapes(), curve, end: None }));
        Ok(SharedPath { simulation: self.clone(), assembly: setup.assembly, solved })
    }
}

impl SharedPath {
    /// Makes a run ready whose mechanics are the shared ones; the path is solved further where it needs more.
    ///
    /// # Errors
    /// As [`Simulation::prepare_quasi_static`]; mechanics that are not the shared ones.
    pub fn prepare(&self, simulation: &Simulation) -> Result<PreparedPath, SetupError> {
        simulation.check()?;
        if !self.has_mechanics_of(simulation) {
            return Err(SetupError::Setting(SettingError::Conflict {
                what: "a shared path of equilibria",
                with: "another mesh, material, support, or other fibres",
                because: "its shapes are those of its own mechanics; take Simulation::build",
            }));
        }
        let setup = simulation.set_up_on(Arc::clone(&self.assembly))?;
        setup.check_path()?;
        let peak = setup.peak();
        let solved = self.up_to(peak, &setup)?;
        let (shapes, curve) = (solved.shapes.clone(), Arc::clone(&solved.curve));
        let end = solved.end.clone().filter(|_| !shapes.reaches(peak));
        let loaded = setup.loaded(shapes.tolerance())?;
        Ok(PreparedPath { setup, shapes, end, curve, loaded })
    }

    /// The path up to a tension, or as far as it goes.
    fn up_to(&self, tension: f64, setup: &Setup) -> Result<Arc<Solved>, Interrupted> {
        let mut solved = self.solved.lock().unwrap_or_else(PoisonError::into_inner);
        if solved.shapes.reaches(tension) || solved.end.is_some() {
            return Ok(Arc::clone(&solved));
        }
        let Assembly { system, body, .. } = &*self.assembly;
        let interruption = &setup.simulation.interruption;
        let mut path = Path::resume(system, body, solved.shapes.clone(), interruption);
        let end = path.extend(tension).err();
        interruption.check()?;
        let mesh = &setup.simulation.mesh;
        let curve = Arc::new(Curve::along(&path, mesh, &self.assembly, interruption)?);
        *solved = Arc::new(Solved { shapes: path.into_shapes(), curve, end });
        Ok(Arc::clone(&solved))
    }

    fn has_mechanics_of(&self, other: &Simulation) -> bool {
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
