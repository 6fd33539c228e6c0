//! A train of beats, and its exchange interval.

/// Longest interval between samples, ms; a longer one changes a curve by 1e-4 of its height.
const INTERVAL_MS: f64 = 2.0;

/// Beats at equal intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Train {
    /// Beats before the requested ones.
    pub before: usize,
    /// Requested beats.
    pub beats: usize,
    /// From stimulus to stimulus, ms.
    pub cycle_ms: f64,
}

impl Train {
    /// Samples of a cycle.
    pub(super) fn intervals(&self) -> usize {
        ((self.cycle_ms / INTERVAL_MS).ceil() as usize).max(3)
    }

    /// Interval between samples, ms, a whole part of the cycle.
    pub fn interval_ms(&self) -> f64 {
        self.cycle_ms / self.intervals() as f64
    }
}
