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
    /// As a page has it.
    pub(super) fn of(&beat::Band { low, high, scope, .. }: &beat::Band) -> Self {
        Self { low, high, scope }
    }
}
