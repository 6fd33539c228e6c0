//! What a cell model is: its equations, and data that say what they are about.
//!
//! Nothing here needs to be known when the program is compiled: a model may read its states, parameters
//! and equations from a file and make them at run time.

use super::pacing::Stimulus;
use super::settings::Settings;
use crate::parameter::ParameterSet;
use serde::Serialize;
use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;

/// What acts on a cell from outside at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Stimulus current, in the unit that the model states ([`Stimulation::current_unit`]).
    pub stimulus: f64,
    /// Stretch of the cell along its fibre, length over resting length; 1 at rest.
    pub stretch: f64,
    /// Its rate of change, 1/ms; positive while the cell lengthens.
    pub stretch_rate: f64,
    /// Time since the last stimulus began, ms; infinite before the first. For what is given as a course over
    /// each beat; equations of a cell of its own do not depend on it.
    pub since_stimulus_ms: f64,
}

impl Input {
    /// No stimulus, now or before, on a cell of resting length.
    pub const REST: Self =
        Self { stimulus: 0.0, stretch: 1.0, stretch_rate: 0.0, since_stimulus_ms: f64::INFINITY };
}

/// One variable of the state vector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateVariable {
    /// The field's name for it, ASCII: `Ca_i`.
    pub name: Cow<'static, str>,
    /// Its unit as written for people: `uM`; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Its value at rest, before any stimulus, in that unit.
    pub start: f64,
    /// What it is, in a few words.
    pub meaning: Cow<'static, str>,
}

/// Something that a model tells beside its state: a transient of calcium, a current.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Output {
    /// The field's name for it, ASCII: `I_CaL`.
    pub name: Cow<'static, str>,
    /// Its unit as written for people: `A/F`; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// What it is, in a few words.
    pub meaning: Cow<'static, str>,
}

/// How a model is stimulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Stimulation {
    /// The stimulus that makes the model beat as its authors meant.
    pub default: Stimulus,
    /// Unit of a stimulus current: `1/ms` for a dimensionless potential, `A/F` for one in mV.
    pub current_unit: Cow<'static, str>,
    /// The states that a stimulus moves, the potential first. A jump moves that one by its amplitude, in
    /// its own unit, and the others in proportion to the weights. None where a stimulus only says when a
    /// given course begins ([`Input::since_stimulus_ms`]).
    pub moves: Cow<'static, [Moved]>,
}

/// A state that a stimulus moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Its place in the state vector.
    pub state: usize,
    /// What a stimulus current of 1 adds to its rate, in the state's unit per ms.
    pub weight: f64,
}

impl Stimulation {
    /// A dimensionless potential, variable 0, stimulated by a current that is its rate, 1/ms.
    pub const fn of_first_state(default: Stimulus) -> Self {
        Self {
            default,
            current_unit: Cow::Borrowed("1/ms"),
            moves: Cow::Borrowed(&[Moved { state: 0, weight: 1.0 }]),
        }
    }
}

/// What the number that a model gives as its active tension means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TensionKind {
    /// Without dimension; a run scales it to a peak tension in kPa.
    Relative {
        /// Peak of one default beat ([`solve::reference_beat`](super::solve::reference_beat)) of the
        /// *published* parameters, converged: what a peak tension in kPa stands for. A constant of the
        /// model, whatever its present parameters are, so that they can change the strength of the cell.
        published_peak: f64,
    },
    /// In kPa already; never scaled.
    Kilopascal,
    /// There is none: a membrane alone, which moves no cell.
    None,
}

impl TensionKind {
    /// The published peak of a relative tension.
    pub fn published_peak(self) -> Option<f64> {
        match self {
            Self::Relative { published_peak } => Some(published_peak),
            Self::Kilopascal | Self::None => None,
        }
    }
}

/// What the published parameters of a model are known to do outside the reference bands
/// ([`BANDS`](crate::analysis::beat::BANDS)): a fact about the model, whatever run it is in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownDeparture {
    /// `shortening_rate_over_peak` of a free cell, 1/s; outside its band.
    pub shortening_rate_over_peak: f64,
    /// The fact, in a sentence without its full stop: "The tension rises faster than measured cells".
    pub fact: Cow<'static, str>,
    /// A model of the list of which it is not true.
    pub instead: Cow<'static, str>,
}

/// Where a gate goes and how fast: `dx/dt = (steady_state - x) / time_constant_ms`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gate {
    /// The value that it would reach.
    pub steady_state: f64,
    /// How long it takes, ms; above 0.
    pub time_constant_ms: f64,
}

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

/// Why a model cannot be made from a set of parameters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The set lacks a parameter of the model.
    #[error("cell model `{model}` needs parameter `{name}`, which the set does not have")]
    Missing {
        /// The model.
        model: String,
        /// The parameter.
        name: String,
    },
    /// Values that contradict each other.
    #[error("cell model `{model}`: {reason}")]
    Contradiction {
        /// The model.
        model: String,
        /// Which values, and what they should be.
        reason: String,
    },
}

impl ModelError {
    /// A parameter is missing in the set.
    pub fn missing(model: &str, name: &str) -> Self {
        Self::Missing { model: model.to_owned(), name: name.to_owned() }
    }
}
