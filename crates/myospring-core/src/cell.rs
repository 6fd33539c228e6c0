//! Cell models: a stimulus becomes an action potential and active tension.
//!
//! A [`CellModel`] is a set of ordinary differential equations; a [`pacing::Protocol`] says when it
//! is stimulated; a [`integrator::CellIntegrator`] moves it in time, alone ([`solve::solve`]) or
//! step by step inside a coupled simulation. Every model has a name in one list, [`models`].
//!
//! Time is in ms, rates in 1/ms, the state is dimensionless. Tension stays dimensionless here and
//! is scaled outside: `Ta_kPa(t) = peak_tension_kPa Ta(t) / Ta_peak`, where `Ta_peak` is a constant of
//! the model ([`CellModel::published_peak_tension`]): a parameter that makes the model weaker makes the
//! cell weaker.
//!
//! # Example
//! ```
//! use myospring::cell::{self, solve, solve::Settings};
//!
//! let mut parameters = cell::model("coelho_2021")?.parameters().clone();
//! parameters.set("tau_w_plus", 250.0)?;
//! let model = cell::model("coelho_2021")?.with_parameters(parameters)?;
//! let beat = solve::reference_beat(model.as_ref(), Settings::default())?;
//! assert!(beat.peak_tension > 0.5 && beat.peak_time_ms > 150.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod adaptive;
pub mod bueno_orovio_2008;
pub mod coelho_2021;
pub mod integrator;
pub mod minimal;
pub mod pacing;
pub mod population;
pub mod solve;
pub mod tension;
pub mod toy;
pub mod trace;

use crate::parameter::ParameterSet;
use pacing::Stimulus;

/// What acts on a cell from outside at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Stimulus current as a rate of the model's potential variable, 1/ms.
    pub stimulus: f64,
    /// Stretch of the cell along its fibre, length over resting length; 1 at rest.
    pub stretch: f64,
}

impl Input {
    /// No stimulus on a cell of resting length.
    pub const REST: Self = Self { stimulus: 0.0, stretch: 1.0 };
}

/// A cell model: ordinary differential equations from stimulus to active tension.
///
/// `testing::cell_model::check_cell_model` (feature `testing`) checks everything promised here.
pub trait CellModel: Send + Sync {
    /// Name as chosen in a run file: `coelho_2021`.
    fn name(&self) -> &'static str;
    /// One line for people.
    fn description(&self) -> &'static str;
    /// Keys in `references.bib` of the papers to cite.
    fn citations(&self) -> &'static [&'static str];
    /// The parameters with unit, range and source.
    fn parameters(&self) -> &ParameterSet;
    /// The same model with other parameter values.
    ///
    /// # Errors
    /// A parameter that the model needs is missing, or values that contradict each other.
    fn with_parameters(&self, parameters: ParameterSet) -> Result<Box<dyn CellModel>, ModelError>;
    /// Names of the state variables, in the order of the state vector.
    fn state_names(&self) -> &'static [&'static str];
    /// The state at rest, before any stimulus.
    fn initial_state(&self) -> Vec<f64>;
    /// Writes d(state)/dt, 1/ms, into `rates`; all of them, from `state` and `input` alone.
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]);
    /// Adds an instantaneous jump to the potential variable.
    fn jump(&self, state: &mut [f64], amplitude: f64);
    /// The potential variable, dimensionless.
    fn potential(&self, state: &[f64]) -> f64;
    /// Membrane potential, mV, where the model defines it.
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64>;
    /// Active tension, dimensionless, before scaling to kPa.
    fn tension(&self, state: &[f64]) -> f64;
    /// Peak of the active tension, dimensionless, of one default beat ([`solve::reference_beat`]) of the
    /// *published* parameters, converged: what a peak tension in kPa stands for. A constant of the model,
    /// whatever its present parameters are, so that they can change the strength of the cell.
    fn published_peak_tension(&self) -> f64;
    /// The stimulus that makes the model beat as its authors meant.
    fn default_stimulus(&self) -> Stimulus;
    /// Where [`solve::Method::StaggeredEuler`] cuts the state into blocks: the index of the first
    /// variable of each block but the first. No cuts: the method is forward Euler.
    fn staggered_blocks(&self) -> &'static [usize] {
        &[]
    }
}

