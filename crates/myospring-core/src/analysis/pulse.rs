//! One pulse above its baseline: times and heights of rise, peak and fall. All metrics of simulated
//! and measured beats are read from it.

use super::trace::{self, Point};
use super::{Missing, Reading};

/// Relative noise of a sample from which on its logarithm has little weight in the time constant.
const LOG_NOISE: f64 = 0.05;

/// How the top of a pulse is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Top {
    /// The vertex of the parabola through the largest sample and its neighbours.
    Vertex,
    /// The largest sample, for curves with corners that no parabola fits.
    Sample,
}

/// A pulse: heights above a baseline over times in ms, from a start on.
///
/// # Example
/// ```
/// use myospring::analysis::pulse::{Pulse, Top};
/// // A triangle: up in 100 ms from 50 ms on, down in 200 ms.
/// let times: Vec<f64> = (0..=500).map(f64::from).collect();
/// let heights: Vec<f64> = times
///     .iter()
///     .map(|t| ((t - 50.0) / 100.0).min((350.0 - t) / 200.0).max(0.0))
///     .collect();
/// let pulse = Pulse::new(&times, &heights, 50.0, Top::Sample);
/// assert_eq!(pulse.peak().unwrap().time, 150.0);
/// assert!((pulse.rises(0.1).unwrap() - 60.0).abs() < 1e-9);
/// assert!((pulse.falls(0.5).unwrap() - 250.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Pulse<'a> {
    times: &'a [f64],
    heights: &'a [f64],
    /// Time from which on heights belong to it, including its foot and the rest before it.
    rest: f64,
    start: f64,
    peak: Result<Point, Missing>,
    /// Number of samples in which its rise is searched.
    rise: usize,
    noise: f64,
    /// Slopes at the times; `None` uses those between neighbours.
    slopes: Option<&'a [f64]>,
    /// Its steepest rise, if it was read in another way.
    steepest: Option<Point>,
}

impl<'a> Pulse<'a> {
    /// A pulse of heights over times (ms) that begins at `start`; its peak is searched after that.
    /// It has no peak if no height is above zero.
    pub fn new(times: &'a [f64], heights: &'a [f64], start: f64, top: Top) -> Self {
        Self::resting_from(start, times, heights, start, top)
    }

    /// Like [`Pulse::new`], but heights from `rest` on belong to the pulse (such as those of a
    /// foot), although it begins at `start`.
    pub fn resting_from(
        rest: f64,
        times: &'a [f64],
        heights: &'a [f64],
        start: f64,
        top: Top,
    ) -> Self {
        let first = times.partition_point(|time| *time < start).min(heights.len());
        let (own_times, own) = (&times[first..], &heights[first..]);
        let peak = match top {
            Top::Vertex => trace::peak(own_times, own),
            Top::Sample => trace::largest(own_times, own),
        };
        let peak = peak.filter(|peak| peak.value > 0.0).ok_or(Missing::NoRise);
        let rise = times.len();
        Self { times, heights, rest, start, peak, rise, noise: 0.0, slopes: None, steepest: None }
    }

    /// Removes the peak unless it is above this height.
    #[must_use]
    pub fn above(self, least: f64) -> Self {
        let peak = self
            .peak
            .and_then(|peak| if peak.value > least { Ok(peak) } else { Err(Missing::NoRise) });
        Self { peak, ..self }
    }

    /// Adds samples after the pulse, which show its fall and may rise again.
    #[must_use]
    pub fn followed_by(self, times: &'a [f64], heights: &'a [f64]) -> Self {
        Self { times, heights, ..self }
    }

    /// Sets the standard deviation of the noise of the heights.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// Sets slopes at its times, per ms, that were read over more than two samples.
    #[must_use]
    pub fn with_slopes(self, slopes: Option<&'a [f64]>) -> Self {
        Self { slopes, ..self }
    }

    /// Sets a known steepest rise.
    #[must_use]
    pub fn with_steepest(self, steepest: Option<Point>) -> Self {
        Self { steepest, ..self }
    }

    /// Its start, ms.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Its top: time and height.
    ///
    /// # Errors
    /// A pulse without a peak; the same for all methods below.
    pub fn peak(&self) -> Result<Point, Missing> {
        self.peak
    }

    /// Time at which it last rises through a part of its peak, before the peak, ms.
    ///
    /// # Errors
    /// The pulse does not cross that level.
    pub fn rises(&self, part: f64) -> Reading {
        let Point { time, value } = self.peak?;
        let level = part * value;
        let found = trace::last_rise_through(self.times, self.heights, level, self.rest, time);
        found.ok_or(Missing::NotReached)
    }

    /// Time at which it first falls through a part of its peak, after the peak, ms.
    ///
    /// # Errors
    /// The pulse does not cross that level.
    pub fn falls(&self, part: f64) -> Reading {
        let Point { time, value } = self.peak?;
        let found = trace::falls_through(self.times, self.heights, part * value, time);
        found.ok_or(Missing::NotReached)
    }

