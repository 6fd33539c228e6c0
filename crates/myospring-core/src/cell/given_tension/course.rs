//! Samples of a prescribed tension, and from when their times count.

use crate::analysis::monotone::MonotoneCubic;
use crate::cell::samples::{SampleBounds, TraceError, check};

/// Samples of an active tension, kPa over ms, with a monotone cubic between them.
///
/// # Example
/// ```
/// use myospring::cell::given_tension::TensionCourse;
/// let course = TensionCourse::new(&[0.0, 100.0, 200.0, 400.0], &[0.0, 30.0, 30.0, 0.0])?;
/// assert_eq!(course.at(100.0), 30.0);
/// assert!(course.at(150.0) <= 30.0); // no peak that the rows do not have
/// assert_eq!([course.at(-5.0), course.at(900.0)], [0.0, 0.0]);
/// # Ok::<(), myospring::cell::calcium::TraceError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TensionCourse(pub(super) MonotoneCubic);

impl TensionCourse {
    /// Largest accepted tension, kPa; a course above it has another unit.
    pub const MOST_KPA: f64 = 500.0;

    /// Makes a course from ascending times (ms) and as many tensions (kPa).
    ///
    /// # Errors
    /// Lists of different length, times that do not rise, a tension below 0 or above
    /// [`Self::MOST_KPA`], or fewer than two samples after time 0.
    pub fn new(times_ms: &[f64], tensions_kpa: &[f64]) -> Result<Self, TraceError> {
        let bounds = SampleBounds { what: "tension", unit: "kPa", most: Self::MOST_KPA };
        check(times_ms, tensions_kpa, bounds)?;
        Ok(Self(MonotoneCubic::new(times_ms.to_vec(), tensions_kpa.to_vec())))
    }

    /// Tension at a time (ms), kPa: the first value before the first row, the last one after the
    /// last row.
    pub fn at(&self, time_ms: f64) -> f64 {
        self.0.at(time_ms)
    }

    /// Its greatest tension, kPa.
    pub fn peak(&self) -> f64 {
        self.0.values().iter().copied().fold(0.0, f64::max)
    }

    /// Tension at time 0 and in the last row, kPa. If they differ, the tension of a beat jumps at
    /// the next stimulus.
    pub fn ends(&self) -> [f64; 2] {
        [self.at(0.0), self.at(f64::INFINITY)]
    }
}

/// From when the time of a prescribed tension counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TensionClock {
    /// From each stimulus: one beat, which restarts with every stimulus. Before the first stimulus
    /// the tension is that at time 0.
    #[default]
    Stimulus,
    /// From the start of the run: a whole recording. Stimuli only mark the beats.
    Run,
}