/// Why a model cannot be made from a set of parameters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The set lacks a parameter of the model.
    #[error("cell model `{model}` needs parameter `{name}`, which the set does not have")]
    Missing {
        /// The model.
        model: &'static str,
        /// The parameter.
        name: &'static str,
    },
    /// Tension is driven by V = (u - `u_rest`) / (`u_peak` - `u_rest`).
    #[error("cell model `{model}`: u_peak = {u_peak} must be above u_rest = {u_rest}")]
    PeakNotAboveRest {
        /// The model.
        model: &'static str,
        /// Potential at rest.
        u_rest: f64,
        /// Potential at the peak.
        u_peak: f64,
    },
}

/// No model has the name that was asked for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no cell model is named `{name}`; {}the models are: {known}",
    nearest.map(|n| format!("did you mean `{n}`? ")).unwrap_or_default())]
pub struct UnknownModel {
    /// What was asked for.
    pub name: String,
    /// The closest name, if one is close.
    pub nearest: Option<&'static str>,
    /// All names.
    pub known: String,
}

/// Every cell model, with its published parameters: the one list that names them.
///
/// # Example
/// ```
/// for model in myospring::cell::models() {
///     assert_eq!(model.state_names().len(), model.initial_state().len());
/// }
/// ```
pub fn models() -> Vec<Box<dyn CellModel>> {
    vec![
        Box::new(coelho_2021::model()),
        Box::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Epi)),
        Box::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Endo)),
        Box::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::M)),
        Box::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Pb)),
        Box::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Tnnp)),
        Box::new(toy::ToyModel::published()),
    ]
}

/// Whether a model is one of the list with its published parameters.
pub fn is_as_published(cell: &dyn CellModel) -> bool {
    model(cell.name()).is_ok_and(|published| published.parameters() == cell.parameters())
}

/// The model of that name, with its published parameters.
///
/// # Errors
/// An unknown name; the error suggests the nearest and lists all.
///
/// # Example
/// ```
/// let error = myospring::cell::model("cohelo_2021").err().unwrap();
/// assert!(error.to_string().contains("did you mean `coelho_2021`?"));
/// ```
pub fn model(name: &str) -> Result<Box<dyn CellModel>, UnknownModel> {
    let names: Vec<&'static str> = models().iter().map(|model| model.name()).collect();
    models().into_iter().find(|model| model.name() == name).ok_or_else(|| UnknownModel {
        name: name.to_owned(),
        nearest: names
            .iter()
            .map(|known| (edit_distance(name, known), *known))
            .filter(|(distance, known)| 3 * distance <= known.len())
            .min()
            .map(|(_, known)| known),
        known: names.join(", "),
    })
}

/// Fewest insertions, deletions and replacements that turn one word into the other (Levenshtein).
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, letter) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for j in 0..to.len() {
            let replaced = diagonal + usize::from(letter != to[j]);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for listed in models() {
            assert_eq!(model(listed.name()).unwrap().name(), listed.name());
            assert_eq!(models().iter().filter(|other| other.name() == listed.name()).count(), 1);
        }
    }

    #[test]
    fn an_unknown_model_is_answered_with_the_nearest_and_all_names() {
        let near = model("bueno_orovio_2008_ep").err().unwrap().to_string();
        assert!(near.contains("did you mean `bueno_orovio_2008_epi`?"), "{near}");
        let far = model("zzz").err().unwrap();
        assert_eq!(far.nearest, None);
        for listed in models() {
            assert!(far.to_string().contains(listed.name()), "{far}");
        }
    }

    #[test]
    fn edit_distance_counts_single_letter_changes() {
        for (a, b, distance) in [("", "abc", 3), ("kitten", "sitting", 3), ("abc", "abc", 0)] {
            assert_eq!(edit_distance(a, b), distance);
            assert_eq!(edit_distance(b, a), distance);
        }
    }
}
