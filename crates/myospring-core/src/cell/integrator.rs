//! Integrates one cell in time, alone or inside a coupled simulation.

use super::cell_model::{AdaptiveSteps, CellModel};
use super::description::Input;
use super::fixed::{FixedSteps, Scheme};
use super::pacer::Pacer;
use super::pacing::Protocol;
use super::settings::{CellMethod, SolveError, SolverSettings};
use super::stiff::StiffSteps;
use std::sync::Arc;

/// The integration of a cell by any method.
///
/// It owns its model, so it can be sent to a thread; a clone may be advanced on trial and
/// discarded. The state at a time includes every event up to and at that time.
///
/// Fixed steps lie on the grid `n step` from 0 ms, computed as a product (not a running sum), and
/// are cut exactly at the events of the protocol and at requested times. Times within a millionth
/// of a step are the same time, so rounding neither misses nor doubles an event, and no tiny step
/// is taken. Advancing to a multiple of the step in many calls or in one gives bitwise the same
/// result. Results of methods with adaptive steps do not depend on how often the state is
/// requested, unless the model depends on stretch.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, integrator::CellIntegrator, solve::SolverSettings};
/// use myospring::cell::pacing::Protocol;
/// use std::sync::Arc;
///
/// let model = coelho_2021::model();
/// let protocol = Protocol::once(model.default_stimulus());
/// let mut cell = CellIntegrator::new(Arc::new(model), protocol, SolverSettings::default())?;
/// for step in 1..=60 {
///     cell.advance_to(f64::from(step), 1.0, 0.0)?; // at resting length, which does not change
/// }
/// assert!(cell.model().potential(cell.state()).is_some_and(|u| u > 0.9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct CellIntegrator {
    model: Arc<dyn CellModel>,
    steps: Steps,
}

impl CellIntegrator {
    /// A cell in its initial state at 0 ms, after the protocol's events at 0 ms.
    ///
    /// # Errors
    /// An invalid protocol, a step that is not a positive finite time, a tolerance out of range, or
    /// a method that does not suit the model.
    pub fn new(
        model: Arc<dyn CellModel>,
        protocol: Protocol,
        settings: SolverSettings,
    ) -> Result<Self, SolveError> {
        let state = model.initial_state();
        Self::starting_from(model, &state, protocol, settings)
    }

    /// Like [`CellIntegrator::new`], from another state at 0 ms, in the order of the model's
    /// states.
    ///
    /// # Errors
    /// Also a state with another number of values, or with values that are not finite.
    pub fn starting_from(
        model: Arc<dyn CellModel>,
        state: &[f64],
        protocol: Protocol,
        settings: SolverSettings,
    ) -> Result<Self, SolveError> {
        let (found, expected) = (state.len(), model.states().len());
        if found != expected || state.iter().any(|value| !value.is_finite()) {
            return Err(SolveError::StartState { model: model.name().to_owned(), found, expected });
        }
        Ok(Self { steps: Steps::starting_from(&*model, state, protocol, settings)?, model })
    }

    /// Time reached, ms.
    pub fn time(&self) -> f64 {
        self.steps.time()
    }

    /// The state at that time, in the order of the model's states.
    pub fn state(&self) -> &[f64] {
        self.steps.state()
    }

    /// The model's outputs at that time, in their order.
    pub fn outputs(&self) -> Vec<f64> {
        self.steps.outputs(&*self.model)
    }

    /// The input at that time, with the last stretch.
    pub(crate) fn input(&self) -> Input {
        self.steps.input()
    }

    /// Free calcium in the cytosol at that time, uM, if the model has it.
    pub fn calcium_um(&self) -> Option<f64> {
        self.model.calcium_um(self.state(), &self.steps.input())
    }

    /// The largest rate of the potential since the last stimulus, without the current of the
    /// stimulus: mV/ms if the model defines millivolts, else in the unit of the potential per ms;
    /// from the rates at every step.
    pub fn steepest_rise(&self) -> Option<f64> {
        let rate = self.steps.steepest_rise()?;
        // The potential in mV is a linear function of the variable.
        let (rest, place) =
            (self.model.initial_state(), self.model.stimulation().moves.first()?.state);
        let mut higher = rest.clone();
        higher[place] += 1.0;
        let millivolts = |state: &[f64]| self.model.membrane_potential_mv(state);
        let slope = millivolts(&higher).zip(millivolts(&rest)).map(|(to, from)| to - from);
        Some(slope.unwrap_or(1.0) * rate)
    }

    /// Whether its steps are fixed, so that others may change its state between them.
    pub(crate) fn has_fixed_steps(&self) -> bool {
        matches!(self.steps.way, Way::Fixed(_))
    }

    /// Sets a state variable, if the steps are fixed.
    pub(crate) fn set_state(&mut self, place: usize, value: f64) {
        if let Way::Fixed(steps) = &mut self.steps.way {
            steps.set_state(place, value);
        }
    }

    /// The model that is integrated.
    pub fn model(&self) -> &Arc<dyn CellModel> {
        &self.model
    }

    /// Integrates to time `t_ms` at constant `stretch` (length over resting length) and
    /// `stretch_rate` (1/ms).
    ///
    /// The time need not be a multiple of a fixed step. A time that differs from the time reached
    /// only by rounding does nothing.
    ///
    /// # Errors
    /// A time before the one reached or not finite, a stretch that is not a positive number, a rate
    /// of stretch that is not finite, a state variable that becomes NaN or infinite, or a cell for
    /// which no step succeeds; the integrator cannot be used afterwards.
    pub fn advance_to(
        &mut self,
        t_ms: f64,
        stretch: f64,
        stretch_rate: f64,
    ) -> Result<(), SolveError> {
        self.steps.advance_to(&*self.model, t_ms, stretch, stretch_rate)
    }
}

