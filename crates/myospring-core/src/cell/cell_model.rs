//! The trait of cell models: equations and optional capabilities.
//!
//! States, parameters and equations need not be known at compile time: a model may read them from a
//! file at run time. Capabilities of some models only, such as adaptive steps or prescribed
//! calcium, are methods of [`CellModel`] that return "no" by default. Code asks a model what it can
//! do, never which model it is.

use super::beat::CellBeat;
use super::calcium::{Calcium, CalciumTrace};
use super::description::{
    Gate, Input, KnownDeparture, ModelError, Output, StateVariable, Stimulation, TensionKind,
};
use super::equations::Equations;
use super::given_tension::{TensionClock, TensionCourse};
use super::land_2017::Myofilaments;
use super::pacing::{Protocol, Stimulus};
use super::settings::{CellMethod, SolveError, SolverSettings, validate_time};
use super::tension::Tension;
use crate::parameter::ParameterSet;
use std::any::Any;
use std::sync::Arc;

/// A cell model: ordinary differential equations from stimulus to active tension.
///
/// A model of your own need not be registered: every function with a cell model accepts any
/// `Arc<dyn CellModel>`. `testing::cell_model::check_cell_model` (feature `testing`) checks
/// everything that this trait promises.
pub trait CellModel: Any + Send + Sync {
    /// Name in a run file: `coelho_2021`.
    fn name(&self) -> &str;
    /// Description in one line.
    fn description(&self) -> &str;
    /// The parameters with unit, range and source.
    fn parameters(&self) -> &ParameterSet;
    /// The same model with other parameter values.
    ///
    /// # Errors
    /// A parameter that the model needs is missing, or values that contradict each other.
    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError>;
    /// The state variables, in the order of the state vector.
    fn states(&self) -> &[StateVariable];
    /// Writes d(state)/dt, each in its unit per ms, into `rates`; all of them, including the
    /// stimulus; they depend only on `state` and `input`.
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]);
    /// The default stimulus, its unit, and the states that it changes.
    fn stimulation(&self) -> Stimulation;
    /// The potential variable, in the unit of its state; always `None` for a model without one.
    fn potential(&self, state: &[f64]) -> Option<f64>;
    /// Membrane potential, mV, if the model defines it.
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64>;
    /// Active tension, as [`Self::tension_kind`] says; independent of the stimulus.
    fn tension(&self, state: &[f64], input: &Input) -> f64;
    /// Whether tension is relative or in kPa.
    fn tension_kind(&self) -> TensionKind;

    /// Keys in `references.bib` of the papers to cite; none by default.
    fn citations(&self) -> Vec<&str> {
        Vec::new()
    }
    /// Further outputs in addition to the state; none by default.
    fn outputs(&self) -> &[Output] {
        &[]
    }
    /// Writes the [`Self::outputs`], in their order, into `values`.
    fn write_outputs(&self, _state: &[f64], _input: &Input, _values: &mut [f64]) {}
    /// Indices of the states that a run records in addition to the outputs; none by default.
    fn recorded_states(&self) -> &[usize] {
        &[]
    }
    /// Indices of the states that are gates, for the method of Rush and Larsen; none by default.
    fn gates(&self) -> &[usize] {
        &[]
    }
    /// Writes steady state and time constant of each of the [`Self::gates`] at this state, in their
    /// order, into `gates`.
    fn write_gates(&self, _state: &[f64], _input: &Input, _gates: &mut [Gate]) {}
    /// Writes the derivative of rate `i` by state `j` to `jacobian[i * states + j]`, all of them,
    /// and returns true. The default returns false, so that stiff steps use finite differences.
    fn jacobian(&self, _state: &[f64], _input: &Input, _jacobian: &mut [f64]) -> bool {
        false
    }
    /// Whether rates, tension or outputs depend on stretch or its rate; false by default.
    fn feels_stretch(&self) -> bool {
        false
    }

    /// Free calcium in the cytosol, uM; always `None` for a model without calcium.
    fn calcium_um(&self, _state: &[f64], _input: &Input) -> Option<f64> {
        None
    }

    /// The model as in its authors' own program, and the time of the first stimulus there, ms, if
    /// the program differs from the publication; `None` by default.
    fn in_authors_program(&self) -> Option<(Arc<dyn CellModel>, f64)> {
        None
    }
    /// Groups of states that [`CellMethod::StaggeredEuler`] updates one after the other: index of the
    /// first state of each group except the first; none by default.
    fn staggered_groups(&self) -> &'static [usize] {
        &[]
    }
    /// Whether its rates jump at thresholds, so that stiff steps would become too small; false by
    /// default.
    fn jumps(&self) -> bool {
        false
    }
    /// Its adaptive steps; `None` by default.
    fn adaptive(&self) -> Option<&dyn Adaptive> {
        None
    }
    /// Its vectorised integration of many cells; by default each cell is integrated alone.
    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        None
    }
    /// Its steps of many cells at once, such as those of a tissue; by default each cell makes its own.
    fn together(&self) -> Option<&dyn Together> {
        None
    }

    /// The same model with a measured course of calcium; `None` by default, for models that compute
    /// calcium.
    fn with_calcium(&self, _course: &CalciumTrace) -> Option<Arc<dyn CellModel>> {
        None
    }
    /// The same model with this prescribed tension; `None` by default, for models that compute it.
    fn with_tension(
        &self,
        _course: &TensionCourse,
        _clock: TensionClock,
    ) -> Option<Arc<dyn CellModel>> {
        None
    }
    /// The equations that it was read from, for models from a file; `None` by default.
    fn equations_read(&self) -> Option<&Equations> {
        None
    }
    /// The greatest value of its prescribed tension, kPa; `None` by default, for models that compute
    /// their tension.
    fn given_peak(&self) -> Option<f64> {
        None
    }
    /// The myofilaments of `land_2017` among its states; `None` by default.
    fn filaments(&self) -> Option<Filaments<'_>> {
        None
    }
    /// The equations of a tension that depends only on the potential, if the last two states are
    /// those of [`Tension`]; `None` by default.
    fn tension_of_potential(&self) -> Option<&Tension> {
        None
    }
    /// Which of its parameters a fit to shortening can determine; none by default.
    fn in_fits(&self) -> InFits<'_> {
        InFits::default()
    }
    /// Whether its parameters describe lumped currents instead of single channels; false by
    /// default.
    fn lumps_currents(&self) -> bool {
        false
    }

    /// Whether another model certainly has the same equations and the same values of all parameters, so that both have the
    /// same course in time; false by default, which costs time only.
    fn is_same_as(&self, _other: &dyn CellModel) -> bool {
        false
    }

    /// How a free cell with the published parameters differs from measured cells; `None` by
    /// default.
    fn known_departure(&self) -> Option<KnownDeparture> {
        None
    }

    /// Names of the state variables, in the order of the state vector.
    fn state_names(&self) -> Vec<&str> {
        self.states().iter().map(|state| &*state.name).collect()
    }
    /// The state at rest, before any stimulus.
    fn initial_state(&self) -> Vec<f64> {
        self.states().iter().map(|state| state.start).collect()
    }
    /// Unit of the potential variable; empty for a dimensionless one and without potential.
    fn potential_unit(&self) -> String {
        let first = self.stimulation().moves.first().map(|moved| moved.state);
        first
            .and_then(|place| self.states().get(place))
            .map_or_else(String::new, |state| state.unit.to_string())
    }
    /// Suitable method with step or tolerance; by default [`SolverSettings::default`].
    fn usual_settings(&self) -> SolverSettings {
        SolverSettings::default()
    }
    /// The longest rest, ms, after which its beat is valid; unlimited by default.
    fn longest_rest_ms(&self) -> f64 {
        f64::INFINITY
    }
    /// The stimulus that its authors used.
    fn default_stimulus(&self) -> Stimulus {
        self.stimulation().default
    }
}

