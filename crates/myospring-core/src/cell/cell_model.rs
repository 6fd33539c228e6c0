//! What a cell model is: its equations, and what it can do besides.
//!
//! Nothing here needs to be known when the program is compiled: a model may read its states, parameters
//! and equations from a file and make them at run time. What only some models can do, such as adaptive steps
//! or calcium that is given, is a method of [`CellModel`] with the answer "no" by default: whoever needs it asks the
//! model, and nobody asks which model it is.

use super::beat::Beat;
use super::calcium::{Calcium, CalciumTrace};
use super::description::{
    Gate, Input, KnownDeparture, ModelError, Output, StateVariable, Stimulation, TensionKind,
};
use super::land_2017::Myofilaments;
use super::pacing::{Protocol, Stimulus};
use super::settings::{Method, Settings, SolveError, validate_time};
use super::tension::Tension;
use crate::parameter::ParameterSet;
use std::any::Any;
use std::sync::Arc;

/// A cell model: ordinary differential equations from stimulus to active tension.
///
/// A model of your own needs no list: whatever takes a cell model takes any `Arc<dyn CellModel>`.
/// `testing::cell_model::check_cell_model` (feature `testing`) checks everything promised here.
pub trait CellModel: Any + Send + Sync {
    /// Name as chosen in a run file: `coelho_2021`.
    fn name(&self) -> &str;
    /// One line for people.
    fn description(&self) -> &str;
    /// Keys in `references.bib` of the papers to cite.
    fn citations(&self) -> Vec<&str>;
    /// The parameters with unit, range and source.
    fn parameters(&self) -> &ParameterSet;
    /// The same model with other parameter values.
    ///
    /// # Errors
    /// A parameter that the model needs is missing, or values that contradict each other.
    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError>;
    /// The state variables, in the order of the state vector.
    fn states(&self) -> &[StateVariable];
    /// Writes d(state)/dt, each in its unit per ms, into `rates`; all of them, from `state` and `input`
    /// alone, the stimulus included.
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]);
    /// The stimulus, its unit and what it moves.
    fn stimulation(&self) -> Stimulation;
    /// The potential variable, in the unit of its state; `None`, at all times, where there is none.
    fn potential(&self, state: &[f64]) -> Option<f64>;
    /// Membrane potential, mV, where the model defines it.
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64>;
    /// Active tension, as [`Self::tension_kind`] says; the stimulus does not matter.
    fn tension(&self, state: &[f64], input: &Input) -> f64;
    /// Whether tension is relative or in kPa.
    fn tension_kind(&self) -> TensionKind;

    /// What the model tells beside its state; nothing by default.
    fn outputs(&self) -> &[Output] {
        &[]
    }
    /// Writes the [`Self::outputs`], in their order, into `values`.
    fn write_outputs(&self, _state: &[f64], _input: &Input, _values: &mut [f64]) {}
    /// The places of the states that a run records beside the outputs; none by default.
    fn recorded_states(&self) -> &[usize] {
        &[]
    }
    /// The places of the states that are gates, for the method of Rush and Larsen; none by default.
    fn gates(&self) -> &[usize] {
        &[]
    }
    /// Writes where each of the [`Self::gates`] goes at this state, in their order, into `gates`.
    fn write_gates(&self, _state: &[f64], _input: &Input, _gates: &mut [Gate]) {}
    /// Writes the derivative of rate `i` by state `j` to `jacobian[i * states + j]`, all of them, and
    /// returns true; or returns false, as by default, and stiff steps take differences of the rates.
    fn jacobian(&self, _state: &[f64], _input: &Input, _jacobian: &mut [f64]) -> bool {
        false
    }
    /// Whether rates, tension or outputs depend on stretch or its rate; not by default.
    fn feels_stretch(&self) -> bool {
        false
    }

    /// Free calcium in the cytosol, uM; `None`, at all times, where the model has none.
    fn calcium_um(&self, _state: &[f64], _input: &Input) -> Option<f64> {
        None
    }

    /// The model as its authors' own program has it, and when the first stimulus falls there, ms, where that differs from
    /// what they printed; by default it does not.
    fn in_authors_program(&self) -> Option<(Arc<dyn CellModel>, f64)> {
        None
    }
    /// Where the state is cut into groups that [`Method::StaggeredEuler`] updates one after the other: the place of the
    /// first state of each group but the first; none by default.
    fn staggered_groups(&self) -> &'static [usize] {
        &[]
    }
    /// Whether its rates jump at thresholds, where stiff steps would shrink to nothing; not by default.
    fn jumps(&self) -> bool {
        false
    }
    /// Its way to take adaptive steps; none by default.
    fn adaptive(&self) -> Option<&dyn Adaptive> {
        None
    }
    /// Its way to move many cells at once; by default each is moved alone.
    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        None
    }

    /// The same model with a measured course of calcium; `None`, as by default, where calcium is not given.
    fn with_calcium(&self, _course: &CalciumTrace) -> Option<Arc<dyn CellModel>> {
        None
    }
    /// The myofilaments of `land_2017` among its states, where it has them; none by default.
    fn filaments(&self) -> Option<Filaments<'_>> {
        None
    }
    /// The equations of a tension that follows the potential and nothing else, where the last two states are those of
    /// [`Tension`]; none by default.
    fn tension_of_potential(&self) -> Option<&Tension> {
        None
    }
    /// What a curve of shortening tells of its parameters; nothing by default.
    fn in_fits(&self) -> InFits<'_> {
        InFits::default()
    }
    /// Whether its parameters shape currents as a whole and stand for no single channel; not by default.
    fn lumps_currents(&self) -> bool {
        false
    }

    /// Where a free cell with the published parameters beats otherwise than measured cells do; nowhere by default.
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
    /// Unit of the potential variable as written for people; empty of a pure number and where there is none.
    fn potential_unit(&self) -> String {
        let first = self.stimulation().moves.first().map(|moved| moved.state);
        first
            .and_then(|place| self.states().get(place))
            .map_or_else(String::new, |state| state.unit.to_string())
    }
    /// Method and step or tolerance that serve it; by default the default.
    fn usual_settings(&self) -> Settings {
        Settings::default()
    }
    /// The longest rest, ms, after which its beat is not known to be wrong; by default none is.
    fn longest_rest_ms(&self) -> f64 {
        f64::INFINITY
    }
    /// The stimulus that makes the model beat as its authors meant.
    fn default_stimulus(&self) -> Stimulus {
        self.stimulation().default
    }
}

