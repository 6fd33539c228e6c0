//! Beats that two curves have in common, and why two curves have none.

use super::course::Loop;
use crate::analysis::kind::Kind;
use crate::analysis::{Metric, value};
use serde::Serialize;

/// Two curves of the same beats.
#[derive(Debug, Clone, PartialEq)]
pub struct Paired {
    /// Beats in both curves or in one of them, in order.
    pub beats: Vec<PairedBeat>,
    /// Loops of the beats that count; each begins at the onset of calcium.
    pub loops: Vec<(usize, Loop)>,
    /// Their mean, aligned at the onset of calcium; `None` without a beat that counts.
    pub mean_loop: Option<Loop>,
    /// Unit of the motion in loops: `%` of the length at rest for lengths.
    pub motion_unit: &'static str,
    /// Which way round its loops go.
    pub direction: Direction,
    /// Remarks, as sentences.
    pub remarks: Vec<String>,
}

/// A beat of both curves, or of one of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairedBeat {
    /// From 1.
    pub number: usize,
    /// Its number among the beats of calcium.
    pub calcium_beat: Option<usize>,
    /// Its number among the beats of the motion.
    pub motion_beat: Option<usize>,
    /// Whether it counts in means: both curves have it whole, or cut only at the end.
    pub counts: bool,
    /// Why it does not count, or what is odd about it; empty otherwise.
    pub remark: String,
    /// Its metrics; empty if only one curve has it.
    pub metrics: Vec<Metric>,
}

/// Which way round a loop is run through, with calcium to the right and motion upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Motion follows calcium.
    CounterClockwise,
    /// Calcium follows motion.
    Clockwise,
    /// Noise or differences between beats are larger than the area.
    Unknown,
}

impl Direction {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::CounterClockwise => "counter-clockwise",
            Self::Clockwise => "clockwise",
            Self::Unknown => "not determined",
        }
    }
}

/// Why two curves were not recorded together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PairError {
    /// A curve is not of the kind that is needed.
    #[error(
        "a curve of {0} cannot be paired; one curve of calcium and one of motion or tension are needed"
    )]
    Kind(Kind),
    /// Their times do not overlap.
    #[error(
        "the times do not overlap: calcium was recorded from {:.0} to {:.0} ms, the other curve from {:.0} to {:.0} ms",
        calcium_ms[0], calcium_ms[1], motion_ms[0], motion_ms[1]
    )]
    Apart {
        /// First and last frame of calcium, ms.
        calcium_ms: [f64; 2],
        /// First and last frame of the motion, ms.
        motion_ms: [f64; 2],
    },
    /// Too few beats belong together.
    #[error(
        "the beats do not belong together: while both curves were recorded, calcium has {calcium} beats and the other \
         curve {motion}, of which {matched} come at the same time"
    )]
    Beats {
        /// Beats of calcium while both were recorded.
        calcium: usize,
        /// Beats of the motion while both were recorded.
        motion: usize,
        /// Pairs.
        matched: usize,
    },
}

impl Paired {
    /// The metrics of each beat that counts.
    pub fn counted(&self) -> Vec<Vec<Metric>> {
        let counted = self.beats.iter().filter(|beat| beat.counts);
        counted.map(|beat| beat.metrics.clone()).collect()
    }

    /// The mean of a metric over the beats that count and have it.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let counted = self.beats.iter().filter(|beat| beat.counts);
        let values: Vec<f64> = counted.filter_map(|beat| value(&beat.metrics, name)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}
