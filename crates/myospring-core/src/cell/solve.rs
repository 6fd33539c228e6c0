//! Methods in time, and whole runs of one cell.
//!
//! # The default
//! Runge-Kutta 4 with 0.005 ms: 120 000 steps, about 30 ms of computing for a beat of 600 ms. The
//! equations jump at thresholds, which leaves any fixed-step method of order 1 overall, so the step is
//! chosen by measured error. Peak of tension against 0.0002 ms: `coelho_2021` +0.02 %,
//! `bueno_orovio_2008` epi +0.03 %, endo +0.001 %, m +0.10 %, pb -0.01 %, tnnp -0.34 % (its V barely
//! reaches the narrow bell of Eq. (34), so tension is small and follows the height of the upstroke
//! steeply; [`adaptive`](super::adaptive) steps have 0.02 %); APD90 within 0.015 ms, time of the peak
//! of tension within 0.15 ms (`coelho_2021`: 0.003).

use super::CellModel;
use super::integrator::CellIntegrator;
use super::pacing::{Protocol, ProtocolError};
use super::trace::CellTrace;
use serde::Serialize;

/// A method with fixed steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    #[serde(rename = "runge-kutta-4")]
    /// Classical Runge-Kutta, order 4 where the equations are smooth.
    RungeKutta4,
    /// Forward Euler, order 1.
    ForwardEuler,
    /// Forward Euler that updates the blocks of [`CellModel::staggered_blocks`] one after the other,
    /// each with the new values of those before it, order 1. The authors of `coelho_2021` step so.
    StaggeredEuler,
}

/// Numerical settings of a cell; the measured error of the default is in the head of this module.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// Default: Runge-Kutta 4.
    pub method: Method,
    /// Largest step, ms; default 0.005.
    pub step_ms: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { method: Method::RungeKutta4, step_ms: 0.005 }
    }
}

impl Settings {
    /// Checks the step.
    ///
    /// # Errors
    /// A step that is not a positive finite time.
    pub fn validate(&self) -> Result<(), SolveError> {
        if self.step_ms.is_finite() && self.step_ms > 0.0 {
            return Ok(());
        }
        Err(SolveError::Step { step_ms: self.step_ms })
    }
}

/// Why a cell could not be moved in time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The protocol cannot be followed.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// No positive finite step.
    #[error("cell step {step_ms} ms must be a finite time above 0 ms")]
    Step {
        /// What was given, ms.
        step_ms: f64,
    },
    /// No positive finite time.
    #[error("{name} {value} ms must be a finite time above 0 ms")]
    Time {
        /// Which time.
        name: &'static str,
        /// What was given, ms.
        value: f64,
    },
    /// Time runs forward.
    #[error("the cell is at {time_ms} ms and cannot go to {target_ms} ms")]
    BackInTime {
        /// Where it was to go, ms.
        target_ms: f64,
        /// Where it is, ms.
        time_ms: f64,
    },
    /// No possible stretch.
    #[error("stretch {value} at {time_ms} ms must be a finite number above 0")]
    Stretch {
        /// What was given.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
    /// The solution left the numbers.
    #[error(
        "state variable `{variable}` of cell model `{model}` became {value} at {time_ms} ms; \
         a cell step below {step_ms} ms or other parameters may help"
    )]
    NotFinite {
        /// The model.
        model: &'static str,
        /// The state variable.
        variable: &'static str,
        /// What it became.
        value: f64,
        /// At the end of which step, ms.
        time_ms: f64,
        /// The step, ms.
        step_ms: f64,
    },
    /// No possible tolerance.
    #[error("tolerance {value} must be between {minimum} and {maximum}")]
    Tolerance {
        /// What was given.
        value: f64,
        /// Smallest.
        minimum: f64,
        /// Largest.
        maximum: f64,
    },
    /// Adaptive steps no longer get on.
    #[error(
        "cell model `{model}` does not get beyond {time_ms} ms: a step of {step_ms} ms still misses \
         the tolerance, and takes `{variable}` to {value}; a smaller stimulus or other parameters \
         may help"
    )]
    Stalled {
        /// The model.
        model: &'static str,
        /// The state variable that is no longer finite, or the first.
        variable: &'static str,
        /// What it became.
        value: f64,
        /// Time reached, ms.
        time_ms: f64,
        /// The step tried, ms.
        step_ms: f64,
    },
    /// One default beat raises no tension that peaks within the reference time.
    #[error(
        "cell model `{model}` has no peak of tension within {duration_ms} ms of one default beat: \
         highest {value} at {time_ms} ms"
    )]
    NoPeak {
        /// The model.
        model: &'static str,
        /// Length of the reference beat, ms.
        duration_ms: f64,
        /// Highest tension.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
}

