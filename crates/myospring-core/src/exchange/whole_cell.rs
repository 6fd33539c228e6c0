//! A cell model as the activation of a whole cell.

use super::crossbridges::Crossbridges;
use super::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use crate::cell::{CellModel, Input, Output, StateVariable};
use crate::mechanics::Tension;
use crate::recording::{CALCIUM, STEEPEST_RISE};
use std::borrow::Cow;
use std::sync::Arc;

/// One cell model for the whole cell.
#[derive(Clone)]
pub struct WholeCell {
    kept: CellIntegrator,
    moved: CellIntegrator,
    /// Stretch and rate at the current time.
    input: Input,
    /// Crossbridges that are followed apart from the rest of the cell, which then goes on but once an interval.
    crossbridges: Option<Crossbridges>,
    /// kPa per unit of the model's tension.
    scale: f64,
    strongest: ActivationBounds,
    feels_stretch: bool,
    /// Stretch of the model in the cell at rest.
    resting_stretch: f64,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
}

impl WholeCell {
    /// Creates a cell in this state at 0 ms, by default the initial one, with its bounds; `scale` is in kPa per unit
    /// of the model's tension.
    ///
    /// # Errors
    /// A protocol or settings that the model cannot follow, and a state that does not fit it.
    pub fn new(
        model: Arc<dyn CellModel>,
        state: Option<&[f64]>,
        protocol: Protocol,
        settings: SolverSettings,
        scale: f64,
        strongest: ActivationBounds,
    ) -> Result<Self, SolveError> {
        let feels_stretch = model.feels_stretch();
        let stimulus_times_ms = protocol.stimulus_times().collect();
        let s2_ms = protocol.s2_ms();
        let state = state.map_or_else(|| model.initial_state(), <[f64]>::to_vec);
        let kept = CellIntegrator::starting_from(model, &state, protocol, settings)?;
        Ok(Self {
            moved: kept.clone(),
            kept,
            input: Input::REST,
            crossbridges: None,
            scale,
            strongest,
            feels_stretch,
            resting_stretch: 1.0,
            stimulus_times_ms,
            s2_ms,
        })
    }

    /// Returns the same with this stretch of the model in the cell at rest; all other stretches are
    /// multiplied by it.
    #[must_use]
    pub fn at_resting_stretch(self, resting_stretch: f64) -> Self {
        Self { resting_stretch, ..self }
    }

    /// The state that it was moved to.
    fn state(&self) -> Cow<'_, [f64]> {
        match &self.crossbridges {
            Some(crossbridges) => crossbridges.state(&self.moved).into(),
            None => self.moved.state().into(),
        }
    }
}

/// Returns the further outputs of a cell model: its outputs, recorded states, and calcium if it is
/// not one of these.
pub(super) fn told_by(model: &dyn CellModel) -> Vec<Output> {
    let states = model.recorded_states().iter().map(|&place| {
        let StateVariable { name, unit, meaning, .. } = model.states()[place].clone();
        Output { name, unit, meaning }
    });
    let mut told: Vec<Output> = model.outputs().iter().cloned().chain(states).collect();
    if tells_calcium_besides(model) {
        let meaning = "free calcium in the cytosol".into();
        told.push(Output { name: CALCIUM.into(), unit: "uM".into(), meaning });
    }
    told
}

/// Returns the values of these outputs.
pub(super) fn told(cell: &CellIntegrator, state: &[f64]) -> Vec<f64> {
    let mut values = cell.outputs();
    values.extend(cell.model().recorded_states().iter().map(|&place| state[place]));
    values.extend(cell.calcium_um().filter(|_| tells_calcium_besides(&**cell.model())));
    values
}

/// Whether a model has calcium that is neither an output nor a recorded state.
fn tells_calcium_besides(model: &dyn CellModel) -> bool {
    let is_output = || model.outputs().iter().any(|output| output.name == CALCIUM);
    let is_state = || model.recorded_states().iter().any(|&at| model.states()[at].name == CALCIUM);
    let state = model.initial_state();
    model.calcium_um(&state, &Input::REST).is_some() && !is_output() && !is_state()
}

impl Activation for WholeCell {
    fn sites(&self) -> Sites {
        Sites::Whole
    }

    fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError> {
        let failed = |error: SolveError| ActivationError(error.to_string());
        let [stretch, rate] = [now.stretch[0], now.rate[0]].map(|of| self.resting_stretch * of);
        self.input = Input { stretch, stretch_rate: rate, ..Input::REST };
        if let Some(crossbridges) = &mut self.crossbridges {
            return crossbridges
                .advance(&self.kept, &mut self.moved, to_ms, stretch)
                .map_err(failed);
        }
        self.moved.clone_from(&self.kept);
        // Stretch in the middle of the interval; a linear course is accurate to second order.
        let middle = stretch - 0.5 * rate * (to_ms - self.kept.time());
        self.moved.advance_to(to_ms, middle, rate).map_err(failed)
    }

    fn keep(&mut self) {
        self.kept.clone_from(&self.moved);
        if let Some(crossbridges) = &mut self.crossbridges {
            crossbridges.keep(self.input.stretch);
        }
    }

    fn tension(&self) -> Tension<'_> {
        let Input { stretch, stretch_rate, .. } = self.input;
        let input = Input { stretch, stretch_rate, ..self.moved.input() };
        let tension = self.moved.model().tension(&self.state(), &input);
        Tension::Uniform(self.scale * tension)
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        self.feels_stretch.then_some(ActivationTangent { per_stretch: &[], per_rate: &[] })
    }

    fn strongest(&self) -> ActivationBounds {
        self.strongest
    }

    fn at_equilibria(&mut self) {
        self.crossbridges = Crossbridges::of(&self.kept);
    }

    fn potential(&self) -> Option<f64> {
        self.moved.model().potential(self.moved.state())
    }

    fn membrane_potential_mv(&self) -> Option<f64> {
        self.moved.model().membrane_potential_mv(self.moved.state())
    }

    fn stimulus_times_ms(&self) -> Vec<f64> {
        self.stimulus_times_ms.clone()
    }

    fn s2_ms(&self) -> Option<f64> {
        self.s2_ms
    }

    fn outputs(&self) -> Vec<Output> {
        let model = &**self.moved.model();
        let state = model.initial_state();
        let mut told = told_by(model);
        if model.potential(&state).is_some() {
            let in_mv = model.membrane_potential_mv(&state).is_some();
            let unit = if in_mv { "mV/ms" } else { "1/ms" };
            let meaning = "largest rate of the potential since the last stimulus".into();
            told.push(Output { name: STEEPEST_RISE.into(), unit: unit.into(), meaning });
        }
        told
    }

    fn output_values(&self) -> Vec<f64> {
        let mut values = told(&self.moved, &self.state());
        let model = self.moved.model();
        if model.potential(self.moved.state()).is_some() {
            values.push(self.moved.steepest_rise().unwrap_or(0.0));
        }
        values
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}
