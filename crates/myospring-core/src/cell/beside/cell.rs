//! One of many cells, and what it did.

use crate::cell::cell_model::CellModel as _;
use crate::cell::pacer::Pacer;
use crate::cell::pacing::Protocol;
use crate::cell::settings::{SolveError, validate_time};
use crate::cell::tomek_2019::TomekModel;

/// One cell: its constants, its pacing, and how long it is followed.
#[derive(Debug, Clone)]
pub struct Cell {
    pub(super) model: TomekModel,
    pub(super) pacer: Pacer,
    pub(super) duration_ms: f64,
}

impl Cell {
    /// A cell in its initial state at 0 ms, at its resting length.
    ///
    /// # Errors
    /// A protocol that cannot be followed, or a duration that is not a positive finite time.
    pub fn new(
        model: &TomekModel,
        protocol: Protocol,
        duration_ms: f64,
    ) -> Result<Self, SolveError> {
        validate_time("duration", duration_ms)?;
        let pacer = Pacer::new(&model.stimulation(), protocol)?;
        Ok(Self { model: model.clone(), pacer, duration_ms })
    }
}

/// A cell at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Membrane potential, mV.
    pub potential_mv: f64,
    /// Active tension, kPa; 0 without myofilaments.
    pub tension_kpa: f64,
    /// Free calcium in the cytosol, uM.
    pub calcium_um: f64,
}

/// What one cell did.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Sample `k` at `k` times the interval.
    pub samples: Vec<Sampled>,
    /// Steps taken.
    pub steps: u64,
    /// Steps tried whose error was too large.
    pub refused: u64,
}
