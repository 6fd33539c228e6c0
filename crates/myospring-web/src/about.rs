//! What the page must know to make its form: the table of settings and the cell models.

use myospring::cell::{self, CellModel};
use myospring::compare::dose;
use myospring::parameter::Parameter;
use myospring::run_file::schema;
use myospring::settings::Models;
use serde::Serialize;
use serde_json::Value;

#[derive(Serialize)]
pub(crate) struct About {
    version: &'static str,
    /// The schema of run files: each setting with description, unit, bounds and default.
    settings: Value,
    models: Vec<Model>,
    /// An example of a file of doses.
    doses: &'static str,
}

/// A cell model.
#[derive(Serialize)]
pub(crate) struct Model {
    /// As settings name it.
    name: String,
    /// Whether its tension is scaled to a peak tension.
    is_scaled: bool,
    parameters: Vec<Parameter>,
}

impl Model {
    pub(crate) fn of(model: &dyn CellModel) -> Self {
        Self {
            name: Models::name_of(model).to_owned(),
            is_scaled: model.tension_kind().published_peak().is_some(),
            parameters: model.parameters().rows().to_vec(),
        }
    }
}

impl About {
    pub(crate) fn new() -> Self {
        // Without tension, or with one from a table, a model beats nothing that a slider could change.
        let beats = |model: &&std::sync::Arc<dyn CellModel>| {
            model.tension_kind() != cell::TensionKind::None && model.given_peak().is_none()
        };
        Self {
            version: env!("CARGO_PKG_VERSION"),
            settings: schema(),
            models: cell::models().iter().filter(beats).map(|model| Model::of(&**model)).collect(),
            doses: dose::EXAMPLE,
        }
    }
}
