//! The minimal model with adaptive steps, for one cell.
//!
//! The usual method of minimal models. Many cells at once ([`batch`](super::batch)) give bitwise the same results. [Fixed
//! steps](super::solve) are a check of this module.
//!
//! # Method
//! The pair 3(2) of Bogacki and Shampine (`bogacki_shampine_1989`): three evaluations a step, each step
//! as long as its error estimate stays below `tolerance (floor + |value|)` for every variable, floor
//! 0.1 for `u, v, w, s` and 0.01 for `Ta_i, Ta` (`hairer_norsett_wanner_1993`, II.4). Between the ends
//! of a step the state is Hermite's cubic, of the same order.
//!
//! Such a method keeps its order only if the equations are smooth, but the minimal model jumps at
//! thresholds. Therefore:
//! - **Switches.** Between thresholds every Heaviside step is a constant. A step uses the constants
//!   of the side on which it begins. If its middle or end lies on another side, it is cut where the
//!   cubic meets the threshold, `u` is set exactly to the threshold, and the next step uses the
//!   constants of the other side (`hairer_norsett_wanner_1993`, II.6). The same at `Ta_i = x_3`. An
//!   excursion over a threshold and back within half a step is not detected; the error estimate
//!   bounds its height.
//! - **Sliding.** Where `du/dt` points at the threshold from both sides, as in resting `coelho_2021` at
//!   `theta_w`, `u` stays on it and the other rates are the mixture of both sides' that keeps it there
//!   (`filippov_1988`). It ends when one side no longer points at the threshold, or with a stimulus.
//! - **Stimuli.** A step ends exactly at each event of the protocol; then the side is determined
//!   again and the step size is chosen from the rates. The state at the time of an event includes
//!   the event.
//!
//! # Guarantees
//! Error of the default tolerance 1e-5 for the published sets, trains of five beats at 500, 1000
//! and 2000 ms against converged solutions of another program: peak tension below 0.03 %, its time
//! below 0.02 ms, APD90 below 0.01 ms; in proportion to the tolerance. The times at which the state
//! is requested do not change the result. If no step succeeds, the result is an error with its
//! time, never an endless loop.
//!
//! # Example
//! ```
//! use myospring::cell::adaptive::{AdaptiveSettings, beats};
//! use myospring::cell::{CellModel, bueno_orovio_2008, pacing::Protocol};
//!
//! let epi = bueno_orovio_2008::model(bueno_orovio_2008::Variant::Epi);
//! let train = Protocol { beats: 5, ..Protocol::once(epi.default_stimulus()) }; // each 1000 ms
//! let beats = beats(&epi, train, AdaptiveSettings::default(), 5000.0)?;
//! assert!((beats[4].apd90_ms.unwrap() - 269.77).abs() < 0.1);
//! # Ok::<(), myospring::cell::solve::SolveError>(())
//! ```

mod branch;
mod course;
mod lanes;
mod piece;
mod watch;

use branch::Pieces;
pub(super) use course::{Course, Stuck, Task};
pub(super) use lanes::Lanes;

use super::beat::CellBeat;
use super::cell_model::{Adaptive, AdaptiveSteps, CellModel as _};
use super::description::Input;
use super::minimal::{MinimalModel, STATES};
use super::pacing::{Protocol, same_instant};
use super::reference::{REFERENCE_BEAT_MS, ReferenceBeat};
use super::settings::{self, SolveError, validate_time};
use super::trace::{CellTrace, Instant};
use super::upstroke::Upstroke;

/// Numerical settings of the adaptive method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveSettings {
    /// Largest error of a step over the size of each variable, dimensionless; default 1e-5.
    pub tolerance: f64,
}

impl Default for AdaptiveSettings {
    fn default() -> Self {
        Self { tolerance: 1e-5 }
    }
}

impl AdaptiveSettings {
    /// Checks the tolerance.
    ///
    /// # Errors
    /// A tolerance outside [`settings::SolverSettings::TOLERANCES`].
    pub fn validate(&self) -> Result<(), SolveError> {
        let Self { tolerance } = *self;
        settings::SolverSettings { tolerance, ..settings::SolverSettings::default() }.validate()
    }
}

