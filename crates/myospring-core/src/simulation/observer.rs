//! Observers of a run.

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Time simulated so far, ms.
    pub time: f64,
    /// Time to be simulated, ms.
    pub duration: f64,
}

/// A part of the work of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunPart {
    /// The cell model advances.
    Cell,
    /// The mesh follows its tension.
    Mechanics,
    /// Samples and shapes are taken.
    Recording,
}

/// Observes a run. The library has no clock; an observer with one can measure the time of each
/// part.
pub trait RunObserver {
    /// A sample was recorded; `false` stops the run.
    fn sample(&mut self, progress: Progress) -> bool;

    /// Called when the run ends one part and begins another.
    fn begins(&mut self, _part: RunPart) {}
}

/// An observer of samples only.
pub(super) struct Samples<F>(pub(super) F);

impl<F: FnMut(Progress) -> bool> RunObserver for Samples<F> {
    fn sample(&mut self, progress: Progress) -> bool {
        self.0(progress)
    }
}
