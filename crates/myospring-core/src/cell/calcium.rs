//! Prescribed calcium: a course over each beat, which begins with the stimulus.
//!
//! ```text
//! two exponentials: Ca(s) = rest + A (exp(-s/t_fall) - exp(-s/t_rise)) / highest value of that difference
//! a trace:          linear interpolation between samples, then the last value until the next stimulus
//! ```
//! `s` is the time since the last stimulus; before the first, calcium is at rest. A stimulus before
//! the end of the course restarts it.

mod trace;

pub use super::samples::TraceError;
pub use trace::CalciumTrace;

use super::description::{ModelError, required};
use crate::parameter::{Parameter, ParameterSet};

/// The course of prescribed calcium.
#[derive(Debug, Clone, PartialEq)]
pub enum Calcium {
    /// An exponential rise and an exponential fall.
    TwoExponential(TwoExponential),
    /// Samples.
    Trace(CalciumTrace),
}

impl Calcium {
    /// Calcium at a time (ms) after the last stimulus, uM; infinite before the first.
    pub fn at(&self, since_stimulus_ms: f64) -> f64 {
        match self {
            Self::TwoExponential(course) => course.at(since_stimulus_ms),
            Self::Trace(trace) => trace.at(since_stimulus_ms),
        }
    }

    /// Calcium before the first stimulus, uM.
    pub fn rest(&self) -> f64 {
        self.at(f64::INFINITY)
    }
}

/// An exponential rise and an exponential fall.
///
/// # Example
/// ```
/// use myospring::cell::calcium::TwoExponential;
/// let calcium = TwoExponential::new(0.06, 0.44, 24.0, 146.0)?;
/// assert_eq!(calcium.at(f64::INFINITY), 0.06);
/// assert!((calcium.at(calcium.peak_ms()) - 0.5).abs() < 1e-12);
/// # Ok::<(), myospring::cell::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoExponential {
    rest: f64,
    amplitude: f64,
    rise_ms: f64,
    fall_ms: f64,
    /// Highest value of the difference of the exponentials.
    highest: f64,
}

/// Name, value, unit, smallest and largest, meaning.
type Row = (&'static str, f64, &'static str, [f64; 2], &'static str);

const ROWS: [Row; 4] = [
    ("Ca_rest", 0.0632, "uM", [0.0, 10.0], "calcium at rest"),
    ("Ca_amplitude", 0.4391, "uM", [0.0, 100.0], "highest calcium above rest"),
    ("tau_Ca_rise", 23.8, "ms", [0.01, 1e4], "time constant of calcium's rise"),
    ("tau_Ca_fall", 145.5, "ms", [0.01, 1e4], "time constant of calcium's fall"),
];

/// Its parameters, fitted to the transient of ToR-ORd with Land's myofilaments (root mean square 0.015 uM).
pub fn rows() -> Vec<Parameter> {
    let source = "our fit to the transient of ToR-ORd-Land (tomek_2019, margara_2021), endo, 1 Hz";
    let row = |&(name, value, unit, range, meaning): &Row| {
        Parameter::new(name, value, unit, range, meaning, source)
    };
    ROWS.iter().map(row).collect()
}

impl TwoExponential {
    /// From calcium at rest and above it (uM) and the two time constants (ms).
    ///
    /// # Errors
    /// The fall is not slower than the rise.
    pub fn new(rest: f64, amplitude: f64, rise_ms: f64, fall_ms: f64) -> Result<Self, ModelError> {
        if fall_ms.is_nan() || rise_ms.is_nan() || fall_ms <= rise_ms {
            return Err(ModelError::Contradiction {
                model: "calcium by two exponentials".to_owned(),
                reason: format!(
                    "tau_Ca_fall = {fall_ms} ms must be longer than tau_Ca_rise = {rise_ms} ms"
                ),
            });
        }
        let mut course = Self { rest, amplitude, rise_ms, fall_ms, highest: 1.0 };
        course.highest = course.difference(course.peak_ms());
        Ok(course)
    }

    /// Reads the four parameters by name.
    ///
    /// # Errors
    /// A parameter is missing, or a fall that is not slower than the rise.
    pub fn of(model: &str, parameters: &ParameterSet) -> Result<Self, ModelError> {
        let read = |name| required(model, parameters, name);
        Self::new(
            read("Ca_rest")?,
            read("Ca_amplitude")?,
            read("tau_Ca_rise")?,
            read("tau_Ca_fall")?,
        )
    }

    /// Time of the peak, ms after the stimulus.
    pub fn peak_ms(&self) -> f64 {
        // d/ds = 0: s = t_rise t_fall / (t_fall - t_rise) ln(t_fall / t_rise)
        let Self { rise_ms, fall_ms, .. } = *self;
        rise_ms * fall_ms / (fall_ms - rise_ms) * (fall_ms / rise_ms).ln()
    }

    /// Calcium at a time (ms) after the stimulus, uM.
    pub fn at(&self, since_stimulus_ms: f64) -> f64 {
        self.rest + self.amplitude * self.difference(since_stimulus_ms.max(0.0)) / self.highest
    }

    fn difference(&self, s: f64) -> f64 {
        (-s / self.fall_ms).exp() - (-s / self.rise_ms).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_exponentials_begin_at_rest_peak_once_and_come_back() {
        let course = TwoExponential::of("it", &ParameterSet::new(rows())).unwrap();
        assert_eq!([course.at(0.0), course.at(f64::INFINITY)], [0.0632, 0.0632]);
        let peak = course.peak_ms();
        assert!((course.at(peak) - 0.5023).abs() < 1e-12, "{} uM", course.at(peak));
        for by in [-1.0, 1.0] {
            assert!(course.at(peak + by) < course.at(peak));
        }
        // exp(-1000/145.5) of the tail is left after a second.
        assert!((course.at(1000.0) - 0.0632).abs() < 2e-3);
    }

    #[test]
    fn a_fall_that_is_not_slower_than_the_rise_is_refused() {
        let error = TwoExponential::new(0.1, 0.4, 30.0, 30.0).unwrap_err().to_string();
        assert!(error.contains("tau_Ca_fall = 30 ms must be longer than tau_Ca_rise"), "{error}");
    }
}
