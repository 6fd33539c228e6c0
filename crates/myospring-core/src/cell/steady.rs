//! Paces a cell until it is in a steady state.
//!
//! The cell model alone, at its resting length, is stimulated at a cycle length; its state is
//! recorded once per beat, at the phase at which a run begins. It is steady when no state has
//! changed by more than a tolerance over ten beats, relative to the largest size that the state had
//! within the last of them. Slow drifts over hundreds of beats, such as that of sodium, may
//! continue by several times the tolerance; a cell that alternates between two beats counts as
//! steady.

use super::CellModel;
use super::integrator::CellIntegrator;
use super::pacing::Protocol;
use super::settings::{SolveError, SolverSettings};
use crate::interruption::{Interrupted, Interruption};
use std::sync::Arc;

/// Number of beats over which changes are measured.
pub const WINDOW: u32 = 10;
/// Largest number of beats.
pub const MOST_BEATS: u32 = 2000;
/// Samples per beat, from which the size of a state is determined.
const SAMPLES: u32 = 50;
/// Time before a stimulus at which the state is recorded, ms, so that it does not include the
/// stimulus.
const APART_MS: f64 = 0.1;

/// A state that recurs with every beat.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyState {
    /// In the order of the model's states.
    pub state: Vec<f64>,
    /// Number of beats until it was reached.
    pub beats: u32,
    /// Largest relative change of a state over the last ten beats.
    pub change: f64,
}

/// Why there is no steady state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SteadyError {
    /// The cell cannot be integrated.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// It was interrupted.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The cell does not become steady.
    #[error(
        "after {MOST_BEATS} beats `{variable}` of `{model}` still changes by {change:.2e} over {WINDOW} beats, more than \
         the tolerance {tolerance}; give a larger one"
    )]
    Changing {
        /// The model.
        model: String,
        /// The state that changes most.
        variable: String,
        /// Its relative change.
        change: f64,
        /// The tolerance.
        tolerance: f64,
    },
}

/// The state of a cell that was paced by a protocol (its stimulus, cycle length and start, at which
/// the first stimulus of the run comes, without an S2) until it changes by at most `tolerance`; can
/// be interrupted.
///
/// # Errors
/// A cell that cannot be integrated or does not become steady; [`SteadyError::Interrupted`].
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, pacing::Protocol, solve::SolverSettings, steady};
/// use myospring::interruption::Interruption;
/// use std::sync::Arc;
/// let model: Arc<dyn CellModel> = Arc::new(coelho_2021::model());
/// let protocol = Protocol { cycle_length_ms: 600.0, ..Protocol::once(model.default_stimulus()) };
/// let found = steady::pace(&model, protocol, SolverSettings::default(), 1e-3, &Interruption::default())?;
/// assert!(found.beats >= 10 && found.change <= 1e-3);
/// # Ok::<(), steady::SteadyError>(())
/// ```
pub fn pace(
    model: &Arc<dyn CellModel>,
    protocol: Protocol,
    settings: SolverSettings,
    tolerance: f64,
    interruption: &Interruption,
) -> Result<SteadyState, SteadyError> {
    let cycle = protocol.cycle_length_ms;
    let start_ms = protocol.start_ms.max(APART_MS).min(cycle - APART_MS);
    let train = Protocol { start_ms, beats: MOST_BEATS + 1, s2_interval_ms: None, ..protocol };
    let mut cell = CellIntegrator::new(Arc::clone(model), train, settings)?;
    let mut before: Vec<Vec<f64>> = vec![cell.state().to_vec()];
    let mut worst = (0, f64::INFINITY);
    for beat in 1..=MOST_BEATS {
        let mut size = vec![0.0; cell.state().len()];
        for sample in 1..=SAMPLES {
            interruption.check()?;
            let time = f64::from(beat - 1) + f64::from(sample) / f64::from(SAMPLES);
            cell.advance_to(time * cycle, 1.0, 0.0)?;
            for (size, value) in size.iter_mut().zip(cell.state()) {
                *size = f64::max(*size, value.abs());
            }
        }
        let state = cell.state().to_vec();
        if beat >= WINDOW {
            let old = &before[(beat - WINDOW) as usize];
            let change = |place: usize| {
                let off = (state[place] - old[place]).abs();
                if off == 0.0 { 0.0 } else { off / size[place] }
            };
            worst = (0..state.len())
                .map(|place| (place, change(place)))
                .fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
            if worst.1 <= tolerance {
                return Ok(SteadyState { state, beats: beat, change: worst.1 });
            }
        }
        before.push(state);
    }
    let variable = model.states()[worst.0].name.to_string();
    Err(SteadyError::Changing {
        model: model.name().to_owned(),
        variable,
        change: worst.1,
        tolerance,
    })
}