/// Which parameters of a model a fit to shortening can determine, by name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct InFits<'a> {
    /// The parameter to which a tension in kPa is proportional.
    pub strength: Option<&'a str>,
    /// Parameters that a fit determines by default in addition to the height of the tension.
    pub usual: &'a [&'a str],
    /// Parameters that cannot be determined together with each other and the height of the tension.
    pub not_together: &'a [&'a str],
}

/// The myofilaments of `land_2017` in a cell.
#[derive(Debug, Clone, Copy)]
pub struct Filaments<'a> {
    /// Their equations.
    pub equations: &'a Myofilaments,
    /// Index of the first of their six states.
    pub first: usize,
    /// Prescribed calcium; `None` if the cell model computes it.
    pub calcium: Option<&'a Calcium>,
}

/// A model with steps chosen by a tolerance although its equations jump. It must not depend on
/// stretch.
pub trait Adaptive {
    /// Starts a cell in this state at 0 ms, after the protocol's events at 0 ms; `tolerance` is the
    /// largest error of a step relative to the size of each variable.
    ///
    /// # Errors
    /// An invalid protocol, or a tolerance out of range.
    fn start(
        &self,
        state: &[f64],
        protocol: Protocol,
        tolerance: f64,
    ) -> Result<Box<dyn AdaptiveSteps>, SolveError>;
}

