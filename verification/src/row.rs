//! One row of the table: a number, what it should be, and why it may differ so much.

use serde::Serialize;

/// What came of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Within the tolerance.
    Pass,
    /// Not within the tolerance, or not a number.
    Fail,
    /// A difference that has no tolerance, because the two are not the same model; it is explained.
    Noted,
    /// Something needed is not there.
    Skipped,
}

/// One comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What is compared.
    pub what: String,
    /// With what: program and version, or the source of the closed form.
    pub against: String,
    /// The number that was measured.
    pub measured: f64,
    /// What it should be.
    pub expected: f64,
    /// By how much it may differ.
    pub tolerance: f64,
    /// Unit of the three; empty for a pure number.
    pub unit: String,
    /// Why the tolerance is what it is.
    pub reason: String,
    /// What came of it.
    pub verdict: Verdict,
}

impl Row {
    /// A number that should be `expected` within `tolerance`.
    ///
    /// # Example
    /// ```
    /// use myospring_verification::row::{Row, Verdict};
    /// let row = |measured| Row::about("order", "theory", measured, 2.0, 0.05, "", "");
    /// assert_eq!(row(1.97).verdict, Verdict::Pass);
    /// assert_eq!(row(f64::NAN).verdict, Verdict::Fail);
    /// ```
    pub fn about(
        what: impl Into<String>,
        against: impl Into<String>,
        measured: f64,
        expected: f64,
        tolerance: f64,
        unit: &str,
        reason: impl Into<String>,
    ) -> Self {
        let within = (measured - expected).abs() <= tolerance;
        Self {
            what: what.into(),
            against: against.into(),
            measured,
            expected,
            tolerance,
            unit: unit.into(),
            reason: reason.into(),
            verdict: if within { Verdict::Pass } else { Verdict::Fail },
        }
    }

    /// A difference that should vanish within `tolerance`.
    pub fn difference(
        what: impl Into<String>,
        against: impl Into<String>,
        measured: f64,
        tolerance: f64,
        unit: &str,
        reason: impl Into<String>,
    ) -> Self {
        Self::about(what, against, measured, 0.0, tolerance, unit, reason)
    }

    /// A number of ours beside theirs, told and explained, without a verdict.
    pub fn noted(
        what: impl Into<String>,
        against: impl Into<String>,
        measured: f64,
        expected: f64,
        unit: &str,
        explanation: impl Into<String>,
    ) -> Self {
        Self {
            verdict: Verdict::Noted,
            ..Self::about(what, against, measured, expected, f64::NAN, unit, explanation)
        }
    }

    /// A comparison that could not be made, and what is missing.
    pub fn skipped(what: impl Into<String>, against: impl Into<String>, missing: &str) -> Self {
        Self {
            verdict: Verdict::Skipped,
            ..Self::noted(what, against, f64::NAN, f64::NAN, "", missing)
        }
    }
}
