//! Rows of metrics, and the units that follow from a curve's.

use super::{Metric, Missing, Reading};

/// Times from which a beat's metrics are counted, and the definition of its rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Context {
    /// Time of the stimulus, ms, if known.
    pub stimulus: Option<f64>,
    /// Time at which the curve leaves its rest, ms, if it was determined.
    pub onset: Option<f64>,
    /// How the value at rest is defined.
    pub rest: &'static str,
}

/// Definition of the onset.
const ONSET: &str = "where the line through 10 % and 50 % of the rise meets the baseline";

/// One metric.
pub(super) fn row(
    name: &'static str,
    reading: Reading,
    unit: &'static str,
    definition: &'static str,
) -> Metric {
    Metric::new(name, reading, unit, definition)
}

/// When the peak of a curve comes: on the clock, from the stimulus and from the onset, as far as these are known; name
/// and definition of the first two, and the name of the third.
pub(super) fn peak_times(
    time: Reading,
    context: &Context,
    [on_clock, from_stimulus]: [[&'static str; 2]; 2],
    from_onset: &'static str,
) -> Vec<Metric> {
    let mut rows = vec![row(on_clock[0], time, "ms", on_clock[1])];
    if let Some(stimulus) = context.stimulus {
        rows.push(row(from_stimulus[0], between(time, Ok(stimulus)), "ms", from_stimulus[1]));
    }
    if let Some(onset) = context.onset {
        rows.push(row("time_of_onset", Ok(onset), "ms", ONSET));
        rows.push(row(
            from_onset,
            between(time, Ok(onset)),
            "ms",
            "from the onset, where the line through 10 % and 50 % of the rise meets the baseline, to the peak",
        ));
    }
    rows
}

/// The time from one moment to another, which must not be earlier.
pub(super) fn between(end: Reading, start: Reading) -> Reading {
    let way = end? - start?;
    if way < 0.0 { Err(Missing::Before) } else { Ok(way) }
}

/// A value, or [`Missing::NotRecorded`].
pub(super) fn recorded(value: Option<f64>) -> Reading {
    value.ok_or(Missing::NotRecorded)
}

/// A unit per second.
pub fn per_second(unit: &str) -> &'static str {
    match unit {
        "um" => "um/s",
        "px" => "px/s",
        "%" => "%/s",
        "nN" => "nN/s",
        "fJ" => "fJ/s",
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
        "fJ" => "fJ ms",
        "kPa" => "kPa ms",
        "uM" => "uM ms",
        "mV" => "mV ms",
        "a.u." => "a.u. ms",
        _ => "ms",
    }
}
