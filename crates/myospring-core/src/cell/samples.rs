//! Samples of a prescribed course: what makes them valid.

/// What is sampled, and its largest possible value; the smallest is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleBounds {
    /// The quantity: `calcium`.
    pub what: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The largest accepted value; a larger one has another unit.
    pub most: f64,
}

/// Why samples are not a valid course; samples are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// The numbers of times and values differ.
    #[error("{times} times and {values} values; give one for each")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// Too few samples after the stimulus.
    #[error(
        "{samples} samples after the stimulus, at 0 ms; a course needs at least 2: time counts from the stimulus"
    )]
    Few {
        /// How many there are.
        samples: usize,
    },
    /// A time that is not finite, or not after the previous one.
    #[error("time {value} ms does not come after {before} ms; times must rise from row to row")]
    Time {
        /// Which sample.
        sample: usize,
        /// Its time, ms.
        value: f64,
        /// The previous time, ms.
        before: f64,
    },
    /// An impossible value.
    #[error("{} is {value} {unit}; it must be between 0 and {} {unit}", bounds.what, bounds.most, unit = bounds.unit)]
    Value {
        /// Which sample.
        sample: usize,
        /// Its value.
        value: f64,
        /// What is possible.
        bounds: SampleBounds,
    },
}

impl TraceError {
    /// The sample that caused the error, if there is one.
    pub fn sample(&self) -> Option<usize> {
        match *self {
            Self::Time { sample, .. } | Self::Value { sample, .. } => Some(sample),
            Self::Lengths { .. } | Self::Few { .. } => None,
        }
    }
}

/// Checks samples over ascending times (ms) and returns the first after time 0.
///
/// # Errors
/// Lists of different length, times that do not rise, an impossible value, or fewer than two samples
/// after time 0.
pub(super) fn check(
    times_ms: &[f64],
    values: &[f64],
    bounds: SampleBounds,
) -> Result<usize, TraceError> {
    let times = times_ms.len();
    if times != values.len() {
        return Err(TraceError::Lengths { times, values: values.len() });
    }
    let mut before = f64::NEG_INFINITY;
    for (sample, (&time, &value)) in times_ms.iter().zip(values).enumerate() {
        if !(time.is_finite() && time > before) {
            return Err(TraceError::Time { sample, value: time, before });
        }
        if !(0.0..=bounds.most).contains(&value) {
            return Err(TraceError::Value { sample, value, bounds });
        }
        before = time;
    }
    let first = times_ms.partition_point(|time| *time <= 0.0);
    let samples = times - first;
    if samples < 2 { Err(TraceError::Few { samples }) } else { Ok(first) }
}
