//! Results of the analysis of a curve, and its errors.

use crate::analysis::holes::Hole;
use crate::analysis::trace::Point;
use crate::analysis::{Metric, Spread, beat_to_beat, value};
use serde::Serialize;

/// Least number of frames from which a beat can be read.
pub(super) const LEAST_FRAMES: usize = 8;

/// Why a curve has no metrics.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// Lists of different length.
    #[error("{times} times and {values} values; give one for each")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// Too short for a beat.
    #[error("{frames} frames; a beat needs at least {LEAST_FRAMES}")]
    Few {
        /// How many there are.
        frames: usize,
    },
    /// Not a number, or a time that does not rise.
    #[error(
        "frame {frame}: time {time} ms, value {value}; both must be finite, and times must rise"
    )]
    Sample {
        /// From 1.
        frame: usize,
        /// Its time, ms.
        time: f64,
        /// Its value.
        value: f64,
    },
    /// The curve is constant.
    #[error("all {frames} values are {value}: there is no beat")]
    Still {
        /// How many there are.
        frames: usize,
        /// The value of all frames.
        value: f64,
    },
    /// No pulse is above the noise.
    #[error("there is no beat: {}{hint}", above_noise(*noise, *least, unit))]
    NoBeat {
        /// Standard deviation of the noise.
        noise: f64,
        /// Least height of a pulse.
        least: f64,
        /// Unit of both.
        unit: &'static str,
        /// A hint.
        hint: &'static str,
    },
    /// Values that are impossible for this kind of curve.
    #[error("{of} {value:.4} {unit}, such as frame {frame}, and {bound}; {seems}")]
    Impossible {
        /// Which frames or beats have this value, in words.
        of: &'static str,
        /// A frame with that value, or at the onset or peak of a beat with it, from 1.
        frame: usize,
        /// A typical value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// The bound that is violated.
        bound: &'static str,
        /// What the column probably is, and how to analyse it.
        seems: &'static str,
    },
    /// No stimulus within the recording.
    #[error(
        "none of {count} stimuli falls into the recording, from {from} to {to} ms; stimulus times are on its clock"
    )]
    Stimuli {
        /// How many were given.
        count: usize,
        /// First time, ms.
        from: f64,
        /// Last time, ms.
        to: f64,
    },
}

impl CurveError {
    /// The frame that caused the error, from 1, if there is one.
    pub fn frame(&self) -> Option<usize> {
        match self {
            Self::Sample { frame, .. } | Self::Impossible { frame, .. } => Some(*frame),
            _ => None,
        }
    }
}

/// How completely a beat was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// From rest to the next beat, or to rest.
    Whole,
    /// The recording begins within it: its rest is unknown, and the beat does not count in means.
    CutAtStart,
    /// The recording ends within it: the metrics that it still has count.
    CutAtEnd,
    /// An artefact overlaps it: part of it was replaced by a line, and it does not count in means.
    Disturbed,
    /// Frames are missing within it: no metric is read across the gap, and it does not count in
    /// means.
    Interrupted,
    /// A stimulus without a beat.
    Missed,
}

impl State {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::CutAtStart => "cut at the start",
            Self::CutAtEnd => "cut at the end",
            Self::Disturbed => "with an artefact",
            Self::Interrupted => "with missing frames",
            Self::Missed => "missed",
        }
    }
}

/// A point of the curve at which a metric was read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mark {
    /// What was read.
    pub name: &'static str,
    /// Time, ms, and value in the curve's unit.
    #[serde(skip)]
    pub point: Point,
}

