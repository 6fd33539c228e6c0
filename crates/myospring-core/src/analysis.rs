//! From positions and traces to the curves and numbers that a laboratory reads.
//!
//! Every function takes plain slices, of numbers or of a recording's samples. Each number comes as a
//! [`Metric`] with its unit and its definition, since conventions differ between laboratories.

pub mod action_potential;
pub mod alternans;
pub mod beat;
pub mod capture;
pub mod contraction;
pub mod curve;
pub mod kind;
pub mod load;
pub mod pulse;
pub mod rhythm;
pub mod rows;
pub mod s2;
pub mod shape;
pub mod tension;
#[cfg(test)]
mod tests;
pub mod trace;
pub mod transient;

use serde::Serialize;

/// A number with its unit and the convention it was taken by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Metric {
    /// Name in whole words, snake case.
    pub name: &'static str,
    /// Value in `unit`; `None` if the curve does not show it (a beat cut short, say).
    pub value: Option<f64>,
    /// Unit as written for people.
    pub unit: &'static str,
    /// How it is defined.
    pub definition: &'static str,
}

/// The value of a named metric, if it is there.
pub fn value(metrics: &[Metric], name: &str) -> Option<f64> {
    metrics.iter().find(|metric| metric.name == name)?.value
}

/// Mean and standard deviation of one metric over beats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Name of the metric.
    pub name: &'static str,
    /// Mean over the beats that show it.
    pub mean: f64,
    /// Standard deviation (n - 1).
    pub standard_deviation: f64,
    /// Number of beats that show it.
    pub beats: usize,
    /// Unit of mean and standard deviation.
    pub unit: &'static str,
}

/// Mean and standard deviation over beats of every metric that at least two beats show.
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
