//! What runs of the same cell share: its course in time, and how strong its default beat is.

use super::Simulation;
use crate::cell::CellModel;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{self, SolveError, SolverSettings};
use crate::exchange::CellCourse;
use std::sync::{Arc, OnceLock};

/// A cell as it is paced and integrated, with what is known of it so far. A copy shares that.
#[derive(Clone)]
pub(super) struct SharedCell {
    model: Arc<dyn CellModel>,
    protocol: Protocol,
    start_state: Option<Vec<f64>>,
    settings: SolverSettings,
    /// Exchange interval, ms.
    every: f64,
    /// Its states at the ends of the intervals.
    pub(super) course: CellCourse,
    /// Peak of its default beat, in the unit of the model's tension.
    peak: Arc<OnceLock<f64>>,
}

impl SharedCell {
    /// The cell of a simulation, of which nothing is known.
    pub(super) fn of(simulation: &Simulation) -> Self {
        let Simulation { cell, protocol, start_state, numerics, .. } = simulation;
        Self {
            model: Arc::clone(cell),
            protocol: *protocol,
            start_state: start_state.clone(),
            settings: simulation.cell_settings(),
            every: numerics.exchange_interval,
            course: CellCourse::default(),
            peak: Arc::default(),
        }
    }

    /// Whether a simulation certainly has this cell.
    pub(super) fn is_that_of(&self, simulation: &Simulation) -> bool {
        let Simulation { cell, protocol, start_state, numerics, .. } = simulation;
        (Arc::ptr_eq(&self.model, cell) || self.model.is_same_as(&**cell))
            && self.protocol == *protocol
            && self.start_state == *start_state
            && self.settings == simulation.cell_settings()
            && self.every == numerics.exchange_interval
    }

    /// The highest tension of its default beat, in the unit of the model; a tension that is too weak or too slow to peak
    /// is not an error here.
    pub(super) fn peak(&self) -> Result<f64, SolveError> {
        if let Some(peak) = self.peak.get() {
            return Ok(*peak);
        }
        let peak = match solve::reference_beat(&*self.model, self.settings) {
            Ok(beat) => beat.peak_tension,
            Err(SolveError::NoPeak { value, .. }) => value.max(0.0),
            Err(error) => return Err(error),
        };
        Ok(*self.peak.get_or_init(|| peak))
    }
}