/// What a curve of shortening tells of the parameters of a model, by their names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct InFits<'a> {
    /// The parameter in proportion to which a tension in kPa is.
    pub strength: Option<&'a str>,
    /// What a fit seeks beside the height of the tension unless it is told otherwise.
    pub usual: &'a [&'a str],
    /// Parameters that cannot be told apart where all of them and the height of the tension are sought.
    pub not_together: &'a [&'a str],
}

/// The myofilaments of `land_2017` in a cell.
#[derive(Debug, Clone, Copy)]
pub struct Filaments<'a> {
    /// Their equations.
    pub equations: &'a Myofilaments,
    /// The place of the first of their six states.
    pub first: usize,
    /// Calcium that is given; `None` where the cell makes its own.
    pub calcium: Option<&'a Calcium>,
}

/// A model that can choose its steps by a tolerance although its equations jump. It does not feel its stretch.
pub trait Adaptive {
    /// A cell in this state at 0 ms, after whatever the protocol does then; `tolerance` is the largest error of a step
    /// over the size of each variable.
    ///
    /// # Errors
    /// A protocol that cannot be followed, or a tolerance out of range.
    fn start(
        &self,
        state: &[f64],
        protocol: Protocol,
        tolerance: f64,
    ) -> Result<Box<dyn AdaptiveSteps>, SolveError>;
}