    /// Time during which it is above a part of its peak, ms.
    ///
    /// # Errors
    /// The pulse does not cross that level on both sides.
    pub fn duration(&self, part: f64) -> Reading {
        Ok(self.falls(part)? - self.rises(part)?)
    }

    /// The steepest rise (`sign` 1), or fall (-1), after the pulse begins, as a positive slope per
    /// ms: between two samples, unless slopes or the steepest rise were set.
    ///
    /// # Errors
    /// No slope in this direction.
    pub fn fastest(&self, sign: f64) -> Result<Point, Missing> {
        self.peak?;
        if sign > 0.0
            && let Some(steepest) = self.steepest
        {
            return Ok(steepest);
        }
        // Both samples around the start belong to the pulse.
        let before = self.times.partition_point(|time| *time <= self.start).saturating_sub(1);
        let (times, heights) = (&self.times[before..], &self.heights[before..]);
        let (places, slopes) = match self.slopes {
            Some(slopes) => (times.to_vec(), slopes[before..].to_vec()),
            None => trace::slopes(times, heights),
        };
        let slopes: Vec<f64> = slopes.iter().map(|slope| sign * slope).collect();
        let found = trace::largest(&places, &slopes).filter(|slope| slope.value > 0.0);
        found.ok_or(Missing::NotReached)
    }

    /// The steepest rise, excluding samples that were added after the pulse.
    ///
    /// # Errors
    /// The pulse does not rise.
    pub fn upstroke(&self) -> Result<Point, Missing> {
        if self.slopes.is_some() {
            return self.fastest(1.0);
        }
        let own = self.rise.min(self.times.len()).min(self.heights.len());
        Self { times: &self.times[..own], heights: &self.heights[..own], ..*self }.fastest(1.0)
    }

    /// Time constant of an exponential fitted to the fall from half to a tenth of the peak, ms:
    /// from the slope of the logarithm, in which noisy samples have less weight.
    ///
    /// # Errors
    /// The pulse does not fall so far, has fewer than three samples there, or does not decay.
    pub fn time_constant(&self) -> Reading {
        let (times, values) =
            trace::window(self.times, self.heights, self.falls(0.5)?, self.falls(0.1)?);
        if times.len() < 3 || values.iter().any(|value| *value <= 0.0) {
            return Err(Missing::NotReached);
        }
        let logs: Vec<f64> = values.iter().map(|value| value.ln()).collect();
        // 1 for all samples without noise.
        let weight = |value: &f64| 1.0 / (1.0 + (self.noise / (LOG_NOISE * value)).powi(2));
        let weights: Vec<f64> = values.iter().map(weight).collect();
        let count: f64 = weights.iter().sum();
        let mean = |list: &[f64]| {
            weights.iter().zip(list).map(|(weight, value)| weight * value).sum::<f64>() / count
        };
        let (mean_t, mean_l) = (mean(times), mean(&logs));
        let samples = || weights.iter().zip(times.iter().zip(&logs));
        let covariance: f64 = samples().map(|(w, (t, l))| w * (t - mean_t) * (l - mean_l)).sum();
        let variance: f64 = samples().map(|(w, (t, _))| w * (t - mean_t).powi(2)).sum();
        let tau = -variance / covariance;
        if tau.is_finite() && tau > 0.0 { Ok(tau) } else { Err(Missing::NotReached) }
    }

    /// Area between it and its baseline, of all its samples, unit times ms.
    ///
    /// # Errors
    /// Without a peak.
    pub fn area(&self) -> Reading {
        self.peak.map(|_| trace::integral(self.times, self.heights))
    }

    /// Its lowest height.
    ///
    /// # Errors
    /// Without samples.
    pub fn lowest(&self) -> Reading {
        self.heights.iter().copied().reduce(f64::min).ok_or(Missing::NotRecorded)
    }

    /// Height of its last sample.
    ///
    /// # Errors
    /// Without samples.
    pub fn last(&self) -> Reading {
        self.heights.last().copied().ok_or(Missing::NotRecorded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_steep_before_a_pulse_begins_is_not_its_own() {
        // A jerk at 10 ms, five times as steep as the pulse that begins at 50 ms.
        let times: Vec<f64> = (0..=100).map(f64::from).collect();
        let height = |t: &f64| match *t {
            t if t < 15.0 => (-(t - 10.0).powi(2)).exp(),
            t if t < 50.0 => 0.0,
            t => (t - 50.0) * 0.1 * (-(t - 50.0) / 20.0).exp(),
        };
        let heights: Vec<f64> = times.iter().map(height).collect();
        for start in [49.5, 50.0] {
            let pulse = Pulse::new(&times, &heights, start, Top::Vertex);
            let [rise, fall] = [1.0, -1.0].map(|sign| pulse.fastest(sign).unwrap());
            assert!(rise.time > start && (rise.value - 0.095).abs() < 0.01, "{rise:?}");
            assert!(fall.time > start && fall.value < 0.02, "{fall:?}");
        }
        // An upstroke between the two samples that the start is between is not lost.
        let pulse = Pulse::new(&times, &heights, 50.6, Top::Vertex);
        assert_eq!(pulse.fastest(1.0).unwrap().time, 50.5);
    }
}
