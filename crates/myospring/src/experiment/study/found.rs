//! What a study found.

use crate::study::parameters::{Acceptance, Sensitivity, TraceAxes};
use serde::Serialize;

/// What a study found, as `study.json` has it.
#[derive(Serialize)]
pub struct Found<'a> {
    pub(super) title: &'a str,
    /// How many members it has.
    pub members: usize,
    /// How many beat, failed and were kept.
    #[serde(flatten)]
    pub acceptance: Acceptance,
    /// Metrics of the run without any change.
    pub(super) usual: Vec<Usual<'a>>,
    /// What the file of curves holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) traces: Option<&'a TraceAxes>,
    /// Which parameter matters for which metric.
    pub sensitivity: Vec<Sensitivity>,
}

#[derive(Serialize)]
pub(super) struct Usual<'a> {
    pub(super) metric: &'a str,
    pub(super) value: Option<f64>,
    pub(super) unit: &'a str,
}