/// The integration state of a cell, without its model.
#[derive(Clone)]
pub(super) struct Steps {
    way: Way,
    protocol: Protocol,
    /// The last input.
    input: Input,
}

#[derive(Clone)]
enum Way {
    Fixed(Box<FixedSteps>),
    Adaptive(Box<dyn AdaptiveSteps>),
    Stiff(Box<StiffSteps>),
}

impl Steps {
    pub(super) fn new(
        model: &dyn CellModel,
        protocol: Protocol,
        settings: SolverSettings,
    ) -> Result<Self, SolveError> {
        Self::starting_from(model, &model.initial_state(), protocol, settings)
    }

    fn starting_from(
        model: &dyn CellModel,
        state: &[f64],
        protocol: Protocol,
        settings: SolverSettings,
    ) -> Result<Self, SolveError> {
        settings.validate()?;
        let pacer = Pacer::new(&model.stimulation(), protocol)?;
        let refuse = |reason, instead| SolveError::Unsuited {
            model: model.name().to_owned(),
            method: settings.method,
            reason,
            instead,
        };
        let for_any = "`runge-kutta-4`, or `stiff` if it needs tiny steps";
        let fixed = |scheme| {
            let steps =
                FixedSteps::new(model, state.to_vec(), scheme, pacer.clone(), settings.step_ms);
            Way::Fixed(Box::new(steps))
        };
        let way = match settings.method {
            CellMethod::RungeKutta4 => fixed(Scheme::RungeKutta4),
            CellMethod::ForwardEuler => fixed(Scheme::Euler { cuts: &[] }),
            CellMethod::StaggeredEuler if model.staggered_groups().is_empty() => {
                return Err(refuse("which serves the minimal model only", for_any));
            }
            CellMethod::StaggeredEuler => fixed(Scheme::Euler { cuts: model.staggered_groups() }),
            CellMethod::RushLarsen if model.gates().is_empty() => {
                return Err(refuse("which needs a model that names its gates", for_any));
            }
            CellMethod::RushLarsen => fixed(Scheme::RushLarsen),
            CellMethod::Adaptive => {
                let adaptive = model.adaptive();
                let adaptive = adaptive
                    .ok_or_else(|| refuse("which serves the minimal model only", for_any))?;
                Way::Adaptive(adaptive.start(state, protocol, settings.tolerance)?)
            }
            // Sliding along a threshold would need millions of steps.
            CellMethod::Stiff if model.jumps() => {
                let instead = match model.adaptive() {
                    Some(_) => "`adaptive`, which knows the jumps",
                    None => "`runge-kutta-4`",
                };
                return Err(refuse("whose steps shrink to nothing where equations jump", instead));
            }
            CellMethod::Stiff if model.stimulation().moves.is_empty() => {
                let reason = "whose steps do not support prescribed courses over time";
                return Err(refuse(reason, "`runge-kutta-4`"));
            }
            CellMethod::Stiff => {
                let tolerance = settings.tolerance;
                Way::Stiff(Box::new(StiffSteps::new(model, state.to_vec(), pacer, tolerance)))
            }
        };
        Ok(Self { way, protocol, input: Input::REST })
    }

    /// Declares the stretch constant from now on.
    pub(super) fn hold(&mut self) {
        if let Way::Stiff(steps) = &mut self.way {
            steps.hold();
        }
    }

    fn time(&self) -> f64 {
        match &self.way {
            Way::Fixed(steps) => steps.time(),
            Way::Adaptive(steps) => steps.time(),
            Way::Stiff(steps) => steps.time(),
        }
    }

    pub(super) fn state(&self) -> &[f64] {
        match &self.way {
            Way::Fixed(steps) => steps.state(),
            Way::Adaptive(steps) => steps.state(),
            Way::Stiff(steps) => steps.state(),
        }
    }

    fn steepest_rise(&self) -> Option<f64> {
        match &self.way {
            Way::Fixed(steps) => steps.steepest_rise(),
            Way::Adaptive(steps) => steps.steepest_rise(),
            Way::Stiff(steps) => steps.steepest_rise(),
        }
    }

    /// The input of the cell at the time reached.
    pub(super) fn input(&self) -> Input {
        let time_ms = self.time();
        Input {
            stimulus: self.protocol.current_at(time_ms),
            since_stimulus_ms: self.protocol.since_stimulus(time_ms),
            time_ms,
            ..self.input
        }
    }

    pub(super) fn outputs(&self, model: &dyn CellModel) -> Vec<f64> {
        let input = self.input();
        let mut values = vec![f64::NAN; model.outputs().len()];
        model.write_outputs(self.state(), &input, &mut values);
        values
    }

    pub(super) fn advance_to(
        &mut self,
        model: &dyn CellModel,
        t_ms: f64,
        stretch: f64,
        stretch_rate: f64,
    ) -> Result<(), SolveError> {
        if !(stretch.is_finite() && stretch > 0.0) {
            return Err(SolveError::Stretch { value: stretch, time_ms: self.time() });
        }
        if !stretch_rate.is_finite() {
            return Err(SolveError::StretchRate { value: stretch_rate, time_ms: self.time() });
        }
        self.input = Input { stretch, stretch_rate, ..Input::REST };
        match &mut self.way {
            Way::Fixed(steps) => steps.advance_to(model, t_ms, &self.input),
            Way::Adaptive(steps) => steps.advance_to(t_ms),
            Way::Stiff(steps) => steps.advance_to(model, t_ms, &self.input),
        }
    }
}
