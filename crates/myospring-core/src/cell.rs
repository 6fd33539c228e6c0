//! Cell models: a stimulus becomes an action potential and active tension.
//!
//! A [`CellModel`] is a set of ordinary differential equations with a description as data; a
//! [`pacing::Protocol`] says when it is stimulated; a [`integrator::CellIntegrator`] integrates it
//! in time by any [`solve::CellMethod`], alone ([`solve::solve`]) or step by step inside a coupled
//! simulation. [`models`] lists the models of this crate by name; a model of your own need not be
//! listed.
//!
//! Time is in ms, states and their rates are in the units that the model states. Relative tension
//! stays dimensionless here and is scaled outside: `Ta_kPa(t) = peak_tension_kPa Ta(t) / Ta_peak`,
//! where `Ta_peak` is a constant of the model ([`TensionKind::Relative`]): a parameter that makes
//! the model weaker makes the cell weaker. Tension in kPa is used unchanged.
//!
//! # Example
//! ```
//! use myospring::cell::{self, solve, solve::SolverSettings};
//!
//! let mut parameters = cell::model("coelho_2021")?.parameters().clone();
//! parameters.set("tau_w_plus", 250.0)?;
//! let model = cell::model("coelho_2021")?.with_parameters(parameters)?;
//! let beat = solve::reference_beat(model.as_ref(), SolverSettings::default())?;
//! assert!(beat.peak_tension > 0.5 && beat.peak_time_ms > 150.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod adaptive;
pub mod batch;
mod beat;
pub mod bueno_orovio_2008;
pub mod calcium;
mod cell_model;
pub mod coelho_2021;
mod description;
pub mod equation_model;
pub mod equations;
mod exponential;
mod fixed;
pub mod given_tension;
pub mod integrator;
pub mod land_2017;
pub mod minimal;
mod number;
mod pacer;
pub mod pacing;
mod population;
mod reference;
mod samples;
mod settings;
pub mod solve;
pub mod steady;
mod stiff;
mod tape;
pub mod tension;
mod together;
pub mod tomek_2019;
pub mod toy;
pub mod trace;
pub mod two_ways;
mod upstroke;

pub use cell_model::{Adaptive, AdaptiveSteps, CellModel, Filaments, InFits, SideBySide, Together};
pub use description::{
    Gate, Input, KnownDeparture, ModelError, Moved, Output, StateVariable, Stimulation,
    TensionKind, required,
};
pub(crate) use together::CellsTogether;

use crate::parameter::nearest;
use std::sync::Arc;
use tomek_2019::{Layer, TomekModel, Variant};

/// No model has the requested name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no cell model is named `{name}`; {}the models are: {known}",
    nearest.as_ref().map(|n| format!("did you mean `{n}`? ")).unwrap_or_default())]
pub struct UnknownModel {
    /// The requested name.
    pub name: String,
    /// The closest name, if one is close.
    pub nearest: Option<String>,
    /// All names.
    pub known: String,
}

/// Every cell model, with its published parameters: the only list of their names.
///
/// # Example
/// ```
/// for model in myospring::cell::models() {
///     assert!(model.states().iter().all(|variable| variable.start.is_finite()));
/// }
/// ```
pub fn models() -> Vec<Arc<dyn CellModel>> {
    vec![
        Arc::new(coelho_2021::model()),
        Arc::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Epi)),
        Arc::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Endo)),
        Arc::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::M)),
        Arc::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Pb)),
        Arc::new(bueno_orovio_2008::model(bueno_orovio_2008::Variant::Tnnp)),
        Arc::new(land_2017::Land2017::published()),
        Arc::new(TomekModel::published(Layer::Endo, Variant::Land)),
        Arc::new(TomekModel::published(Layer::Epi, Variant::Land)),
        Arc::new(TomekModel::published(Layer::Mid, Variant::Land)),
        Arc::new(TomekModel::published(Layer::Endo, Variant::Published)),
        Arc::new(TomekModel::published(Layer::Epi, Variant::Published)),
        Arc::new(TomekModel::published(Layer::Mid, Variant::Published)),
        Arc::new(TomekModel::published(Layer::Endo, Variant::MovingChloride)),
        Arc::new(TomekModel::published(Layer::Epi, Variant::MovingChloride)),
        Arc::new(TomekModel::published(Layer::Mid, Variant::MovingChloride)),
        Arc::new(given_tension::GivenTension::example()),
        Arc::new(toy::ToyModel::published()),
    ]
}

/// Whether a model is in the list and has its published parameters.
pub fn is_as_published(cell: &dyn CellModel) -> bool {
    model(cell.name()).is_ok_and(|published| published.parameters() == cell.parameters())
}

/// The model of a name, with its published parameters.
///
/// # Errors
/// An unknown name; the error suggests the nearest and lists all.
///
/// # Example
/// ```
/// let error = myospring::cell::model("cohelo_2021").err().unwrap();
/// assert!(error.to_string().contains("did you mean `coelho_2021`?"));
/// ```
pub fn model(name: &str) -> Result<Arc<dyn CellModel>, UnknownModel> {
    let models = models();
    if let Some(found) = models.iter().find(|model| model.name() == name) {
        return Ok(Arc::clone(found));
    }
    let names: Vec<&str> = models.iter().map(|model| model.name()).collect();
    Err(UnknownModel {
        name: name.to_owned(),
        nearest: nearest(name, names.iter().copied()).map(str::to_owned),
        known: names.join(", "),
    })
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
}
