//! A toy model with known tension, for tests of code that is coupled to a cell.
//!
//! Two linear equations in a chain. A jump `a` of `u` at time 0 makes tension an alpha function
//! with its peak `a / e` after one time constant:
//! ```text
//! du/dt  = -u / tau          u(t)  = a exp(-t / tau)
//! dTa/dt = (u - Ta) / tau    Ta(t) = a (t / tau) exp(-t / tau)
//! ```

use super::cell_model::CellModel;
use super::description::{
    Input, KnownDeparture, ModelError, StateVariable, Stimulation, TensionKind, required,
};
use super::pacing::Stimulus;
use crate::parameter::{Parameter, ParameterSet};
use std::borrow::Cow;
use std::sync::Arc;

const NAME: &str = "toy_alpha";

static STATES: [StateVariable; 2] = [
    StateVariable {
        name: Cow::Borrowed("u"),
        unit: Cow::Borrowed(""),
        start: 0.0,
        meaning: Cow::Borrowed("potential"),
    },
    StateVariable {
        name: Cow::Borrowed("Ta"),
        unit: Cow::Borrowed(""),
        start: 0.0,
        meaning: Cow::Borrowed("active tension"),
    },
];

/// The toy model: two linear equations, one parameter.
///
/// # Example
/// ```
/// use myospring::cell::solve::{self, SolverSettings};
/// use myospring::cell::toy::ToyModel;
/// let toy = ToyModel::published();
/// let beat = solve::reference_beat(&toy, SolverSettings::default())?;
/// assert!((beat.peak_tension - (-1.0_f64).exp()).abs() < 1e-6);
/// assert!((toy.tension_after_jump(1.0, 50.0) - (-1.0_f64).exp()).abs() < 1e-15);
/// # Ok::<(), myospring::cell::solve::SolveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ToyModel {
    parameters: ParameterSet,
    tau: f64,
}

/// Its parameters: the time constant, 50 ms.
pub fn parameters() -> ParameterSet {
    let meaning = "time constant, and time to peak";
    let tau = Parameter::new("tau", 50.0, "ms", [1e-3, 1e6], meaning, "chosen for tests");
    ParameterSet::new(vec![tau])
}

impl ToyModel {
    /// The model with a time constant of 50 ms.
    pub fn published() -> Self {
        Self { parameters: parameters(), tau: 50.0 }
    }

    /// The model with other parameters.
    ///
    /// # Errors
    /// The set lacks `tau`.
    pub fn new(parameters: ParameterSet) -> Result<Self, ModelError> {
        let tau = required(NAME, &parameters, "tau")?;
        Ok(Self { parameters, tau })
    }

    /// Exact tension at time `t_ms` after a jump of the resting cell: `a (t / tau) exp(-t / tau)`.
    pub fn tension_after_jump(&self, amplitude: f64, t_ms: f64) -> f64 {
        let x = (t_ms / self.tau).max(0.0);
        amplitude * x * (-x).exp()
    }
}

impl CellModel for ToyModel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Two linear equations with a known tension, for tests; not a heart cell"
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self::new(parameters)?))
    }

    fn states(&self) -> &[StateVariable] {
        &STATES
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        // du/dt = -u / tau
        rates[0] = -state[0] / self.tau + input.stimulus;
        // dTa/dt = (u - Ta) / tau
        rates[1] = (state[0] - state[1]) / self.tau;
    }

    fn stimulation(&self) -> Stimulation {
        Stimulation::of_first_state(Stimulus::Jump { amplitude: 1.0 })
    }

    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }

    fn membrane_potential_mv(&self, _state: &[f64]) -> Option<f64> {
        None
    }

    fn tension(&self, state: &[f64], _input: &Input) -> f64 {
        state[1]
    }

    fn tension_kind(&self) -> TensionKind {
        // a / e, with the amplitude 1 of the default stimulus
        TensionKind::Relative { published_peak: (-1.0_f64).exp() }
    }

    fn known_departure(&self) -> Option<KnownDeparture> {
        Some(KnownDeparture {
            shortening_rate_over_peak: 62.1,
            fact: Cow::Borrowed(
                "This model is an example, whose tension rises faster than measured cells",
            ),
            instead: Cow::Borrowed("land_2017"),
        })
    }
}
