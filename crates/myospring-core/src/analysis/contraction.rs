//! Metrics of a contraction, per beat.
//!
//! Two conventions for the time to peak are in use: from the stimulus (`IonOptix`) and from the
//! crossing of 10 % of the peak (`MUSCLEMOTION`); both are given under names that say so.

use super::Metric;
use super::trace::{self, Point};

/// Peak shortening below which there is no contraction to speak of: a millionth of the length.
const LEAST: f64 = 1e-6;

/// Metrics of one beat from its length (um) over time (ms) and the time of its stimulus.
///
/// The baseline is the mean of the samples before the stimulus. Levels of 10, 50 and 90 % are parts
/// of the peak shortening. A value is `None` where the beat does not reach it.
///
/// # Example
/// ```
/// use myospring::analysis::{contraction, value};
/// let times: Vec<f64> = (0..=600).map(f64::from).collect();
/// // A bell of 12 % shortening, 150 ms after the stimulus at 20 ms, 50 ms broad.
/// let bell = |t: f64| (-0.5 * ((t - 170.0) / 50.0_f64).powi(2)).exp();
/// let length: Vec<f64> = times.iter().map(|&t| 100.0 * (1.0 - 0.12 * bell(t))).collect();
/// let metrics = contraction::metrics(&times, &length, 20.0);
/// assert!((value(&metrics, "peak_shortening").unwrap() - 12.0).abs() < 0.1);
/// assert!((value(&metrics, "time_to_peak_from_stimulus").unwrap() - 150.0).abs() < 0.1);
/// ```
pub fn metrics(times: &[f64], length: &[f64], stimulus: f64) -> Vec<Metric> {
    let baseline = trace::baseline(times, length, stimulus);
    let shortening: Vec<f64> =
        baseline.map(|rest| length.iter().map(|l| 1.0 - l / rest).collect()).unwrap_or_default();
    let peak = trace::peak(times, &shortening).filter(|peak| peak.value > LEAST);
    let after_peak = |part: f64| {
        peak.and_then(|Point { time, value }| {
            trace::falls_through(times, &shortening, part * value, time)
        })
    };
    let before_peak = |part: f64| {
        peak.and_then(|Point { time, value }| {
            trace::rises_through(times, &shortening, part * value, stimulus)
                .filter(|crossing| *crossing <= time)
        })
    };
    let between = |end: Option<f64>, start: Option<f64>| Some(end? - start?);
    let peak_time = peak.map(|peak| peak.time);
    let (middles, rates) = trace::slopes(times, &shortening);
    let fastest = |sign: f64| {
        let rates: Vec<f64> = rates.iter().map(|rate| sign * rate).collect();
        // 1/ms to 1/s
        trace::largest(&middles, &rates).filter(|_| peak.is_some()).map(|top| 1e3 * top.value)
    };
    let to_um_per_s = |rate: Option<f64>| Some(rate? * baseline?);
    let row = |name, value, unit, definition| Metric { name, value, unit, definition };
    vec![
        row("resting_length", baseline, "um", "mean length before the stimulus"),
        row(
            "minimum_length",
            Some(()).and_then(|()| Some(baseline? * (1.0 - peak?.value))),
            "um",
            "length at the peak of shortening",
        ),
        row(
            "peak_shortening",
            peak.map(|peak| 100.0 * peak.value),
            "%",
            "largest (resting length - length) / resting length",
        ),
        row(
            "peak_lengthening",
            shortening.iter().copied().reduce(f64::min).map(|least| (-100.0 * least).max(0.0)),
            "%",
            "largest (length - resting length) / resting length, 0 where it is never longer",
        ),
        row("time_of_peak", peak_time, "ms", "time of the largest shortening on the run's clock"),
        row(
            "time_to_peak_from_stimulus",
            between(peak_time, Some(stimulus)),
            "ms",
            "from the stimulus to the largest shortening (IonOptix)",
        ),
        row(
            "time_to_peak_from_10_percent",
            between(peak_time, before_peak(0.1)),
            "ms",
            "from 10 % of the peak shortening to the peak (MUSCLEMOTION)",
        ),
        row(
            "rise_time_10_90",
            between(before_peak(0.9), before_peak(0.1)),
            "ms",
            "from 10 % to 90 % of the peak shortening",
        ),
        row(
            "relaxation_time_50",
            between(after_peak(0.5), peak_time),
            "ms",
            "from the peak until 50 % relengthened",
        ),
        row(
            "relaxation_time_90",
            between(after_peak(0.1), peak_time),
            "ms",
            "from the peak until 90 % relengthened",
        ),
        row(
            "contraction_duration_10",
            between(after_peak(0.1), before_peak(0.1)),
            "ms",
            "time above 10 % of the peak shortening",
        ),
        row(
            "contraction_duration_50",
            between(after_peak(0.5), before_peak(0.5)),
            "ms",
            "time above 50 % of the peak shortening",
        ),
        row(
            "contraction_duration_90",
            between(after_peak(0.9), before_peak(0.9)),
            "ms",
            "time above 90 % of the peak shortening",
        ),
        row(
            "maximum_shortening_rate",
            fastest(1.0),
            "L0/s",
            "largest rate of shortening per resting length",
        ),
        row(
            "shortening_rate_over_peak",
            Some(()).and_then(|()| Some(fastest(1.0)? / peak?.value)),
            "1/s",
            "largest rate of shortening over the peak shortening: the shape of a beat, whatever its size",
        ),
        row(
            "maximum_relengthening_rate",
            fastest(-1.0),
            "L0/s",
            "largest rate of relengthening per resting length",
        ),
        row(
            "maximum_shortening_velocity",
            to_um_per_s(fastest(1.0)),
            "um/s",
            "largest velocity of shortening, end to end",
        ),
        row(
            "maximum_relengthening_velocity",
            to_um_per_s(fastest(-1.0)),
            "um/s",
            "largest velocity of relengthening, end to end",
        ),
        row(
            "relaxation_time_constant",
            relaxation_time_constant(times, &shortening, after_peak(0.5), after_peak(0.1)),
            "ms",
            "slope of log shortening between 50 % and 90 % relengthened",
        ),
        row(
            "area_under_curve",
            peak.map(|_| 100.0 * trace::integral(times, &shortening)),
            "% ms",
            "integral of the shortening over the beat",
        ),
        row(
            "residual_shortening",
            shortening.last().map(|last| 100.0 * last),
            "%",
            "shortening at the end of the beat",
        ),
    ]
}

