//! The myofilaments as a cell model with prescribed calcium.

use super::myofilaments::{Myofilaments, STATES, states};
use super::parameters::rows;
use crate::cell::calcium::{self, Calcium, CalciumTrace, TwoExponential};
use crate::cell::cell_model::{CellModel, Filaments, InFits};
use crate::cell::description::{
    Input, ModelError, Output, StateVariable, Stimulation, TensionKind,
};
use crate::cell::pacing::Stimulus;
use crate::cell::settings::{CellMethod, SolverSettings};
use crate::parameter::ParameterSet;
use std::borrow::Cow;
use std::sync::Arc;

const NAME: &str = "land_2017";

/// A faster `k_ws`, a higher calcium sensitivity and a stronger tension have similar effects on the
/// curve, which determines only two of them.
pub(in crate::cell) const IN_FITS: InFits<'static> =
    InFits { strength: Some("T_ref"), usual: &["k_ws"], not_together: &["Ca50_ref", "k_ws"] };

static OUTPUTS: [Output; 1] = [Output {
    name: Cow::Borrowed("Ca_i"),
    unit: Cow::Borrowed("uM"),
    meaning: Cow::Borrowed("prescribed calcium in the cytosol"),
}];

/// A cell with prescribed calcium, which restarts at each stimulus and does not depend on the
/// myofilaments.
///
/// It has no membrane and no potential. Tension is in kPa and follows stretch and its rate.
///
/// # Example
/// ```
/// use myospring::cell::land_2017::Land2017;
/// use myospring::cell::solve::{self, SolverSettings};
/// // Held at resting length.
/// let beat = solve::reference_beat(&Land2017::published(), SolverSettings::default())?;
/// assert!((20.0..30.0).contains(&beat.peak_tension)); // kPa
/// # Ok::<(), myospring::cell::solve::SolveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Land2017 {
    parameters: ParameterSet,
    myofilaments: Myofilaments,
    calcium: Calcium,
    states: Vec<StateVariable>,
}

impl Land2017 {
    /// The model with the published parameters, and calcium by two exponentials.
    pub fn published() -> Self {
        let parameters = [rows(), calcium::rows()].concat();
        match Self::new(ParameterSet::new(parameters)) {
            Ok(model) => model,
            Err(error) => unreachable!("published set: {error}"),
        }
    }

    /// The model with other parameters, and calcium by two exponentials.
    ///
    /// # Errors
    /// A parameter is missing, or they contradict each other.
    pub fn new(parameters: ParameterSet) -> Result<Self, ModelError> {
        let calcium = Calcium::TwoExponential(TwoExponential::of(NAME, &parameters)?);
        Self::of(parameters, calcium)
    }

    /// The same myofilaments with calcium from a trace; the parameters of the two exponentials are
    /// removed.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::CellModel;
    /// use myospring::cell::calcium::CalciumTrace;
    /// use myospring::cell::land_2017::Land2017;
    /// let trace = CalciumTrace::new(&[0.0, 60.0, 400.0], &[0.07, 0.5, 0.07])?;
    /// let model = Land2017::published().with_trace(trace);
    /// assert_eq!(model.parameters().get("Ca_rest"), None);
    /// # Ok::<(), myospring::cell::calcium::TraceError>(())
    /// ```
    #[must_use]
    pub fn with_trace(&self, trace: CalciumTrace) -> Self {
        let own = calcium::rows();
        let rows = self.parameters.rows().iter();
        let kept = rows.filter(|row| own.iter().all(|other| other.name != row.name)).cloned();
        let parameters = ParameterSet::new(kept.collect());
        Self::from_parts(parameters, self.myofilaments, Calcium::Trace(trace))
    }

    fn of(parameters: ParameterSet, calcium: Calcium) -> Result<Self, ModelError> {
        let myofilaments = Myofilaments::new(NAME, &parameters)?;
        Ok(Self::from_parts(parameters, myofilaments, calcium))
    }

    fn from_parts(parameters: ParameterSet, myofilaments: Myofilaments, calcium: Calcium) -> Self {
        let states = states(myofilaments.steady(calcium.rest(), 1.0));
        Self { parameters, myofilaments, calcium, states }
    }

    /// Its equations.
    pub fn myofilaments(&self) -> &Myofilaments {
        &self.myofilaments
    }

    /// Its calcium.
    pub fn calcium(&self) -> &Calcium {
        &self.calcium
    }
}

/// The state as an array for the equations.
fn six(state: &[f64]) -> [f64; STATES] {
    std::array::from_fn(|i| state[i])
}

impl CellModel for Land2017 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Human myofilaments that depend on length and speed, as in Land et al. 2017, with prescribed calcium"
    }

    fn citations(&self) -> Vec<&str> {
        vec!["land_2017", "margara_2021"]
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(match &self.calcium {
            Calcium::TwoExponential(_) => Self::new(parameters)?,
            trace @ Calcium::Trace(_) => Self::of(parameters, trace.clone())?,
        }))
    }

    fn states(&self) -> &[StateVariable] {
        &self.states
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        let calcium = self.calcium.at(input.since_stimulus_ms);
        let Input { stretch, stretch_rate, .. } = *input;
        let found = self.myofilaments.rates(&six(state), calcium, stretch, stretch_rate);
        rates.copy_from_slice(&found);
    }

    fn stimulation(&self) -> Stimulation {
        // The stimulus starts calcium and changes no state.
        Stimulation {
            default: Stimulus::Jump { amplitude: 0.0 },
            current_unit: Cow::Borrowed("1/ms"),
            moves: Cow::Borrowed(&[]),
        }
    }

    fn potential(&self, _state: &[f64]) -> Option<f64> {
        None
    }

    fn membrane_potential_mv(&self, _state: &[f64]) -> Option<f64> {
        None
    }

    fn tension(&self, state: &[f64], input: &Input) -> f64 {
        self.myofilaments.tension(&six(state), input.stretch)
    }

    fn tension_kind(&self) -> TensionKind {
        TensionKind::Kilopascal
    }

    fn outputs(&self) -> &[Output] {
        &OUTPUTS
    }

    fn write_outputs(&self, _state: &[f64], input: &Input, values: &mut [f64]) {
        values[0] = self.calcium.at(input.since_stimulus_ms);
    }

    fn recorded_states(&self) -> &[usize] {
        const { &[0, 1, 2, 3, 4, 5] }
    }

    fn calcium_um(&self, _state: &[f64], input: &Input) -> Option<f64> {
        Some(self.calcium.at(input.since_stimulus_ms))
    }

    fn with_calcium(&self, course: &CalciumTrace) -> Option<Arc<dyn CellModel>> {
        Some(Arc::new(self.with_trace(course.clone())))
    }

    fn filaments(&self) -> Option<Filaments<'_>> {
        let Self { myofilaments, calcium, .. } = self;
        Some(Filaments { equations: myofilaments, first: 0, calcium: Some(calcium) })
    }

    fn in_fits(&self) -> InFits<'_> {
        IN_FITS
    }

    fn feels_stretch(&self) -> bool {
        true
    }

    fn usual_settings(&self) -> SolverSettings {
        // Its fastest rate is below 1 per ms, and its equations do not jump.
        SolverSettings { step_ms: 0.05, ..SolverSettings::of(CellMethod::RungeKutta4) }
    }
}