/// Runs a cell of resting length from 0 ms to `duration_ms` and samples it every
/// `sample_interval_ms`, first at 0 ms.
///
/// # Errors
/// A protocol, step, duration or interval that is not possible; a state that is no longer finite.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, pacing::Protocol, solve::{Settings, solve}};
///
/// let model = coelho_2021::model();
/// let beat = Protocol::once(model.default_stimulus());
/// let trace = solve(&model, beat, Settings::default(), 100.0, 0.5)?;
/// assert_eq!(trace.time_ms.len(), 201);
/// assert!((trace.peak_potential().unwrap().time - 52.0).abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(
    model: &dyn CellModel,
    protocol: Protocol,
    settings: Settings,
    duration_ms: f64,
    sample_interval_ms: f64,
) -> Result<CellTrace, SolveError> {
    let mut cell = CellIntegrator::new(model, protocol, settings)?;
    sample(model, duration_ms, sample_interval_ms, |time_ms| {
        cell.advance_to(time_ms, 1.0)?;
        Ok(cell.state().to_vec())
    })
}

/// Refuses what is not a positive finite time.
pub(super) fn validate_time(name: &'static str, value: f64) -> Result<(), SolveError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SolveError::Time { name, value })
}

/// Samples `state_at` from 0 ms to `duration_ms`, asked for rising times.
pub(super) fn sample<S: AsRef<[f64]>>(
    model: &dyn CellModel,
    duration_ms: f64,
    sample_interval_ms: f64,
    mut state_at: impl FnMut(f64) -> Result<S, SolveError>,
) -> Result<CellTrace, SolveError> {
    validate_time("duration", duration_ms)?;
    validate_time("sample interval", sample_interval_ms)?;
    let has_millivolts = model.membrane_potential_mv(&model.initial_state()).is_some();
    let mut trace = CellTrace {
        time_ms: Vec::new(),
        state_names: model.state_names(),
        states: vec![Vec::new(); model.state_names().len()],
        potential: Vec::new(),
        membrane_potential_mv: has_millivolts.then(Vec::new),
        tension: Vec::new(),
    };
    // A duration that is a multiple of the interval but for rounding keeps its last sample.
    let samples = (duration_ms / sample_interval_ms * (1.0 + 1e-12)).floor() as u64;
    for sample in 0..=samples {
        let time_ms = sample as f64 * sample_interval_ms;
        let state = state_at(time_ms)?;
        let state = state.as_ref();
        trace.time_ms.push(time_ms);
        for (column, value) in trace.states.iter_mut().zip(state) {
            column.push(*value);
        }
        trace.potential.push(model.potential(state));
        trace.tension.push(model.tension(state));
        if let Some(column) = &mut trace.membrane_potential_mv {
            column.extend(model.membrane_potential_mv(state));
        }
    }
    Ok(trace)
}

/// What one default beat of a model amounts to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceBeat {
    /// Highest tension, dimensionless.
    pub peak_tension: f64,
    /// When, ms; the stimulus falls at [`Protocol::DEFAULT_START_MS`].
    pub peak_time_ms: f64,
}

/// Length of the reference beat, ms, stimulus at 50 ms.
pub const REFERENCE_BEAT_MS: f64 = 600.0;

/// One default beat: [`CellModel::default_stimulus`] once at 50 ms, 600 ms long.
///
/// # Errors
/// A state that is no longer finite, or tension without a positive peak inside the beat.
pub fn reference_beat(
    model: &dyn CellModel,
    settings: Settings,
) -> Result<ReferenceBeat, SolveError> {
    let protocol = Protocol::once(model.default_stimulus());
    let trace = solve(model, protocol, settings, REFERENCE_BEAT_MS, 0.1)?;
    let last_ms = trace.time_ms.last().copied().unwrap_or_default();
    reference_of(model, trace.peak_tension().map(|peak| (peak.value, peak.time)), last_ms)
}

/// A peak of tension (value, time in ms) as the reference, if it is one and lies before `last_ms`.
pub(super) fn reference_of(
    model: &dyn CellModel,
    peak: Option<(f64, f64)>,
    last_ms: f64,
) -> Result<ReferenceBeat, SolveError> {
    match peak {
        Some((peak_tension, peak_time_ms)) if peak_tension > 0.0 && peak_time_ms < last_ms => {
            Ok(ReferenceBeat { peak_tension, peak_time_ms })
        }
        other => Err(SolveError::NoPeak {
            model: model.name(),
            duration_ms: REFERENCE_BEAT_MS,
            value: other.map_or(f64::NAN, |(value, _)| value),
            time_ms: other.map_or(f64::NAN, |(_, time_ms)| time_ms),
        }),
    }
}