/// A cell on its way through time, with steps of its own choice.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, pacing::Protocol};
/// use myospring::cell::adaptive::{AdaptiveIntegrator, AdaptiveSettings};
///
/// let model = coelho_2021::model();
/// let protocol = Protocol::once(model.default_stimulus());
/// let mut cell = AdaptiveIntegrator::new(&model, protocol, AdaptiveSettings::default())?;
/// cell.advance_to(49.0)?;
/// assert_eq!(cell.state()[0], 0.00195313); // slides along theta_w, to the last bit
/// cell.advance_to(60.0)?;
/// assert!(cell.state()[0] > 0.9 && cell.steps() < 200);
/// # Ok::<(), myospring::cell::solve::SolveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct AdaptiveIntegrator {
    model: &'static str,
    lanes: Lanes<1>,
    course: Course,
    time_ms: f64,
    state: [f64; 6],
    upstroke: Upstroke,
}

impl AdaptiveIntegrator {
    /// A cell in its initial state at 0 ms, after whatever the protocol does at 0 ms.
    ///
    /// # Errors
    /// An invalid protocol, or a tolerance out of range.
    pub fn new(
        model: &MinimalModel,
        protocol: Protocol,
        settings: AdaptiveSettings,
    ) -> Result<Self, SolveError> {
        Self::until(model, protocol, settings, f64::INFINITY)
    }

    fn until(
        model: &MinimalModel,
        protocol: Protocol,
        settings: AdaptiveSettings,
        duration_ms: f64,
    ) -> Result<Self, SolveError> {
        Self::from(&task(model, protocol, duration_ms, None), model, settings)
    }

    /// Like [`AdaptiveIntegrator::new`], from a given state.
    pub(super) fn starting_from(
        model: &MinimalModel,
        initial_state: [f64; 6],
        protocol: Protocol,
        settings: AdaptiveSettings,
    ) -> Result<Self, SolveError> {
        let task = Task { initial_state, ..task(model, protocol, f64::INFINITY, None) };
        Self::from(&task, model, settings)
    }

    fn from(
        task: &Task,
        model: &MinimalModel,
        settings: AdaptiveSettings,
    ) -> Result<Self, SolveError> {
        task.protocol.validate()?;
        settings.validate()?;
        let mut lanes = Lanes::new(settings.tolerance);
        let course = Course::start(task, &mut lanes, 0);
        let state = Lanes::get(&lanes.state, 0);
        let (name, upstroke) = (model.identity().name, Upstroke::new(model));
        Ok(Self { model: name, lanes, course, time_ms: 0.0, state, upstroke })
    }

    /// Time reached, ms.
    pub fn time(&self) -> f64 {
        self.time_ms
    }

    /// The state at that time, in the order of the model's states.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Steps taken so far; the last may end after [`Self::time`].
    pub fn steps(&self) -> u64 {
        self.lanes.taken[0] + self.course.steps
    }

    /// Number of rejected steps so far.
    pub fn refused(&self) -> u64 {
        self.lanes.refused[0]
    }

    /// Moves on to time `t_ms`.
    ///
    /// # Errors
    /// A time before the one reached or not finite, or a cell for which no step succeeds; the
    /// integrator cannot be used afterwards.
    pub fn advance_to(&mut self, t_ms: f64) -> Result<(), SolveError> {
        if !t_ms.is_finite() || (t_ms < self.time_ms && !same_instant(t_ms, self.time_ms)) {
            return Err(SolveError::BackInTime { target_ms: t_ms, time_ms: self.time_ms });
        }
        self.lanes.sample[0] = t_ms;
        while self.lanes.time[0] < t_ms && !same_instant(self.lanes.time[0], t_ms) {
            self.step()?;
        }
        self.state = if same_instant(self.lanes.time[0], t_ms) {
            Lanes::get(&self.lanes.state, 0)
        } else {
            self.course.piece.state_at(t_ms)
        };
        self.time_ms = t_ms;
        Ok(())
    }

    /// Makes one step; true if the run has reached its end.
    fn step(&mut self) -> Result<bool, SolveError> {
        let (since_ms, stimulus) = self.course.since_stimulus(self.lanes.time[0]);
        self.upstroke.see(since_ms, &Lanes::get(&self.lanes.rates, 0), stimulus);
        self.lanes.try_step();
        if self.lanes.attention[0] == 0 {
            return Ok(false);
        }
        self.course.attend(&mut self.lanes, 0).map_err(|stuck| stalled(self.model, &stuck))
    }
}

impl AdaptiveSteps for AdaptiveIntegrator {
    fn time(&self) -> f64 {
        Self::time(self)
    }

    fn state(&self) -> &[f64] {
        Self::state(self)
    }

