//! A measured course of calcium.

use crate::cell::samples::{SampleBounds, TraceError, check};

/// Samples of one beat, in uM over the time since the stimulus.
///
/// The mean of samples up to the stimulus (at 0 ms) is calcium at rest; without any, it is the
/// first sample.
///
/// # Example
/// ```
/// use myospring::cell::calcium::CalciumTrace;
/// let trace = CalciumTrace::new(&[-10.0, 0.0, 50.0, 400.0], &[0.09, 0.11, 0.6, 0.1])?;
/// assert_eq!(trace.at(f64::INFINITY), 0.1); // at rest, before the first stimulus
/// assert!((trace.at(25.0) - 0.35).abs() < 1e-12);
/// assert_eq!(trace.at(1000.0), 0.1);
/// # Ok::<(), myospring::cell::calcium::TraceError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CalciumTrace {
    /// Times from 0 ms on.
    times_ms: Vec<f64>,
    calcium_um: Vec<f64>,
}

impl CalciumTrace {
    /// Largest accepted concentration, uM; a trace above it has another unit.
    pub const MOST_UM: f64 = 100.0;

    /// Makes a trace from ascending times (ms after the stimulus) and as many concentrations in uM.
    ///
    /// # Errors
    /// Lists of different length, times that do not rise, an impossible concentration, or fewer
    /// than two samples after the stimulus.
    pub fn new(times_ms: &[f64], calcium_um: &[f64]) -> Result<Self, TraceError> {
        let bounds = SampleBounds { what: "calcium", unit: "uM", most: Self::MOST_UM };
        let first = check(times_ms, calcium_um, bounds)?;
        let rest = match first {
            0 => calcium_um[0],
            _ => calcium_um[..first].iter().sum::<f64>() / first as f64,
        };
        let from_rest = |at: f64, list: &[f64]| [&[at], &list[first..]].concat();
        Ok(Self { times_ms: from_rest(0.0, times_ms), calcium_um: from_rest(rest, calcium_um) })
    }

    /// Calcium at a time (ms) after the stimulus, uM.
    pub fn at(&self, since_stimulus_ms: f64) -> f64 {
        let Self { times_ms, calcium_um } = self;
        if since_stimulus_ms == f64::INFINITY {
            return calcium_um[0];
        }
        let after = times_ms.partition_point(|time| *time <= since_stimulus_ms);
        match (after, calcium_um.get(after)) {
            (0, _) => calcium_um[0],
            (_, None) => calcium_um[after - 1],
            (_, Some(&next)) => {
                let (start, end) = (times_ms[after - 1], times_ms[after]);
                let part = (since_stimulus_ms - start) / (end - start);
                calcium_um[after - 1] + part * (next - calcium_um[after - 1])
            }
        }
    }

    /// Calcium at rest, in the last sample, and its peak, uM. If the first two differ, calcium
    /// jumps at the next stimulus.
    pub fn ends(&self) -> [f64; 3] {
        let peak = self.calcium_um.iter().copied().fold(0.0, f64::max);
        [self.calcium_um[0], self.calcium_um[self.calcium_um.len() - 1], peak]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_are_no_course_are_refused_with_their_place() {
        let refused = |times: &[f64], values: &[f64]| CalciumTrace::new(times, values).unwrap_err();
        assert_eq!(refused(&[0.0], &[]), TraceError::Lengths { times: 1, values: 0 });
        assert_eq!(refused(&[-5.0, 0.0, 5.0], &[0.1; 3]), TraceError::Few { samples: 1 });
        let error = refused(&[0.0, 5.0, 5.0], &[0.1; 3]);
        assert_eq!(error, TraceError::Time { sample: 2, value: 5.0, before: 5.0 });
        for bad in [-0.1, f64::NAN, 240.0] {
            let error = refused(&[0.0, 5.0, 9.0], &[0.1, bad, 0.1]);
            assert_eq!(error.sample(), Some(1), "{error}");
            assert!(error.to_string().contains("between 0 and 100 uM"), "{error}");
        }
    }

    #[test]
    fn a_trace_without_samples_before_the_stimulus_begins_at_its_first() {
        let trace = CalciumTrace::new(&[10.0, 20.0], &[0.2, 0.6]).unwrap();
        assert_eq!([trace.at(0.0), trace.at(5.0), trace.at(10.0)], [0.2; 3]);
        assert!((trace.at(15.0) - 0.4).abs() < 1e-12);
        assert_eq!(trace.ends(), [0.2, 0.6, 0.6]);
    }
}
