//! One pulse above its baseline: where it rises, peaks and falls. Every metric of a beat is read from it, whether the beat
//! was simulated or measured.

use super::trace::{self, Point};

/// Height, as a part of the peak, below which noise tells more about the logarithm of a height than the fall does: a
/// twentieth of that height.
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
    start: f64,
    peak: Option<Point>,
    /// Samples among which its rise is.
    rise: usize,
    noise: f64,
    /// Slopes at the times, where they are not those between neighbours.
    slopes: Option<&'a [f64]>,
    /// Its steepest rise, where that was read in another way.
    steepest: Option<Point>,
}

impl<'a> Pulse<'a> {
    /// Of heights over times (ms), which begins at `start`; without a peak where no height is above zero.
    pub fn new(times: &'a [f64], heights: &'a [f64], start: f64, top: Top) -> Self {
        let peak = match top {
            Top::Vertex => trace::peak(times, heights),
            Top::Sample => trace::largest(times, heights),
        };
        let peak = peak.filter(|peak| peak.value > 0.0);
        let rise = times.len();
        Self { times, heights, start, peak, rise, noise: 0.0, slopes: None, steepest: None }
    }

    /// With a peak only where it is above this height.
    #[must_use]
    pub fn above(self, least: f64) -> Self {
        Self { peak: self.peak.filter(|peak| peak.value > least), ..self }
    }

    /// The same pulse with the samples that follow it: they show how it falls, and may rise again.
    #[must_use]
    pub fn followed_by(self, times: &'a [f64], heights: &'a [f64]) -> Self {
        Self { times, heights, ..self }
    }

    /// With heights that have noise of this standard deviation.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// With slopes at its times, per ms, that were read over more than two samples.
    #[must_use]
    pub fn with_slopes(self, slopes: Option<&'a [f64]>) -> Self {
        Self { slopes, ..self }
    }

    /// With a steepest rise that is known.
    #[must_use]
    pub fn with_steepest(self, steepest: Option<Point>) -> Self {
        Self { steepest, ..self }
    }

    /// When it begins, ms.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Its top: time and height.
    pub fn peak(&self) -> Option<Point> {
        self.peak
    }

    /// When it last rises through a part of its peak before the peak, ms.
    pub fn rises(&self, part: f64) -> Option<f64> {
        let Point { time, value } = self.peak?;
        trace::last_rise_through(self.times, self.heights, part * value, self.start, time)
    }

    /// When it first falls through a part of its peak after the peak, ms.
    pub fn falls(&self, part: f64) -> Option<f64> {
        let Point { time, value } = self.peak?;
        trace::falls_through(self.times, self.heights, part * value, time)
    }

    /// Time that it is above a part of its peak, ms.
    pub fn duration(&self, part: f64) -> Option<f64> {
        Some(self.falls(part)? - self.rises(part)?)
    }

    /// The steepest rise (`sign` 1), or fall (-1), after the pulse begins, as a positive slope per ms: between two samples,
    /// unless slopes, or the steepest rise itself, were given.
    pub fn fastest(&self, sign: f64) -> Option<Point> {
        if sign > 0.0 && self.steepest.is_some() {
            return self.steepest.filter(|_| self.peak.is_some());
        }
        // The two samples that the start is between belong to the pulse.
        let before = self.times.partition_point(|time| *time <= self.start).saturating_sub(1);
        let (times, heights) = (&self.times[before..], &self.heights[before..]);
        let (places, slopes) = match self.slopes {
            Some(slopes) => (times.to_vec(), slopes[before..].to_vec()),
            None => trace::slopes(times, heights),
        };
        let slopes: Vec<f64> = slopes.iter().map(|slope| sign * slope).collect();
        trace::largest(&places, &slopes).filter(|_| self.peak.is_some())
    }

    /// The steepest rise, not among samples that follow the pulse.
    pub fn upstroke(&self) -> Option<Point> {
        if self.slopes.is_some() {
            return self.fastest(1.0);
        }
        let own = self.rise.min(self.times.len()).min(self.heights.len());
        Self { times: &self.times[..own], heights: &self.heights[..own], ..*self }.fastest(1.0)
    }

    /// Time constant of an exponential fitted to the fall from half to a tenth of the peak, ms: the slope of the
    /// logarithm, in which samples count the less the more of them is noise.
    pub fn time_constant(&self) -> Option<f64> {
        let (times, values) =
            trace::window(self.times, self.heights, self.falls(0.5)?, self.falls(0.1)?);
        if times.len() < 3 || values.iter().any(|value| *value <= 0.0) {
            return None;
        }
        let logs: Vec<f64> = values.iter().map(|value| value.ln()).collect();
        // 1 for all without noise.
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
        Some(-variance / covariance).filter(|tau| tau.is_finite() && *tau > 0.0)
    }

    /// Area between it and its baseline, of all its samples, unit times ms.
    pub fn area(&self) -> Option<f64> {
        self.peak.map(|_| trace::integral(self.times, self.heights))
    }

    /// Its lowest height.
    pub fn lowest(&self) -> Option<f64> {
        self.heights.iter().copied().reduce(f64::min)
    }

    /// Height of its last sample.
    pub fn last(&self) -> Option<f64> {
        self.heights.last().copied()
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
