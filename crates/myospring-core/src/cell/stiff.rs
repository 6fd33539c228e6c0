//! Implicit adaptive steps for any model.
//!
//! # Method
//! Rosenbrock's method of order 4(3) in the form `RODAS` (`hairer_wanner_1996`, IV.7): L-stable, so
//! stiff variables do not require small steps. It uses the model's Jacobian, or finite differences
//! of its rates. Each step is as long as its error estimate stays below `tolerance (floor +
//! |value|)` for every variable; the floor is 0.01 for a pure number, and a tenth of its start for
//! a variable with a unit (1e-4 if that start is below 1e-12). Between the ends of a step the state is the method's
//! own cubic.
//!
//! - A step ends exactly at each event of the protocol, and the step size begins anew from the rates.
//! - For a model that depends on stretch, a step ends exactly at each requested time, because the
//!   stretch may change there. For others, the requested times do not change the result.
//! - At a jump of the equations steps shrink until the error is small. The minimal model, which
//!   jumps at its thresholds and slides along them, is rejected: use [`adaptive`](super::adaptive)
//!   steps.
//!
//! `docs/explanation/cell-integration.md` compares its speed and error on a model of 40 states with those of a
//! library.

mod lu;
pub(super) mod rosenbrock;

use super::cell_model::CellModel;
use super::description::{Input, StateVariable};
use super::pacer::Pacer;
use super::pacing::same_instant;
use super::settings::SolveError;
use super::upstroke::Upstroke;
use rosenbrock::{Curve, Rosenbrock};

/// Floor of a dimensionless variable.
const FLOOR: f64 = 0.01;
/// Floor of a variable with a unit that starts at 0, or at less than [`NOTHING`].
const FLOOR_FROM_NOTHING: f64 = 1e-4;
/// Values below this say nothing of the size of a variable, in any usual unit.
const NOTHING: f64 = 1e-12;
/// Floor of a variable with a unit, as a part of its initial value.
const OF_START: f64 = 0.1;
/// Smallest and largest change of the step from one to the next.
pub(super) const SHRINK: f64 = 0.2;
pub(super) const GROW: f64 = 5.0;
/// Safety factor: the aimed error as a part of the tolerance.
pub(super) const SAFETY: f64 = 0.9;
/// First step after an event, as a part of the step that the tolerance would allow for a straight
/// line.
const RESTART: f64 = 0.3;
/// The longest step, ms.
pub(super) const LONGEST_MS: f64 = 25.0;
/// If a step below this is rejected, ms, integration fails.
pub(super) const SHORTEST_MS: f64 = 1e-12;

/// Floor in the scale of a variable's error.
pub(super) fn floor(variable: &StateVariable) -> f64 {
    let start = variable.start.abs();
    if variable.unit.is_empty() {
        FLOOR
    } else if start < NOTHING {
        FLOOR_FROM_NOTHING
    } else {
        OF_START * start
    }
}

/// The first step after an event, times the largest relative rate.
pub(super) fn restart(tolerance: f64) -> f64 {
    RESTART * tolerance.powf(0.25)
}

/// The integration of a cell in implicit steps.
#[derive(Debug, Clone)]
pub(super) struct StiffSteps {
    tolerance: f64,
    floors: Vec<f64>,
    /// Whether the stretch may change at each requested time.
    stretch_varies: bool,
    pacer: Pacer,
    rosenbrock: Rosenbrock,
    /// The last step.
    piece: Option<Piece>,
    /// End of the last step, ms, after events.
    end_ms: f64,
    end: Vec<f64>,
    /// The step to try next, ms; `None` after an event.
    step_ms: Option<f64>,
    /// The requested time, ms, and the state there.
    time_ms: f64,
    state: Vec<f64>,
    upstroke: Upstroke,
}

/// An accepted step.
#[derive(Debug, Clone)]
struct Piece {
    start_ms: f64,
    step_ms: f64,
    curve: Curve,
}

impl StiffSteps {
    /// Starts in this state at 0 ms, after the protocol's events at 0 ms.
    pub(super) fn new(
        model: &dyn CellModel,
        mut state: Vec<f64>,
        mut pacer: Pacer,
        tolerance: f64,
    ) -> Self {
        pacer.act(0.0, &mut state);
        Self {
            tolerance,
            floors: model.states().iter().map(floor).collect(),
            stretch_varies: model.feels_stretch(),
            pacer,
            rosenbrock: Rosenbrock::new(state.len(), model.gates()),
            piece: None,
            end_ms: 0.0,
            end: state.clone(),
            step_ms: None,
            time_ms: 0.0,
            state,
            upstroke: Upstroke::new(model),
        }
    }

    /// Declares the stretch constant from now on, so that steps need not end at requested times.
    pub(super) fn hold(&mut self) {
        self.stretch_varies = false;
    }

    /// Time reached, ms.
    pub(super) fn time(&self) -> f64 {
        self.time_ms
    }

    /// The state at that time.
    pub(super) fn state(&self) -> &[f64] {
        &self.state
    }