/// The integration of a cell in adaptive steps.
pub trait AdaptiveSteps: Send + Sync {
    /// Time reached, ms.
    fn time(&self) -> f64;
    /// The state at that time.
    fn state(&self) -> &[f64];
    /// Integrates to time `t_ms`.
    ///
    /// # Errors
    /// A time before the one reached or not finite, or a cell for which no step succeeds.
    fn advance_to(&mut self, t_ms: f64) -> Result<(), SolveError>;
    /// The largest rate of the potential since the last stimulus, without the current of the
    /// stimulus, in the unit of its state per ms; `None` by default, if it is not known.
    fn steepest_rise(&self) -> Option<f64> {
        None
    }
    /// A copy, for example for a trial step.
    fn boxed(&self) -> Box<dyn AdaptiveSteps>;
}

impl Clone for Box<dyn AdaptiveSteps> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

/// A model that can integrate many cells at once, for instance in vector registers.
pub trait SideBySide {
    /// The method for which this is available; with any other, each cell is integrated alone.
    fn method(&self) -> CellMethod;
    /// Whether it gives each beat exactly, without samples.
    fn tells_beats(&self) -> bool;
    /// Integrates cells, all of the type of this model, to their end. Returns the outcomes in
    /// order, or `None` once `goes_on`, which is called often, returns false. The result of a cell
    /// must not depend on the other cells, bitwise.
    fn move_all(
        &self,
        cells: &[&Paced],
        settings: &BatchSettings,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<Result<CellOutcome, SolveError>>>;
}

/// A model that can make a step of many cells at once, at their resting length.
pub trait Together: Send + Sync {
    /// A step of forward Euler of every cell, over a time in ms. `states` has a list for each state variable, and that a value for each
    /// cell; `stimuli` has the current of each.
    ///
    /// A cell's new state is, to the last bit, what [`CellModel::derivatives`] gives.
    fn euler(&self, states: &mut [&mut [f64]], stimuli: &[f64], step_ms: f64);
}

/// A paced cell at its resting length.
#[derive(Clone)]
pub struct Paced {
    pub(super) model: Arc<dyn CellModel>,
    pub(super) protocol: Protocol,
    pub(super) duration_ms: f64,
}

impl Paced {
    /// A cell in its initial state at 0 ms, to be integrated over a duration in ms.
    ///
    /// # Errors
    /// An invalid protocol, or a duration that is not a positive finite time.
    pub fn new(
        model: Arc<dyn CellModel>,
        protocol: Protocol,
        duration_ms: f64,
    ) -> Result<Self, SolveError> {
        protocol.validate()?;
        validate_time("duration", duration_ms)?;
        Ok(Self { model, protocol, duration_ms })
    }

    /// Its model.
    pub fn model(&self) -> &Arc<dyn CellModel> {
        &self.model
    }

    /// Its pacing protocol.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Its duration, ms.
    pub fn duration_ms(&self) -> f64 {
        self.duration_ms
    }
}

/// Settings of a batch of cells.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BatchSettings {
    /// Method, step and tolerance.
    pub method: SolverSettings,
    /// Time between samples, ms, first at 0 ms; default `None`, no samples.
    pub sample_interval_ms: Option<f64>,
}

/// The state of a cell at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSample {
    /// The potential in the unit of its state, if there is one.
    pub potential: Option<f64>,
    /// Membrane potential, mV, if the model defines it.
    pub potential_mv: Option<f64>,
    /// Active tension, relative or in kPa as the model says; 0 without tension.
    pub tension: f64,
    /// Free calcium in the cytosol, uM, if the model has it.
    pub calcium_um: Option<f64>,
}

impl CellSample {
    /// Computes the sample of a model in a state.
    pub fn of(model: &dyn CellModel, state: &[f64], input: &Input) -> Self {
        Self {
            potential: model.potential(state),
            potential_mv: model.membrane_potential_mv(state),
            tension: model.tension(state, input),
            calcium_um: model.calcium_um(state, input),
        }
    }
}

/// The outcome of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellOutcome {
    /// Its beats, one for each stimulus, in order; exact if the model gives them, else from
    /// samples.
    pub beats: Vec<CellBeat>,
    /// Sample `k` is at `k` times the interval; empty if none were requested.
    pub samples: Vec<CellSample>,
    /// Number of steps; 0 if they are not counted.
    pub steps: u64,
    /// Number of rejected steps.
    pub refused: u64,
}
