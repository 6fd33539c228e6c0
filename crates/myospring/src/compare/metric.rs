//! Metrics of runs and their differences.

use crate::analysis::Metric;
use crate::analysis::beat::Beat;
use crate::analysis::beats::Beats;
use serde::Serialize;

/// A metric of several runs; for several beats, the mean of those that count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name in full words, snake case.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// Unit of the differences: for a value in per cent, percentage points.
    pub difference_unit: &'static str,
    /// Definition.
    pub definition: &'static str,
    /// Values, one per run; `None` if the curve does not show the metric.
    pub values: Vec<Option<f64>>,
    /// Value of each run minus that of the first.
    pub differences: Vec<Option<f64>>,
    /// Difference in per cent of the first run's value; `None` if that value is 0 within rounding.
    pub differences_pct: Vec<Option<f64>>,
}

/// A value below this, in its own unit, counts as 0: curves are written with 9 digits.
const ROUNDING: f64 = 1e-3;

/// Returns the metrics of runs, each with its differences from the first run.
///
/// # Example
/// ```
/// use myospring::compare::metric;
/// use myospring::prelude::*;
/// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
/// simulation.numerics.method = Method::QuasiStatic;
/// let strong = simulation.build()?.run(|_| true).beats();
/// simulation.peak_tension = 25.0;
/// let weak = simulation.build()?.run(|_| true).beats();
/// let rows = metric::rows(&[&strong, &weak]);
/// let peak = rows.iter().find(|row| row.name == "peak_tension").unwrap();
/// assert!((peak.differences_pct[1].unwrap() + 50.0).abs() < 1e-6);
/// assert_eq!(peak.differences[0], Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rows(runs: &[&Beats]) -> Vec<Row> {
    let mut names: Vec<&Metric> = Vec::new();
    for metric in runs.iter().filter_map(|beats| beats.first()).flat_map(Beat::metrics) {
        if names.iter().all(|other| other.name != metric.name) {
            names.push(metric);
        }
    }
    names.into_iter().map(|metric| row(metric, runs)).collect()
}

fn row(metric: &Metric, runs: &[&Beats]) -> Row {
    let Metric { name, unit, definition, .. } = *metric;
    let values: Vec<Option<f64>> = runs.iter().map(|beats| beats.mean(name)).collect();
    let first = values.first().copied().flatten();
    let less = |value: &Option<f64>| Some((*value)? - first?);
    let percent = |value: &Option<f64>| {
        let first = first.filter(|first| first.abs() >= ROUNDING)?;
        Some(100.0 * ((*value)? - first) / first.abs())
    };
    Row {
        name,
        unit,
        difference_unit: if unit == "%" { "percentage points" } else { unit },
        definition,
        differences: values.iter().map(less).collect(),
        differences_pct: values.iter().map(percent).collect(),
        values,
    }
}
