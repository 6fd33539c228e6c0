//! Whoever watches a run.

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Time simulated so far, ms.
    pub time: f64,
    /// Time to be simulated, ms.
    pub duration: f64,
}

/// What a run is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunPart {
    /// The cell model moves on.
    Cell,
    /// The mesh follows its tension.
    Mechanics,
    /// Samples and shapes are taken.
    Recording,
}

/// Watches a run: the library has no clock, but whoever has one can measure each part by this.
pub trait RunObserver {
    /// A sample was recorded; `false` stops the run.
    fn sample(&mut self, progress: Progress) -> bool;

    /// The run leaves what it was at and begins something else.
    fn begins(&mut self, _part: RunPart) {}
}

/// An observer of samples only.
pub(super) struct Samples<F>(pub(super) F);

impl<F: FnMut(Progress) -> bool> RunObserver for Samples<F> {
    fn sample(&mut self, progress: Progress) -> bool {
        self.0(progress)
    }
}