/// Time constant of an exponential fitted to the fall between two times, ms.
fn relaxation_time_constant(
    times: &[f64],
    shortening: &[f64],
    from: Option<f64>,
    to: Option<f64>,
) -> Option<f64> {
    let (times, values) = trace::window(times, shortening, from?, to?);
    let count = times.len() as f64;
    if times.len() < 3 {
        return None;
    }
    let logs: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    let (mean_t, mean_l) = (times.iter().sum::<f64>() / count, logs.iter().sum::<f64>() / count);
    let covariance: f64 = times.iter().zip(&logs).map(|(t, l)| (t - mean_t) * (l - mean_l)).sum();
    let variance: f64 = times.iter().map(|t| (t - mean_t).powi(2)).sum();
    Some(-variance / covariance).filter(|tau| tau.is_finite() && *tau > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::value;

    /// Shortening of 10 % that rises linearly for 100 ms from 50 ms on, then decays with 80 ms.
    fn ramp_and_decay() -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..=2000).map(|i| f64::from(i) * 0.5).collect();
        let length = times
            .iter()
            .map(|&t| {
                let part = if t < 50.0 {
                    0.0
                } else if t < 150.0 {
                    (t - 50.0) / 100.0
                } else {
                    (-(t - 150.0) / 80.0).exp()
                };
                120.0 * (1.0 - 0.1 * part)
            })
            .collect();
        (times, length)
    }

    #[test]
    fn metrics_of_a_ramp_and_decay_have_their_closed_forms() {
        let (times, length) = ramp_and_decay();
        let metrics = metrics(&times, &length, 50.0);
        for (name, expected, tolerance) in [
            ("resting_length", 120.0, 1e-9),
            ("minimum_length", 108.0, 0.05),
            ("peak_shortening", 10.0, 0.05),
            ("time_to_peak_from_stimulus", 100.0, 0.5),
            ("time_to_peak_from_10_percent", 90.0, 0.5),
            ("rise_time_10_90", 80.0, 0.1),
            ("relaxation_time_50", 80.0 * 2.0_f64.ln(), 0.5),
            ("relaxation_time_90", 80.0 * 10.0_f64.ln(), 0.5),
            ("contraction_duration_50", 50.0 + 80.0 * 2.0_f64.ln(), 0.5),
            ("maximum_shortening_rate", 1.0, 1e-6),
            ("maximum_shortening_velocity", 120.0, 1e-4),
            ("maximum_relengthening_rate", 0.1 / 80.0 * 1e3, 0.01),
            ("relaxation_time_constant", 80.0, 1e-6),
            ("area_under_curve", 10.0 * (50.0 + 80.0), 1.0),
        ] {
            let measured = value(&metrics, name).unwrap();
            assert!((measured - expected).abs() <= tolerance, "{name}: {measured} not {expected}");
        }
    }

    #[test]
    fn a_cell_that_lengthens_says_by_how_much() {
        let metrics = metrics(&[0.0, 1.0, 2.0, 3.0], &[100.0, 100.0, 104.0, 100.0], 1.0);
        assert!((value(&metrics, "peak_lengthening").unwrap() - 4.0).abs() < 1e-9);
        assert_eq!(value(&metrics, "peak_shortening"), None);
        assert_eq!(value(&metrics, "time_to_peak_from_stimulus"), None);
    }

    #[test]
    fn a_beat_that_is_cut_short_has_no_relaxation() {
        let (times, length) = ramp_and_decay();
        let metrics = metrics(&times[..320], &length[..320], 50.0);
        assert!(value(&metrics, "peak_shortening").is_some());
        assert_eq!(value(&metrics, "relaxation_time_90"), None);
    }

    #[test]
    fn a_cell_that_never_shortens_has_no_peak() {
        let metrics = metrics(&[0.0, 1.0, 2.0], &[100.0, 100.0 - 1e-12, 100.0], 0.0);
        assert_eq!(value(&metrics, "peak_shortening"), None);
        assert_eq!(value(&metrics, "peak_lengthening"), Some(0.0));
        assert!(value(&metrics, "resting_length").is_some());
    }
}