/// One beat of a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveBeat {
    /// From 1.
    pub number: usize,
    /// Its stimulus, ms, if stimuli were given.
    pub stimulus_ms: Option<f64>,
    /// Time at which the curve leaves its rest, ms; `None` for a missed beat.
    pub onset_ms: Option<f64>,
    /// How completely it was recorded.
    pub state: State,
    /// Remarks on it, as sentences.
    pub remarks: Vec<String>,
    /// Its metrics; empty for a missed beat.
    pub metrics: Vec<Metric>,
    /// Points at which they were read.
    #[serde(skip)]
    pub marks: Vec<Mark>,
    /// Frames before it over which its rest is the mean: the first, and the one after the last; from
    /// 0.
    #[serde(skip)]
    pub rest_frames: Option<[usize; 2]>,
    /// Baseline over the beat: its first and last point.
    #[serde(skip)]
    pub baseline: Option<[Point; 2]>,
}

/// A part of a curve that is unlike its beats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Artefact {
    /// Time of its first frame, ms.
    pub from_ms: f64,
    /// Time of its last frame, ms.
    pub to_ms: f64,
    /// Its first and last frame, from 1.
    pub frames: [usize; 2],
    /// Its largest distance from the line that replaces it, in the curve's unit.
    pub height: f64,
    /// Whether it is longer than the interval between beats; then no beat is searched in it.
    pub long: bool,
}

/// How a curve was processed before its metrics were read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Treatment {
    /// Whether the curve rises in a beat; lengths fall.
    pub rises: bool,
    /// How beats were found.
    pub beats: String,
    /// How the value at rest is defined.
    pub baseline: &'static str,
    /// How drift was treated.
    pub drift: &'static str,
    /// How the curve was smoothed.
    pub smoothing: String,
    /// How rates were read.
    pub rates: String,
    /// Standard deviation of the noise, in the curve's unit.
    pub noise: f64,
    /// Frames that were replaced, from 1.
    pub bad_frames: Vec<usize>,
    /// Longer parts that are not beats; they were replaced by lines.
    pub artefacts: Vec<Artefact>,
    /// Gaps in the times, across which no metric is read.
    pub holes: Vec<Hole>,
    /// The mains hum that was subtracted: frequency in Hz, and amplitude in the curve's unit.
    pub hum: Option<[f64; 2]>,
}

/// The beats of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// In order.
    pub beats: Vec<CurveBeat>,
    /// How the curve was processed.
    pub treatment: Treatment,
    /// Remarks on the rhythm and doubts, as sentences.
    pub remarks: Vec<String>,
    /// The curve from which metrics were read: smoothed, without bad frames and hum, in the curve's
    /// unit.
    pub read: Vec<f64>,
}

impl Analysis {
    /// Mean and standard deviation of each metric over the beats that count: complete ones, and the
    /// available metrics of one that is cut off at the end. A single beat has no spread.
    pub fn spread(&self) -> Vec<Spread> {
        beat_to_beat(&self.counted())
    }

    /// Metrics of the beats that count in means.
    pub fn counted(&self) -> Vec<Vec<Metric>> {
        let counts = |beat: &&CurveBeat| matches!(beat.state, State::Whole | State::CutAtEnd);
        self.beats.iter().filter(counts).map(|beat| beat.metrics.clone()).collect()
    }

    /// The mean of a metric over the beats that count and have it.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let values: Vec<f64> = self.counted().iter().filter_map(|beat| value(beat, name)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// Why there is no beat above the noise, in words.
fn above_noise(noise: f64, least: f64, unit: &str) -> String {
    if noise.is_finite() && least.is_finite() {
        return format!(
            "nothing rises above the noise (standard deviation {noise:.3} {unit}) by the {least:.3} {unit} that a beat \
             would need"
        );
    }
    "too few frames are free of artefacts to distinguish a beat from noise".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noise_that_is_not_known_is_not_stated() {
        for (noise, least) in [(f64::NAN, 1.0), (0.1, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
            let said = CurveError::NoBeat { noise, least, unit: "um", hint: "" }.to_string();
            assert!(!said.contains("NaN") && !said.contains("inf"), "{said}");
            assert!(said.contains("too few frames"), "{said}");
        }
        let known = CurveError::NoBeat { noise: 0.1, least: 0.5, unit: "um", hint: "" };
        assert!(known.to_string().contains("standard deviation 0.100 um"));
    }
}
