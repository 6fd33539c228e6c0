//! What the variables of a model file are: potential, stimulus, calcium, tension.

use super::Variable;
use std::fmt;

/// The variables that a simulation needs to know.
#[derive(Debug, Clone, PartialEq)]
pub struct Roles {
    /// The membrane potential.
    pub potential: PotentialRole,
    /// The stimulus current.
    pub stimulus: StimulusRole,
    /// Free calcium in the cytosol; `None` for a model without calcium.
    pub calcium: Option<CalciumRole>,
    /// Active tension; `None` for a membrane model.
    pub tension: Option<TensionRole>,
}

/// How a role was assigned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Found {
    /// By an annotation of the file: `oxmeta membrane_voltage`, `label membrane_potential`.
    Annotation(String),
    /// By its name and unit, from a table of usual names.
    Name,
    /// By the user.
    User,
    /// By what the equations do, or assumed: the words say which.
    Reason(String),
}

impl fmt::Display for Found {
    fn fmt(&self, form: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Annotation(name) => write!(form, "annotated in the file: {name}"),
            Self::Name => form.write_str("by its usual name"),
            Self::User => form.write_str("chosen by you"),
            Self::Reason(words) => form.write_str(words),
        }
    }
}

/// The membrane potential.
#[derive(Debug, Clone, PartialEq)]
pub struct PotentialRole {
    /// The state that the stimulus changes first, by index: the potential in the unit of its state.
    pub state: usize,
    /// The variable that is the potential in units of voltage, usually the same state, and mV per
    /// its unit; `None` for a model with a dimensionless potential only.
    pub millivolts: Option<(Variable, f64)>,
    /// How it was found.
    pub found: Found,
}

/// The stimulus current: where [`Node::Stimulus`](super::Node::Stimulus) acts.
///
/// A positive stimulus depolarises: the reader has chosen the sign of the node so. How much a
/// stimulus of 1 changes each state follows from the rates: the derivative of a rate by the
/// stimulus.
#[derive(Debug, Clone, PartialEq)]
pub struct StimulusRole {
    /// The variable of the file in whose place the stimulus acts, `stimulus.i_stim`; `None` if the
    /// file has no stimulus, so that it is added to the rate of the potential.
    pub name: Option<String>,
    /// Its unit as text: `A/F`, `pA`, `uA/cm^2`; `mV/ms` where it is added to the rate.
    pub unit: String,
    /// The stimulus of the file.
    pub default: DefaultStimulus,
    /// How the variable was found.
    pub found: Found,
}

/// The stimulus that a file states.
#[derive(Debug, Clone, PartialEq)]
pub struct DefaultStimulus {
    /// The current in the unit of [`StimulusRole::unit`], positive to depolarise.
    pub amplitude: f64,
    /// Its duration, ms.
    pub duration_ms: f64,
    /// Time from one stimulus to the next, ms, if the file states it.
    pub period_ms: Option<f64>,
    /// Where these numbers come from.
    pub found: Found,
}

/// Free calcium in the cytosol.
#[derive(Debug, Clone, PartialEq)]
pub struct CalciumRole {
    /// The variable.
    pub variable: Variable,
    /// uM per its unit.
    pub micromolar: f64,
    /// How it was found.
    pub found: Found,
}

/// Active tension.
#[derive(Debug, Clone, PartialEq)]
pub struct TensionRole {
    /// The variable.
    pub variable: Variable,
    /// kPa per its unit; `None` for relative tension.
    pub kilopascals: Option<f64>,
    /// How it was found.
    pub found: Found,
}