/// A cell on its way through time in adaptive steps.
pub trait AdaptiveSteps: Send + Sync {
    /// Time reached, ms.
    fn time(&self) -> f64;
    /// The state at that time.
    fn state(&self) -> &[f64];
    /// Moves on to time `t_ms`.
    ///
    /// # Errors
    /// A time before the one reached or not finite, or a cell that no step takes further.
    fn advance_to(&mut self, t_ms: f64) -> Result<(), SolveError>;
    /// The largest rate of the potential since the last stimulus, without the current of the stimulus, in the unit of its
    /// state per ms; none, as by default, where it is not known.
    fn steepest_rise(&self) -> Option<f64> {
        None
    }
    /// The same cell once more, to be moved on trial.
    fn boxed(&self) -> Box<dyn AdaptiveSteps>;
}

impl Clone for Box<dyn AdaptiveSteps> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

/// A model whose cells can be moved many at once, in vector registers or otherwise.
pub trait SideBySide {
    /// The method by which they are moved; by any other each is moved alone.
    fn method(&self) -> Method;
    /// Whether it tells of each beat exactly, without samples.
    fn tells_beats(&self) -> bool;
    /// Moves cells, all of the type of this model, to their end; what became of each, in order, or `None` once
    /// `goes_on`, which is asked often, says no. Whether a cell has company does not change its bits.
    fn move_all(
        &self,
        cells: &[&Paced],
        settings: &BatchSettings,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<Result<CellOutcome, SolveError>>>;
}

/// A cell of its resting length that is paced.
#[derive(Clone)]
pub struct Paced {
    pub(super) model: Arc<dyn CellModel>,
    pub(super) protocol: Protocol,
    pub(super) duration_ms: f64,
}

impl Paced {
    /// A cell in its initial state at 0 ms, to be followed for so long.
    ///
    /// # Errors
    /// A protocol that cannot be followed, or a duration that is not a positive finite time.
    pub fn new(
        model: Arc<dyn CellModel>,
        protocol: Protocol,
        duration_ms: f64,
    ) -> Result<Self, SolveError> {
        protocol.validate()?;
        validate_time("duration", duration_ms)?;
        Ok(Self { model, protocol, duration_ms })
    }

    /// Its equations.
    pub fn model(&self) -> &Arc<dyn CellModel> {
        &self.model
    }

    /// When and how it is stimulated.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// How long it is followed, ms.
    pub fn duration_ms(&self) -> f64 {
        self.duration_ms
    }
}

/// How a batch of cells is followed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BatchSettings {
    /// Method, step and tolerance.
    pub method: Settings,
    /// Time between samples, ms, first at 0 ms; default none, no samples.
    pub sample_interval_ms: Option<f64>,
}

/// A cell at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSample {
    /// The potential in the unit of its state, where there is one.
    pub potential: Option<f64>,
    /// Membrane potential, mV, where the model defines it.
    pub potential_mv: Option<f64>,
    /// Active tension, relative or in kPa as the model says; 0 where there is none.
    pub tension: f64,
    /// Free calcium in the cytosol, uM, where the model has it.
    pub calcium_um: Option<f64>,
}

impl CellSample {
    /// Of a model in a state.
    pub fn of(model: &dyn CellModel, state: &[f64], input: &Input) -> Self {
        Self {
            potential: model.potential(state),
            potential_mv: model.membrane_potential_mv(state),
            tension: model.tension(state, input),
            calcium_um: model.calcium_um(state, input),
        }
    }
}

/// What one of many cells did.
#[derive(Debug, Clone, PartialEq)]
pub struct CellOutcome {
    /// Its beats, one for each stimulus, in order; from steps where the model tells them, else from samples.
    pub beats: Vec<Beat>,
    /// Sample `k` is at `k` times the interval; none where none were asked for.
    pub samples: Vec<CellSample>,
    /// Steps taken; 0 where they are not counted.
    pub steps: u64,
    /// Steps tried whose error was too large.
    pub refused: u64,
}
