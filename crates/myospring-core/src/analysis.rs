//! Turns positions and traces into curves and the metrics that laboratories report.
//!
//! Every function takes plain slices, of numbers or of a recording's samples. Each number comes as a
//! [`Metric`] with its unit and its definition, since conventions differ between laboratories.

pub mod action_potential;
pub mod alternans;
pub mod bands;
pub mod beat;
pub mod beats;
pub mod capture;
pub mod contraction;
pub mod curve;
pub mod holes;
pub mod kind;
pub mod load;
mod missing;
pub mod monotone;
#[cfg(test)]
#[path = "../../myospring/tests/common/noise.rs"]
mod noise;
pub mod order;
pub mod paired;
pub mod pulse;
pub mod rest;
pub mod rhythm;
pub mod rows;
pub mod s2;
pub mod shape;
pub mod spiral;
pub mod spontaneous;
pub mod summary;
pub mod tension;
pub mod thickness;
pub mod trace;
pub mod transient;
pub mod wave;

pub use missing::{Missing, Reading};
use serde::Serialize;

/// A number with its unit and its definition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Metric {
    /// Name in whole words, snake case.
    pub name: &'static str,
    /// Value in `unit`, finite; `None` if the curve does not have it (for instance in a beat that
    /// is cut off).
    pub value: Option<f64>,
    /// Why there is no value, if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<Missing>,
    /// Unit, as written in tables.
    pub unit: &'static str,
    /// How it is defined.
    pub definition: &'static str,
}

impl Metric {
    /// Makes a metric from its value, or from the reason why it has none; a value that is not
    /// finite becomes [`Missing::TooSmall`].
    pub fn new(
        name: &'static str,
        reading: Reading,
        unit: &'static str,
        definition: &'static str,
    ) -> Self {
        let reading =
            reading.and_then(|value| value.is_finite().then_some(value).ok_or(Missing::TooSmall));
        Self { name, value: reading.ok(), missing: reading.err(), unit, definition }
    }

    /// Removes its value, with a reason.
    pub fn lose(&mut self, why: Missing) {
        (self.value, self.missing) = (None, Some(why));
    }
}

/// The value of a named metric; `None` if it has none.
pub fn value(metrics: &[Metric], name: &str) -> Option<f64> {
    metrics.iter().find(|metric| metric.name == name)?.value
}

/// The value of a named metric, or why it has none.
///
/// # Errors
/// The reason, if the metric has no value.
pub fn reading(metrics: &[Metric], name: &str) -> Reading {
    let metric = metrics.iter().find(|metric| metric.name == name).ok_or(Missing::NotRecorded)?;
    metric.value.ok_or(metric.missing.unwrap_or(Missing::NotRecorded))
}

/// Mean and standard deviation of one metric over beats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Name of the metric.
    pub name: &'static str,
    /// Mean over the beats that have it.
    pub mean: f64,
    /// Standard deviation (n - 1).
    pub standard_deviation: f64,
    /// Number of beats that have it.
    pub beats: usize,
    /// Unit of mean and standard deviation.
    pub unit: &'static str,
}

/// Mean and standard deviation over beats of every metric that at least two beats have.
pub fn beat_to_beat(beats: &[Vec<Metric>]) -> Vec<Spread> {
    let Some(first) = beats.first() else { return Vec::new() };
    first
        .iter()
        .filter_map(|metric| {
            let values: Vec<f64> =
                beats.iter().filter_map(|beat| value(beat, metric.name)).collect();
            let count = values.len() as f64;
            if values.len() < 2 {
                return None;
            }
            let mean = values.iter().sum::<f64>() / count;
            let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            Some(Spread {
                name: metric.name,
                mean,
                standard_deviation: (squares / (count - 1.0)).sqrt(),
                beats: values.len(),
                unit: metric.unit,
            })
        })
        .collect()
}
