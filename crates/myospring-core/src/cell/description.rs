//! What a cell model says of itself: its states, outputs, stimulus and tension, as data.

use super::pacing::Stimulus;
use serde::Serialize;
use std::borrow::Cow;

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
