//! What the page must know to make its form: the table of settings and the cell models.

use myospring::cell;
use myospring::compare::dose;
use myospring::parameter::Parameter;
use myospring::run_file::schema;
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
struct Model {
    name: String,
    /// Whether its tension is scaled to a peak tension.
    is_scaled: bool,
    parameters: Vec<Parameter>,
}

impl About {
    pub(crate) fn new() -> Self {
        let model = |model: &std::sync::Arc<dyn cell::CellModel>| Model {
            name: model.name().to_owned(),
            is_scaled: model.tension_kind().published_peak().is_some(),
            parameters: model.parameters().rows().to_vec(),
        };
        // Without tension, or with one from a table, a model beats nothing that a slider could change.
        let beats = |model: &&std::sync::Arc<dyn cell::CellModel>| {
            model.tension_kind() != cell::TensionKind::None && model.given_peak().is_none()
        };
        Self {
            version: env!("CARGO_PKG_VERSION"),
            settings: schema(),
            models: cell::models().iter().filter(beats).map(model).collect(),
            doses: dose::EXAMPLE,
        }
    }
}
