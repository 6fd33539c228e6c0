//! How beats of measured curves are found.

use super::error::ExperimentError;
use crate::analysis::curve::CurveOptions;
use crate::measured::Curve;

/// Shortest and longest interval between stimuli, ms. The shortest is a tenth of the cycle of the
/// fastest hearts, which limits their number; the longest is that of the setting.
const PERIODS_MS: [f64; 2] = [10.0, 1e5];
/// Longest smoothing, ms.
const MOST_SMOOTHING_MS: f64 = 1e5;

/// How beats of measured curves are found and read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BeatOptions {
    /// Times of the stimuli, ms on the clock of the curve; if empty, those marked in the file are
    /// used.
    pub stimuli_ms: Vec<f64>,
    /// Stimuli at regular intervals instead, ms, from `start_ms` to the end of the curve.
    pub period_ms: Option<f64>,
    /// The first of them, ms on the clock of the curve; the first frame unless given.
    pub start_ms: Option<f64>,
    /// Half of the window of local parabolas, ms; 0 for none, by the noise unless given.
    pub smoothing_ms: Option<f64>,
    /// Leave the drift of the baseline in.
    pub keep_drift: bool,
}

impl BeatOptions {
    /// Refuses a period or a smoothing that no recording has.
    ///
    /// # Errors
    /// The option with its bounds.
    pub fn check(&self) -> Result<(), ExperimentError> {
        let [least, most] = PERIODS_MS;
        if let Some(period) = self.period_ms.filter(|period| !(least..=most).contains(period)) {
            return Err(ExperimentError::new(format!(
                "--stimulus-period is {period} ms; it must be at least {least} ms, at most {most} ms"
            ))
            .advise("give it with its unit, like --stimulus-period \"1 s\""));
        }
        match self.smoothing_ms.filter(|smooth| !(0.0..=MOST_SMOOTHING_MS).contains(smooth)) {
            Some(smooth) => Err(ExperimentError::new(format!(
                "--smooth is {smooth} ms; it must be 0 to {MOST_SMOOTHING_MS} ms"
            ))),
            None => Ok(()),
        }
    }

    /// For one curve: regular stimuli end with it.
    pub fn within(&self, curve: &Curve) -> CurveOptions {
        let mut stimuli_ms = self.stimuli_ms.clone();
        if stimuli_ms.is_empty() {
            stimuli_ms.clone_from(&curve.stimuli_ms);
        }
        if let (Some(period), [first, .., last]) = (self.period_ms, &curve.times_ms[..]) {
            let start = self.start_ms.unwrap_or(*first);
            let count = ((last - start) / period).floor().clamp(-1.0, 1e6) as i64;
            stimuli_ms = (0..=count).map(|index| start + index as f64 * period).collect();
        }
        CurveOptions { stimuli_ms, smoothing_ms: self.smoothing_ms, keep_drift: self.keep_drift }
    }
}