    /// The largest rate of the potential since the last stimulus.
    pub(super) fn steepest_rise(&self) -> Option<f64> {
        self.upstroke.steepest()
    }

    /// Integrates to time `t_ms`; the stimulus in `input` is ignored.
    pub(super) fn advance_to(
        &mut self,
        model: &dyn CellModel,
        t_ms: f64,
        input: &Input,
    ) -> Result<(), SolveError> {
        if !t_ms.is_finite() || (t_ms < self.time_ms && !same_instant(t_ms, self.time_ms)) {
            return Err(SolveError::BackInTime { target_ms: t_ms, time_ms: self.time_ms });
        }
        let bound_ms = if self.stretch_varies { t_ms } else { f64::INFINITY };
        while self.end_ms < t_ms && !same_instant(self.end_ms, t_ms) {
            let stop_ms = self.pacer.next_ms().unwrap_or(f64::INFINITY).min(bound_ms);
            self.step(model, input, stop_ms)?;
        }
        self.state = match &self.piece {
            Some(piece) if !same_instant(self.end_ms, t_ms) => {
                piece.curve.at((t_ms - piece.start_ms) / piece.step_ms)
            }
            _ => self.end.clone(),
        };
        self.time_ms = t_ms;
        Ok(())
    }

    /// Makes one step that ends at or before `stop_ms`.
    fn step(
        &mut self,
        model: &dyn CellModel,
        input: &Input,
        stop_ms: f64,
    ) -> Result<(), SolveError> {
        let input = Input { stimulus: self.pacer.current(), ..*input };
        self.rosenbrock.begin(model, &self.end, &input, &self.floors);
        let since_ms = self.pacer.since_stimulus(self.end_ms);
        self.upstroke.see(since_ms, self.rosenbrock.rates(), input.stimulus);
        let mut planned = self.step_ms.unwrap_or_else(|| self.first_step());
        loop {
            // No tiny rest is left before the stop.
            let to_stop = self.end_ms + 1.01 * planned >= stop_ms;
            let step_ms = if to_stop { stop_ms - self.end_ms } else { planned };
            let solved = self.rosenbrock.try_step(model, &self.end, &input, step_ms);
            let error = if solved { self.error() } else { f64::NAN };
            // The companion's error per step is of order 4.
            let factor = if error.is_nan() {
                SHRINK
            } else {
                (SAFETY * error.max(1e-12).powf(-0.25)).clamp(SHRINK, GROW)
            };
            if error <= 1.0 {
                let next = step_ms * factor;
                // A step shortened by the stop does not reduce the following step.
                let next = if to_stop { next.max(planned) } else { next };
                self.take(step_ms, if to_stop { stop_ms } else { self.end_ms + step_ms });
                self.step_ms = Some(next.min(LONGEST_MS));
                if self.pacer.act(self.end_ms, &mut self.end) {
                    self.step_ms = None;
                }
                return Ok(());
            }
            if step_ms < SHORTEST_MS || self.end_ms + step_ms == self.end_ms {
                return Err(self.stalled(model, step_ms));
            }
            planned = step_ms * factor;
        }
    }

    /// The first step after an event, from the rates.
    fn first_step(&self) -> f64 {
        let rates = self.rosenbrock.rates();
        let speed = (0..self.end.len())
            .map(|i| rates[i].abs() / (self.floors[i] + self.end[i].abs()))
            .fold(0.0, f64::max);
        (restart(self.tolerance) / speed).min(LONGEST_MS)
    }

    /// Error of the step that was tried relative to the tolerance; NaN if anything is NaN.
    fn error(&self) -> f64 {
        (0..self.end.len()).fold(0.0, |largest: f64, place| {
            let part = self.error_of(place);
            if part > largest || part.is_nan() { part } else { largest }
        })
    }

    /// The error of one variable.
    fn error_of(&self, place: usize) -> f64 {
        let (end, errors) = (self.rosenbrock.end(), self.rosenbrock.errors());
        let size = self.floors[place] + self.end[place].abs().max(end[place].abs());
        errors[place].abs() / (self.tolerance * size)
    }

    fn take(&mut self, step_ms: f64, end_ms: f64) {
        let curve = self.rosenbrock.curve(&self.end);
        self.piece = Some(Piece { start_ms: self.end_ms, step_ms, curve });
        self.end.copy_from_slice(self.rosenbrock.end());
        self.end_ms = end_ms;
    }

    fn stalled(&self, model: &dyn CellModel, step_ms: f64) -> SolveError {
        let end = self.rosenbrock.end();
        let largest =
            || (0..end.len()).max_by(|a, b| self.error_of(*a).total_cmp(&self.error_of(*b)));
        let worst = end.iter().position(|value| !value.is_finite());
        let worst = worst.or_else(largest).unwrap_or(0);
        SolveError::Stalled {
            model: model.name().to_owned(),
            variable: model.states()[worst].name.to_string(),
            value: end[worst],
            time_ms: self.end_ms,
            step_ms,
        }
    }
}
