//! A train of beats, and how often cell and mesh meet in it.

/// Most between samples, ms: a longer interval moves a curve by 1e-4 of its height.
const INTERVAL_MS: f64 = 2.0;

/// Beats at equal intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Train {
    /// Beats before those that are wanted.
    pub before: usize,
    /// Those that are.
    pub beats: usize,
    /// From stimulus to stimulus, ms.
    pub cycle_ms: f64,
}

impl Train {
    /// Samples of a cycle.
    pub(super) fn intervals(&self) -> usize {
        ((self.cycle_ms / INTERVAL_MS).ceil() as usize).max(3)
    }

    /// Between samples, ms: a cycle is a whole number of them.
    pub fn interval_ms(&self) -> f64 {
        self.cycle_ms / self.intervals() as f64
    }
}
