//! Complete runs of one cell by any method.
//!
//! # Fixed steps of a minimal model
//! Runge-Kutta 4 with 0.005 ms, [`SolverSettings::default`]: 120 000 steps, about 30 ms of computing for a beat
//! of 600 ms. The equations jump at thresholds, which reduces any fixed-step method to order 1, so the step is
//! chosen by measured error. Peak of tension against 0.0002 ms: `coelho_2021` +0.02 %,
//! `bueno_orovio_2008` epi +0.03 %, endo +0.001 %, m +0.10 %, pb -0.01 %, tnnp -0.34 % (its V
//! barely reaches the narrow bell of Eq. (34), so tension is small and follows the height of the
//! upstroke steeply); APD90 within 0.015 ms, time of the peak of tension within 0.15 ms (`coelho_2021`: 0.003).
//!
//! Their usual method is [`adaptive`](super::adaptive): its peak of tension is right to 0.02 %, and in a run of
//! one beat it takes a thirtieth of the time.

pub use super::reference::{REFERENCE_BEAT_MS, ReferenceBeat};
pub use super::settings::{CellMethod, SolveError, SolverSettings};

use super::cell_model::CellModel;
use super::description::TensionKind;
use super::integrator::Steps;
use super::pacing::Protocol;
use super::trace::{CellTrace, Instant};
use crate::interruption::Interrupted;

/// Runs a cell of resting length from 0 ms to `duration_ms` and samples it every
/// `sample_interval_ms`, first at 0 ms.
///
/// # Errors
/// An invalid protocol, step, tolerance, duration or interval; a method that does not suit the
/// model; a state that is not finite, or a cell for which no step succeeds.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, pacing::Protocol, solve::{SolverSettings, solve}};
///
/// let model = coelho_2021::model();
/// let beat = Protocol::once(model.default_stimulus());
/// let trace = solve(&model, beat, SolverSettings::default(), 100.0, 0.5)?;
/// assert_eq!(trace.time_ms.len(), 201);
/// assert!((trace.peak_potential().unwrap().time - 52.0).abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(
    model: &dyn CellModel,
    protocol: Protocol,
    settings: SolverSettings,
    duration_ms: f64,
    sample_interval_ms: f64,
) -> Result<CellTrace, SolveError> {
    solve_while(model, protocol, settings, duration_ms, sample_interval_ms, |_time_ms| true)
}

/// Like [`solve`], as long as `goes_on`, which is called with the time of each sample, ms, returns `true`.
///
/// # Errors
/// As [`solve`]; [`SolveError::Interrupted`].
pub fn solve_while(
    model: &(dyn CellModel + 'static),
    protocol: Protocol,
    settings: SolverSettings,
    duration_ms: f64,
    sample_interval_ms: f64,
    mut goes_on: impl FnMut(f64) -> bool,
) -> Result<CellTrace, SolveError> {
    let mut steps = Steps::new(model, protocol, settings)?;
    steps.hold();
    CellTrace::sample(model, duration_ms, sample_interval_ms, |time_ms| {
        if !goes_on(time_ms) {
            return Err(Interrupted.into());
        }
        steps.advance_to(model, time_ms, 1.0, 0.0)?;
        let (state, input) = (steps.state().to_vec(), steps.input());
        Ok(Instant { state, input, outputs: steps.outputs(model) })
    })
}

/// One default beat: [`CellModel::default_stimulus`] once at 50 ms, over 600 ms.
///
/// # Errors
/// As [`solve`], or tension without a positive peak inside the beat.
pub fn reference_beat(
    model: &dyn CellModel,
    settings: SolverSettings,
) -> Result<ReferenceBeat, SolveError> {
    if model.tension_kind() == TensionKind::None {
        return Err(SolveError::NoTension { model: model.name().to_owned() });
    }
    let protocol = Protocol::once(model.default_stimulus());
    let trace = solve(model, protocol, settings, REFERENCE_BEAT_MS, 0.1)?;
    let last_ms = trace.time_ms.last().copied().unwrap_or_default();
    ReferenceBeat::of(model, trace.peak_tension().map(|peak| (peak.value, peak.time)), last_ms)
}
