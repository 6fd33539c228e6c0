//! Description of a cell model as data: states, outputs, stimulus and tension.

use super::pacing::Stimulus;
use crate::parameter::ParameterSet;
use serde::Serialize;
use std::borrow::Cow;

/// External input of a cell at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Stimulus current, in the unit that the model states ([`Stimulation::current_unit`]).
    pub stimulus: f64,
    /// Stretch of the cell along its fibre, length over resting length; 1 at rest.
    pub stretch: f64,
    /// Its rate of change, 1/ms; positive while the cell lengthens.
    pub stretch_rate: f64,
    /// Time since the last stimulus began, ms; infinite before the first. Used for prescribed
    /// courses over each beat, such as calcium; other equations must not depend on it.
    pub since_stimulus_ms: f64,
    /// Time since the start of the run, ms. Used for prescribed courses over a whole recording;
    /// other equations must not depend on it.
    pub time_ms: f64,
}

impl Input {
    /// No stimulus, now or before, on a cell of resting length.
    pub const REST: Self = Self {
        stimulus: 0.0,
        stretch: 1.0,
        stretch_rate: 0.0,
        since_stimulus_ms: f64::INFINITY,
        time_ms: 0.0,
    };
}

/// One variable of the state vector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateVariable {
    /// Its usual name in the literature, ASCII: `Ca_i`.
    pub name: Cow<'static, str>,
    /// Its unit: `uM`; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Its value at rest, before any stimulus, in that unit.
    pub start: f64,
    /// Its meaning, in a few words.
    pub meaning: Cow<'static, str>,
}

/// An output of a model in addition to its state, such as a current.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Output {
    /// Its usual name in the literature, ASCII: `I_CaL`.
    pub name: Cow<'static, str>,
    /// Its unit: `A/F`; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Its meaning, in a few words.
    pub meaning: Cow<'static, str>,
}

/// How a model is stimulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Stimulation {
    /// The stimulus that its authors used.
    pub default: Stimulus,
    /// Unit of a stimulus current: `1/ms` for a dimensionless potential, `A/F` for one in mV.
    pub current_unit: Cow<'static, str>,
    /// The states that a stimulus changes, the potential first. A jump changes the potential by its
    /// amplitude, in its own unit, and the others in proportion to the weights. Empty if a stimulus
    /// only starts a prescribed course ([`Input::since_stimulus_ms`]).
    pub moves: Cow<'static, [Moved]>,
}

/// A state that a stimulus changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Its index in the state vector.
    pub state: usize,
    /// Rate that a stimulus current of 1 adds to it, in the state's unit per ms.
    pub weight: f64,
}

impl Stimulation {
    /// Stimulation of a dimensionless potential, variable 0, by a current in 1/ms.
    pub const fn of_first_state(default: Stimulus) -> Self {
        Self {
            default,
            current_unit: Cow::Borrowed("1/ms"),
            moves: Cow::Borrowed(&[Moved { state: 0, weight: 1.0 }]),
        }
    }
}

/// Meaning of a model's active tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TensionKind {
    /// Without dimension; a run scales it to a peak tension in kPa.
    Relative {
        /// Peak of one default beat ([`solve::reference_beat`](super::solve::reference_beat)) of
        /// the *published* parameters, converged; a run scales this value to its peak tension in
        /// kPa. It does not depend on the present parameters, so that these can change the strength
        /// of the cell.
        published_peak: f64,
    },
    /// In kPa already; never scaled.
    Kilopascal,
    /// No tension: a membrane model, which moves no cell.
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

/// A known deviation of a model with published parameters from the reference bands
/// ([`BANDS`](crate::analysis::bands::BANDS)).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownDeparture {
    /// `shortening_rate_over_peak` of a free cell, 1/s; outside its band.
    pub shortening_rate_over_peak: f64,
    /// The fact, in a sentence without its full stop: "The tension rises faster than measured cells".
    pub fact: Cow<'static, str>,
    /// A listed model without this deviation.
    pub instead: Cow<'static, str>,
}

/// Steady state and time constant of a gate: `dx/dt = (steady_state - x) / time_constant_ms`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gate {
    /// Its steady-state value.
    pub steady_state: f64,
    /// Its time constant, ms; above 0.
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
        /// Which values contradict each other, and what they should be.
        reason: String,
    },
}

/// The value of a parameter that a model needs.
///
/// # Errors
/// A set without it; the error names the model and the parameter.
pub fn required(model: &str, parameters: &ParameterSet, name: &str) -> Result<f64, ModelError> {
    let missing = || ModelError::Missing { model: model.to_owned(), name: name.to_owned() };
    parameters.get(name).ok_or_else(missing)
}
