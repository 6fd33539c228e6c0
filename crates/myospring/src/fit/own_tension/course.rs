//! What is said of the tension that a curve asks for.

use serde::Serialize;

/// The file that the run of a fit reads its tension from.
pub const FILE: &str = "tension.csv";
/// Standard deviations from the middle of a 95 % band to its ends.
pub(in crate::fit) const NORMAL: f64 = 1.96;

/// An active tension over time that makes a cell follow its curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OwnTension {
    /// Times of the frames since the first frame, ms.
    pub times_ms: Vec<f64>,
    /// Tension, kPa; 0 where the cell is longer than at rest.
    pub tension_kpa: Vec<f64>,
    /// The same, below 0 where the cell is longer than at rest.
    #[serde(skip)]
    pub unclipped_kpa: Vec<f64>,
    /// Its standard deviation, kPa.
    pub standard_deviation_kpa: Vec<f64>,
    /// Ends of its 95 % band, kPa.
    pub band_kpa: [Vec<f64>; 2],
    /// Young's modulus of the cell, kPa: a free cell's tension is known over it alone.
    pub young_modulus_kpa: f64,
    /// Frames whose tension would be below 0, and counts as 0.
    pub clipped: usize,
    /// Frames in which the cell is longer than before its beat.
    pub longer_than_before: usize,
    /// By how much the length without tension is above that before a beat, a part of it: 0 where noise explains these
    /// frames.
    pub rest_raised: f64,
    /// Frames in which it is shorter than any tension makes it.
    pub too_short: usize,
    /// The mean of its beats, aligned by their onset.
    pub mean_beat: Option<MeanBeat>,
    /// Its metrics, means over the beats that count.
    pub metrics: Vec<TensionMetric>,
}

/// A metric of a tension, with the interval of its mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TensionMetric {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// How it is defined.
    pub definition: &'static str,
    /// Mean over the beats that count.
    pub value: f64,
    /// Standard deviation of that mean by the noise of the frames: how it scatters and how far it is moved, such as a peak, which
    /// noise heightens.
    pub standard_deviation: f64,
    /// 95 % interval by the noise of the frames.
    pub interval_by_noise: [f64; 2],
    /// 95 % interval by the scatter of three beats or more.
    pub interval_by_beats: Option<[f64; 2]>,
    /// The one of both that is stated: by beats, where there is one, since it has the noise, too.
    pub interval: [f64; 2],
    /// Beats that have it.
    pub beats: usize,
    /// Whether it is a rate at which the tension passes its whole peak within three frames: then the true one may be
    /// larger.
    pub is_fast: bool,
}

/// The mean beat of a tension.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeanBeat {
    /// Times since the onset, ms.
    pub times_ms: Vec<f64>,
    /// Mean tension, kPa.
    pub tension_kpa: Vec<f64>,
    /// Standard error of the mean, kPa; of one beat its noise.
    pub standard_error_kpa: Vec<f64>,
    /// How many beats.
    pub beats: usize,
}