    fn advance_to(&mut self, t_ms: f64) -> Result<(), SolveError> {
        Self::advance_to(self, t_ms)
    }

    fn steepest_rise(&self) -> Option<f64> {
        self.upstroke.steepest()
    }

    fn boxed(&self) -> Box<dyn AdaptiveSteps> {
        Box::new(self.clone())
    }
}

impl Adaptive for MinimalModel {
    fn start(
        &self,
        state: &[f64],
        protocol: Protocol,
        tolerance: f64,
    ) -> Result<Box<dyn AdaptiveSteps>, SolveError> {
        let state = std::array::from_fn(|place| state[place]);
        let settings = AdaptiveSettings { tolerance };
        Ok(Box::new(AdaptiveIntegrator::starting_from(self, state, protocol, settings)?))
    }
}

/// Runs a cell from 0 ms to `duration_ms` and samples it every `sample_interval_ms`, first at 0 ms:
/// [`solve::solve`](super::solve::solve) with adaptive steps.
///
/// # Errors
/// An invalid protocol, tolerance, duration or interval; a cell for which no step succeeds.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, adaptive, coelho_2021, pacing::Protocol};
/// let model = coelho_2021::model();
/// let beat = Protocol::once(model.default_stimulus());
/// let trace = adaptive::solve(&model, beat, adaptive::AdaptiveSettings::default(), 600.0, 0.1)?;
/// assert!((trace.peak_tension().unwrap().time - 171.56).abs() < 0.01);
/// # Ok::<(), myospring::cell::solve::SolveError>(())
/// ```
pub fn solve(
    model: &MinimalModel,
    protocol: Protocol,
    settings: AdaptiveSettings,
    duration_ms: f64,
    sample_interval_ms: f64,
) -> Result<CellTrace, SolveError> {
    validate_time("duration", duration_ms)?;
    let mut cell = AdaptiveIntegrator::until(model, protocol, settings, duration_ms)?;
    CellTrace::sample(model, duration_ms, sample_interval_ms, |time_ms| {
        cell.advance_to(time_ms)?;
        Ok(Instant { state: cell.state.to_vec(), input: Input::REST, outputs: Vec::new() })
    })
}

/// Runs a cell from 0 ms to `duration_ms` and returns its beats, one per stimulus, in order.
///
/// Peaks and durations are read from the cubics between the steps, so they have the accuracy of the
/// solution and do not depend on a sampling grid.
///
/// # Errors
/// An invalid protocol, tolerance or duration; a cell for which no step succeeds.
pub fn beats(
    model: &MinimalModel,
    protocol: Protocol,
    settings: AdaptiveSettings,
    duration_ms: f64,
) -> Result<Vec<CellBeat>, SolveError> {
    validate_time("duration", duration_ms)?;
    let mut cell = AdaptiveIntegrator::until(model, protocol, settings, duration_ms)?;
    while !cell.step()? {}
    Ok(cell.course.watch.beats)
}

/// One default beat: [`solve::reference_beat`](super::solve::reference_beat) with adaptive steps.
///
/// # Errors
/// As [`beats`], or tension without a positive peak inside the beat.
pub fn reference_beat(
    model: &MinimalModel,
    settings: AdaptiveSettings,
) -> Result<ReferenceBeat, SolveError> {
    let protocol = Protocol::once(model.default_stimulus());
    let beats = beats(model, protocol, settings, REFERENCE_BEAT_MS)?;
    let peak = beats.last().map(|beat| (beat.peak_tension, beat.peak_tension_ms));
    ReferenceBeat::of(model, peak, REFERENCE_BEAT_MS)
}

/// Describes a cell to be integrated.
pub(super) fn task(
    model: &MinimalModel,
    protocol: Protocol,
    duration_ms: f64,
    sample_interval_ms: Option<f64>,
) -> Task {
    Task {
        pieces: Pieces::new(*model.electrical_constants(), *model.tension_constants()),
        initial_state: MinimalModel::INITIAL_STATE,
        protocol,
        duration_ms,
        sample_interval_ms,
    }
}

/// Turns a failure into an error of a model, with the variable that is not finite, if there is one.
pub(super) fn stalled(model: &'static str, stuck: &Stuck) -> SolveError {
    let Stuck { time_ms, step_ms, state } = *stuck;
    let worst = state.iter().position(|value| !value.is_finite()).unwrap_or(0);
    let variable = STATES[worst].name.to_string();
    SolveError::Stalled { model: model.to_owned(), variable, value: state[worst], time_ms, step_ms }
}
