//! What is told of a curve, and why nothing can be.

use crate::analysis::holes::Hole;
use crate::analysis::trace::Point;
use crate::analysis::{Metric, Spread, beat_to_beat, value};
use serde::Serialize;

/// Fewest frames that a beat could be read from.
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
    /// Nothing moves.
    #[error("all {frames} values are {value}: there is no beat")]
    Still {
        /// How many there are.
        frames: usize,
        /// What all of them are.
        value: f64,
    },
    /// Nothing stands above the noise.
    #[error("there is no beat: {}{hint}", above_noise(*noise, *least, unit))]
    NoBeat {
        /// Standard deviation of the noise.
        noise: f64,
        /// How high a pulse would have to be.
        least: f64,
        /// Of both.
        unit: &'static str,
        /// What may help.
        hint: &'static str,
    },
    /// Values that no curve of this kind has.
    #[error("{of} {value:.4} {unit}, such as frame {frame}, and {bound}; {seems}")]
    Impossible {
        /// What has this value: most frames, most beats.
        of: &'static str,
        /// A frame of that value, or the one at the onset or peak of a beat of it, from 1.
        frame: usize,
        /// A typical value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// What it must be.
        bound: &'static str,
        /// What the column seems to be, and how to measure it.
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
    /// The frame that is to blame, from 1, if one is.
    pub fn frame(&self) -> Option<usize> {
        match self {
            Self::Sample { frame, .. } | Self::Impossible { frame, .. } => Some(*frame),
            _ => None,
        }
    }
}

/// How much of a beat the recording has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// From rest to the next beat, or to rest.
    Whole,
    /// The recording begins within it: its rest is unknown, and it does not count in means.
    CutAtStart,
    /// The recording ends within it: what it still shows counts.
    CutAtEnd,
    /// An artefact touches it: what it shows is partly a line, and it does not count in means.
    Disturbed,
    /// Frames are missing within it: no metric is read across a hole, and it does not count in means.
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

/// Where on the curve something was read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mark {
    /// What.
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
    /// Its stimulus, ms, where stimuli were given.
    pub stimulus_ms: Option<f64>,
    /// When the curve leaves its rest, ms; `None` of a missed beat.
    pub onset_ms: Option<f64>,
    /// How much of it there is.
    pub state: State,
    /// What is odd about it, as sentences.
    pub remarks: Vec<String>,
    /// Its metrics, none of a missed beat.
    pub metrics: Vec<Metric>,
    /// Where they were read.
    #[serde(skip)]
    pub marks: Vec<Mark>,
    /// Baseline over the beat: its first and last point.
    #[serde(skip)]
    pub baseline: Option<[Point; 2]>,
}

/// A stretch of a curve that is not like its beats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Artefact {
    /// Time of its first frame, ms.
    pub from_ms: f64,
    /// Time of its last frame, ms.
    pub to_ms: f64,
    /// Its first and last frame, from 1.
    pub frames: [usize; 2],
    /// How far it departs at most from the line that replaces it, in the curve's unit.
    pub height: f64,
    /// Whether it lasts longer than from beat to beat: no beat is looked for in it.
    pub long: bool,
}

/// What was done to a curve before it was read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Treatment {
    /// Whether the curve rises in a beat; lengths fall.
    pub rises: bool,
    /// How beats were found.
    pub beats: String,
    /// How the value at rest is defined.
    pub baseline: &'static str,
    /// What became of drift.
    pub drift: &'static str,
    /// What was smoothed.
    pub smoothing: String,
    /// How rates were read.
    pub rates: String,
    /// Standard deviation of the noise, in the curve's unit.
    pub noise: f64,
    /// Frames that were replaced, from 1.
    pub bad_frames: Vec<usize>,
    /// Longer stretches that are no beats; lines replace them.
    pub artefacts: Vec<Artefact>,
    /// Holes in the times, across which no metric is read.
    pub holes: Vec<Hole>,
    /// What was taken off as mains hum: Hz and amplitude in the curve's unit.
    pub hum: Option<[f64; 2]>,
}

/// The beats of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// In order.
    pub beats: Vec<CurveBeat>,
    /// What was done.
    pub treatment: Treatment,
    /// What is odd about the rhythm, and what to doubt, as sentences.
    pub remarks: Vec<String>,
    /// The curve that metrics were read from: without bad frames and hum, smoothed; in the curve's unit.
    pub read: Vec<f64>,
}

impl Analysis {
    /// Mean and standard deviation of each metric over the beats that count: whole ones, and what those cut at the end
    /// still show. Of one beat there is no spread.
    pub fn spread(&self) -> Vec<Spread> {
        beat_to_beat(&self.counted())
    }

    /// Metrics of the beats that count in means.
    pub fn counted(&self) -> Vec<Vec<Metric>> {
        let counts = |beat: &&CurveBeat| matches!(beat.state, State::Whole | State::CutAtEnd);
        self.beats.iter().filter(counts).map(|beat| beat.metrics.clone()).collect()
    }

    /// The mean of a metric over the beats that count and show it.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let values: Vec<f64> = self.counted().iter().filter_map(|beat| value(beat, name)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// What does not rise above the noise, in words.
fn above_noise(noise: f64, least: f64, unit: &str) -> String {
    if noise.is_finite() && least.is_finite() {
        return format!(
            "nothing rises above the noise (standard deviation {noise:.3} {unit}) by the {least:.3} {unit} that a beat \
             would need"
        );
    }
    "too few frames are free of artefacts to tell a beat from noise".to_owned()
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
