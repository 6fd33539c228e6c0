//! The band of a quantity that is seen in experiments.

use myospring_core::analysis::beat;
use serde::Serialize;

/// What is seen in experiments.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Band {
    low: f64,
    high: f64,
    scope: &'static str,
}

impl Band {
    /// That of a metric.
    pub(super) fn of(metric: &str) -> Option<Self> {
        beat::band(metric).map(|&beat::Band { low, high, scope, .. }| Self { low, high, scope })
    }
}
