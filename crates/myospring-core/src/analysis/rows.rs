//! Rows of metrics, and the units that follow from a curve's.

use super::{Metric, Missing, Reading};

/// What a beat is counted from, and how its rest was taken: what definitions differ in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Context {
    /// Time of the stimulus, ms, where one is known.
    pub stimulus: Option<f64>,
    /// When the curve leaves rest, ms, where that was looked for.
    pub onset: Option<f64>,
    /// How the value at rest is defined.
    pub rest: &'static str,
}

/// When a curve leaves its rest, as it is defined everywhere.
pub const ONSET: &str = "where the line through 10 % and 50 % of the rise meets the baseline";

/// One row.
pub(super) fn row(
    name: &'static str,
    reading: Reading,
    unit: &'static str,
    definition: &'static str,
) -> Metric {
    Metric::new(name, reading, unit, definition)
}

/// The time from one instant to another, which does not come before it.
pub(super) fn between(end: Reading, start: Reading) -> Reading {
    let way = end? - start?;
    if way < 0.0 { Err(Missing::Before) } else { Ok(way) }
}

/// What was read of something that may not have been recorded.
pub(super) fn recorded(value: Option<f64>) -> Reading {
    value.ok_or(Missing::NotRecorded)
}

/// A unit a second.
pub fn per_second(unit: &str) -> &'static str {
    match unit {
        "um" => "um/s",
        "px" => "px/s",
        "%" => "%/s",
        "nN" => "nN/s",
        "kPa" => "kPa/s",
        "uM" => "uM/s",
        "mV" => "mV/s",
        "a.u." => "a.u./s",
        _ => "1/s",
    }
}

/// A unit times ms.
pub fn times_ms(unit: &str) -> &'static str {
    match unit {
        "um" => "um ms",
        "px" => "px ms",
        "%" => "% ms",
        "nN" => "nN ms",
        "kPa" => "kPa ms",
        "uM" => "uM ms",
        "mV" => "mV ms",
        "a.u." => "a.u. ms",
        _ => "ms",
    }
}
